"""Luminance of an EXR by any renderer, and what its unit is known from.

Renderers agree on the format and not on its unit. A factor to cd/m2 comes, in
this order, from the user (`--peer-scale`, then the column `scale`), from the
facts of Etalon, from the standard attribute `whiteLuminance` (cd/m2 of R = G =
B = 1, or of Y = 1); else it is fitted, and whoever reads the figures is told
that the level is then not tested.
"""

import json
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from .errors import InputError
from .render import read_pixels

# Primaries and white of ITU-R BT.709 and sRGB: red, green, blue, white as x, y.
SRGB = (0.64, 0.33, 0.30, 0.60, 0.15, 0.06, 0.3127, 0.3290)
FITTED = "fitted"
# Channels that hold the standard error of Y.
STANDARD_ERROR = "stderr.Y"
REMEDY = "give an EXR by any renderer, with Y or linear R, G, B"


@dataclass(frozen=True)
class Picture:
    """Luminance (height, width) in units of the file, its variance where the file has it, and cd/m2 per unit.

    `factor` is `None` where nothing says it; `unit` says in words where it is from.
    """

    file: Path
    luminance: np.ndarray
    variance: np.ndarray | None
    factor: float | None
    unit: str
    weights: str
    # What Etalon tells of the picture; nothing of others.
    facts: dict = field(default_factory=dict)

    @property
    def size(self):
        """(width, height) in pixels."""
        return self.luminance.shape[1], self.luminance.shape[0]

    def scaled(self, factor):
        """Luminance and variance times a factor and its square."""
        return factor * self.luminance, None if self.variance is None else factor**2 * self.variance


def luminance_weights(chromaticities):
    """Shares of R, G, B in luminance by primaries and white as x, y (SMPTE RP 177).

    White, R = G = B = 1, has luminance 1. `None` where the primaries lie on a line.
    """
    xy = np.reshape(np.asarray(chromaticities, float), (4, 2))
    xyz = np.column_stack([xy, 1 - xy.sum(axis=1)])
    if xyz[3, 1] <= 0 or abs(np.linalg.det(xyz[:3])) < 1e-6:
        return None
    return xyz[:3, 1] * np.linalg.solve(xyz[:3].T, xyz[3] / xyz[3, 1])


def read_picture(path, place=None, scale=None):
    """The picture in `path`; `scale` in cd/m2 per unit goes before what the file says.

    `place` is where the file was named; errors begin with it.
    """
    place = place or path
    spec, names, pixels = read_pixels(path, REMEDY)
    if "Y" in names:
        luminance, weights = pixels[..., names.index("Y")], "channel Y"
    elif set("RGB") <= set(names):
        shares, weights = shares_of(spec, place, path)
        luminance = pixels[..., [names.index(name) for name in "RGB"]] @ shares
    else:
        raise InputError(place, f"{path} has the channels {', '.join(names)}", "give X, Y, Z or Y, or linear R, G, B")
    wrong = int((~np.isfinite(luminance)).sum())
    if wrong:
        raise InputError(place, f"{path} has {wrong} pixels that are not finite", "render it again without them; left out they would hide what they cost")
    variance = pixels[..., names.index(STANDARD_ERROR)] ** 2 if STANDARD_ERROR in names else None
    if variance is not None and not np.isfinite(variance).all():
        variance = None
    factor, unit = (float(scale), "a factor given by the user") if scale is not None else unit_of(spec)
    return Picture(Path(path), luminance, variance, factor, unit, weights, facts_of(spec))


def shares_of(spec, place, path):
    """Shares of R, G, B in luminance, and in words where they are from."""
    stated = spec.getattribute("chromaticities")
    if stated is None:
        return luminance_weights(SRGB), "R, G, B of sRGB primaries (none stated)"
    shares = luminance_weights(stated)
    if shares is None:
        raise InputError(place, f"the chromaticities of {path} are no primaries: {', '.join(f'{v:g}' for v in stated)}", "correct the attribute, or write channel Y")
    return shares, "R, G, B of the stated primaries"


def facts_of(spec):
    """The facts of a render by Etalon; empty where there are none."""
    text = spec.getattribute("etalon")
    try:
        facts = json.loads(text) if isinstance(text, str) else None
    except json.JSONDecodeError:
        facts = None
    return facts if isinstance(facts, dict) else {}


def unit_of(spec):
    """Factor to cd/m2 and where it is from; `None` and `FITTED` where the file says nothing."""
    if isinstance(spec.getattribute("etalon"), str):
        return 1.0, "cd/m2, by Etalon"
    white = spec.getattribute("whiteLuminance")
    if isinstance(white, (int, float)) and white > 0 and np.isfinite(white):
        return float(white), f"whiteLuminance {white:g} cd/m2"
    return None, FITTED


def fitted_factor(luminance, file, reference):
    """The factor that gives luminance the mean of the reference.

    Means, and not least squares: noise in the picture would pull those down.
    """
    own = luminance.mean()
    if not own > 0:
        raise InputError(file, "has no light in it, no factor can be fitted", "check the render, or give --peer-scale")
    return float(reference.mean() / own)
