"""Reads a photograph as linear values and remembers what was assumed on the way.

EXR and floating TIFF are taken as linear. PNG, JPEG and integer TIFF carry no
measured tone curve: they are decoded with the sRGB curve and labelled so.
"""

import contextlib
import hashlib
import os
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from .errors import InputError

LINEAR = "linear"
ASSUMED_SRGB = "8-bit, encoding assumed (sRGB curve)"
ASSUMED_SRGB_16 = "16-bit, encoding assumed (sRGB curve)"
SUFFIXES = (".exr", ".tif", ".tiff", ".png", ".jpg", ".jpeg")


@dataclass(frozen=True)
class Photograph:
    """Linear RGB (height, width, 3), and the identity of the file it came from."""

    rgb: np.ndarray
    file: str
    sha256: str
    encoding: str

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
    remedy = "give an EXR, TIFF, PNG or JPEG photograph with three channels"
    if not path.is_file():
        raise InputError(path, "no such photograph", remedy)
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
    depth = str(spec.format)
    if depth in ("half", "float", "double"):
        encoding = LINEAR
    else:
        encoding = ASSUMED_SRGB if depth == "uint8" else ASSUMED_SRGB_16
        rgb = srgb_to_linear(rgb)
    return Photograph(rgb, path.name, sha256_of(path), encoding)


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
