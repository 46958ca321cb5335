"""A small case with known answers: photograph, render and region table written to a folder."""

import json

import numpy as np
import OpenImageIO as oiio

from etalon_validation.difference import SRGB_TO_XYZ
from etalon_validation.photograph import sha256_of

SATURATION = 800.0
# Linear RGB of eight patches over four surfaces, and one at the black level.
COLOURS = np.array([
    [0.60, 0.55, 0.50], [0.30, 0.28, 0.24], [0.50, 0.08, 0.04], [0.30, 0.05, 0.03],
    [0.06, 0.25, 0.09], [0.10, 0.40, 0.14], [0.45, 0.40, 0.50], [0.20, 0.18, 0.22], [0.004, 0.003, 0.002],
])
SURFACES = ["white", "white", "red", "red", "green", "green", "blue", "blue", "black"]
CELL = 12


def patches(colours):
    """An image of one square per colour, side by side."""
    return np.repeat(np.repeat(np.asarray(colours)[None], CELL, axis=0), CELL, axis=1)


def write_exr(path, channels, names, attributes=()):
    """A float EXR with named channels and string attributes."""
    spec = oiio.ImageSpec(channels.shape[1], channels.shape[0], len(names), oiio.FLOAT)
    spec.channelnames = tuple(names)
    for name, value in attributes:
        spec.attribute(name, value)
    output = oiio.ImageOutput.create(str(path))
    output.open(str(path), spec)
    output.write_image(np.ascontiguousarray(channels, dtype=np.float32))
    output.close()


def record():
    """What a render says about itself."""
    return {"version": "0", "scene": "patches", "seed": 1, "samples_per_pixel": 4, "seconds": 1.0, "camera": {"saturation_luminance_cd_m2": SATURATION}}


def write_render(path, linear_rgb, sensor=None, attributes=None):
    """A render whose display-linear sRGB is `linear_rgb`."""
    xyz = linear_rgb @ SRGB_TO_XYZ.T * SATURATION
    names, data = ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z"], [xyz, 0.001 * xyz]
    if sensor is not None:
        names, data = names + ["sensor.R", "sensor.G", "sensor.B"], data + [sensor]
    write_exr(path, np.concatenate(data, axis=-1), names, [("etalon", json.dumps(record()))] if attributes is None else attributes)


def write_case(folder, space="linear_srgb"):
    """photo.exr and regions.json in `folder`; returns the photograph's pixels."""
    image = patches(COLOURS)
    write_exr(folder / "photo.exr", image, ["R", "G", "B"])
    regions = []
    for index, (colour, surface) in enumerate(zip(COLOURS, SURFACES)):
        left, right = index * CELL + 2, (index + 1) * CELL - 2
        regions.append({
            "name": f"patch_{index}", "surface": surface, "pixels": (right - left) * (CELL - 4), "mean_rgb": colour.tolist(),
            "deviation_rgb": [0, 0, 0], "standard_error_rgb": [0, 0, 0], "polygon": [[left, 2], [right, 2], [right, CELL - 2], [left, CELL - 2]],
        })
    photo = {"file": "photo.exr", "sha256": sha256_of(folder / "photo.exr"), "width": image.shape[1], "height": image.shape[0], "encoding": "linear"}
    (folder / "regions.json").write_text(json.dumps({"photo": photo, "photo_space": space, "regions": regions}))
    return image
