"""What peers write: pictures in cd/m2 that say so, as every reader of EXR can know."""

import numpy as np
import OpenImageIO as oiio

from .errors import InputError

# X, Y, Z are their own primaries, with equal energy white (OpenEXR's advice for CIE XYZ).
XYZ_CHROMATICITIES = (1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)


def write_xyz(path, xyz, stderr=None):
    """Writes XYZ in cd/m2 (height, width, 3), and its standard errors where they are known, as an EXR."""
    layers, names = [xyz], tuple("XYZ")
    if stderr is not None:
        layers, names = [xyz, stderr], (*names, "stderr.X", "stderr.Y", "stderr.Z")
    write_channels(path, np.concatenate(layers, axis=-1), names, chromaticities=XYZ_CHROMATICITIES)


def write_luminance(path, luminance, stderr=None):
    """Writes luminance in cd/m2 (height, width), and its standard error where it is known, as an EXR."""
    layers, names = [luminance], ("Y",)
    if stderr is not None:
        layers, names = [luminance, stderr], ("Y", "stderr.Y")
    write_channels(path, np.stack(layers, axis=-1), names)


def write_channels(path, pixels, names, chromaticities=None):
    """Writes channels by name whose unit is cd/m2."""
    pixels = np.ascontiguousarray(pixels, np.float32)
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "float")
    spec.channelnames = names
    spec.attribute("whiteLuminance", 1.0)
    if chromaticities is not None:
        spec.attribute("chromaticities", "float[8]", chromaticities)
    file = oiio.ImageOutput.create(str(path))
    if file is None or not file.open(str(path), spec) or not file.write_image(pixels):
        raise InputError(path, "cannot be written", "check the folder and its permissions")
    file.close()
