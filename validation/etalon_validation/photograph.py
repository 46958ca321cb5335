"""Reads a photograph as linear values and remembers what was assumed on the way.

EXR and floating TIFF are taken as linear, camera RAW and DNG are read as the
sensor counted. PNG, JPEG and integer TIFF carry no measured tone curve: they
are decoded with the sRGB curve, labelled so, and the report warns of it.
"""

import contextlib
import hashlib
import os
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from . import raw
from .errors import InputError

LINEAR = "linear"
ASSUMED_SRGB = "8-bit, encoding assumed (sRGB curve)"
ASSUMED_SRGB_16 = "16-bit, encoding assumed (sRGB curve)"
SUFFIXES = (".exr", ".tif", ".tiff", ".png", ".jpg", ".jpeg")
# EXIF facts of coded pictures, by the names that OpenImageIO gives them.
FACTS = {"iso": "Exif:PhotographicSensitivity", "shutter_s": "ExposureTime", "f_stop": "FNumber", "focal_length_mm": "Exif:FocalLength"}


@dataclass(frozen=True)
class Photograph:
    """Linear RGB (height, width, 3), and the identity of the file it came from.

    `saturated` (height, width) marks pixels that are lower bounds, None where the file cannot tell; `exposure` holds
    what the file says of iso, shutter_s, f_stop and focal_length_mm; `corrections` what was done to the values since.
    """

    rgb: np.ndarray
    file: str
    sha256: str
    encoding: str
    saturated: np.ndarray | None = None
    exposure: dict = field(default_factory=dict)
    corrections: tuple = ()

    @property
    def size(self):
        """(width, height) in pixels."""
        return self.rgb.shape[1], self.rgb.shape[0]


def srgb_to_linear(encoded):
    """Inverse of the sRGB transfer curve (IEC 61966-2-1)."""
    encoded = np.asarray(encoded, float)
    return np.where(encoded <= 0.04045, encoded / 12.92, ((np.maximum(encoded, 0) + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(linear):
    """The sRGB transfer curve, clipped to the displayable range."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def sha256_of(path):
    """Hexadecimal SHA-256 of a file."""
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def read_photograph(path):
    """The photograph in `path`; an `InputError` when it cannot be one."""
    path = Path(path)
    remedy = "give an EXR, TIFF, PNG, JPEG, RAW or DNG photograph with three channels"
    if not path.is_file():
        raise InputError(path, "no such photograph", remedy)
    if path.suffix.lower() in raw.SUFFIXES:
        rgb, saturated, facts = raw.read_raw(path)
        return Photograph(rgb, path.name, sha256_of(path), raw.ENCODING, saturated, facts)
    if path.suffix.lower() not in SUFFIXES:
        raise InputError(path, f'unknown kind of photograph "{path.suffix}"', remedy)
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise InputError(path, f"cannot be decoded ({first_line(oiio.geterror())})", remedy)
    spec = image.spec()
    if spec.nchannels < 3:
        raise InputError(path, "has fewer than three channels", remedy)
    with silenced():
        pixels = image.read_image(0, 3, "float")
    image.close()
    if pixels is None:
        raise InputError(path, "is cut short or damaged", "get the file again")
    rgb = np.asarray(pixels, float)[..., :3]
    if not np.isfinite(rgb).all():
        raise InputError(path, "holds values that are not finite", "repair or export the photograph again")
    depth, saturated = str(spec.format), None
    if depth in ("half", "float", "double"):
        encoding = LINEAR
    else:
        encoding = ASSUMED_SRGB if depth == "uint8" else ASSUMED_SRGB_16
        saturated = (rgb >= 1).any(axis=2)
        rgb = srgb_to_linear(rgb)
    facts = {name: spec.getattribute(key) for name, key in FACTS.items()}
    facts = {name: round(float(value), 6) for name, value in facts.items() if isinstance(value, (int, float)) and value > 0}
    return Photograph(rgb, path.name, sha256_of(path), encoding, saturated, facts)


def encoding_warning(file, encoding):
    """What a report says of a photograph whose tone curve is assumed; None for linear ones."""
    if encoding not in (ASSUMED_SRGB, ASSUMED_SRGB_16):
        return None
    depth = "8-bit" if encoding == ASSUMED_SRGB else "16-bit"
    return f"{file}: a gamma-coded {depth} photograph is only good for chromaticity and structure: its tone curve is assumed (sRGB), so luminance ratios and exposure are not evidence"


@contextlib.contextmanager
def silenced():
    """Keeps decoders from printing to stderr on their own; the caller reports the failure."""
    sys.stderr.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def first_line(text):
    """A library's message cut to one line."""
    return text.strip().splitlines()[0] if text and text.strip() else "no reason given"
