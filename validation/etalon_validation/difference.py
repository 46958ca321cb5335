"""Colour differences between two mean XYZ values (Y = 1 is display white)."""

import warnings

import numpy as np

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    import colour

# Linear sRGB to XYZ with white D65 at Y = 1 (IEC 61966-2-1).
SRGB_TO_XYZ = np.array([
    [0.4123907993, 0.3575843394, 0.1804807884],
    [0.2126390059, 0.7151686788, 0.0721923154],
    [0.0193308187, 0.1191947798, 0.9505321522],
])
XYZ_TO_SRGB = np.linalg.inv(SRGB_TO_XYZ)
# Luminance of white, with room for rounding.
WHITE_Y = 1 + 1e-6
# The white that CIELAB is relative to.
WHITE_XYZ = SRGB_TO_XYZ.sum(axis=1)
WHITE_XY = WHITE_XYZ[:2] / WHITE_XYZ.sum()
# Luminance at which white is taken to be seen for dE ITP, which is absolute: reference white of ITU-R BT.2408, cd/m2.
ITP_WHITE_CD_M2 = 203.0


def chromaticity(xyz):
    """CIE 1976 u', v' (..., 2); NaN where the denominator is not positive."""
    xyz = np.asarray(xyz, float)
    denominator = xyz @ np.array([1.0, 15.0, 3.0])
    with np.errstate(divide="ignore", invalid="ignore"):
        uv = np.stack([4 * xyz[..., 0], 9 * xyz[..., 1]], axis=-1) / denominator[..., None]
    return np.where(denominator[..., None] > 1e-9, uv, np.nan)


def duv(first, second):
    """Distance in the u'v' diagram."""
    return np.linalg.norm(chromaticity(first) - chromaticity(second), axis=-1)


def delta_e_lab(first, second):
    """CIEDE2000 between two CIELAB colours."""
    return colour.delta_E(np.asarray(first, float), np.asarray(second, float), method="CIE 2000")


def delta_e_2000(first, second):
    """CIEDE2000 under D65; NaN where a luminance is not positive. Above white the formula runs on untested: see `above_white`."""
    first, second = np.asarray(first, float), np.asarray(second, float)
    defined = (first[..., 1] > 0) & (second[..., 1] > 0)
    lab = [colour.XYZ_to_Lab(np.maximum(xyz, 0), WHITE_XY) for xyz in (first, second)]
    return np.where(defined, delta_e_lab(*lab), np.nan)


def above_white(first, second):
    """Where a luminance is above white, so that CIEDE2000 is no measured colour difference."""
    return (np.asarray(first)[..., 1] > WHITE_Y) | (np.asarray(second)[..., 1] > WHITE_Y)


def delta_e_itp(first, second):
    """dE ITP (ITU-R BT.2124) with Y = 1 seen at `ITP_WHITE_CD_M2`; NaN where a luminance is not positive. Defined above white."""
    first, second = np.asarray(first, float), np.asarray(second, float)
    defined = (first[..., 1] > 0) & (second[..., 1] > 0)
    ictcp = [colour.XYZ_to_ICtCp(np.maximum(xyz, 0) * ITP_WHITE_CD_M2, method="ITU-R BT.2100-2 PQ") for xyz in (first, second)]
    # Draws of a wild uncertainty may overflow: an infinite distance is what they have.
    with np.errstate(over="ignore", invalid="ignore"):
        return np.where(defined, colour.delta_E(*ictcp, method="ITP"), np.nan)
