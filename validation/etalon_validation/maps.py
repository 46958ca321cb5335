"""Difference maps, pixel by pixel: luminance in stops and chromaticity as u'v' distance."""

import numpy as np
from matplotlib import colormaps
from scipy.ndimage import uniform_filter

from .difference import duv
from .overlay import png

# Ends of the colour bars.
STOPS_RANGE = 1.0
DUV_RANGE = 0.06
# Both sides are averaged over squares of this many pixels, so that the maps show surfaces and not single noisy pixels.
SMOOTHED_PX = 5
# Pixels darker than this in the photograph (relative to white) have no chromaticity to compare.
DARK = 0.01
# Below this a render is black, and what is left is rounding.
NOTHING = 1e-7


def resized(values, size):
    """Values (height, width, n) sampled at the nearest pixel centres of another size (width, height)."""
    if (values.shape[1], values.shape[0]) == tuple(size):
        return values
    rows = ((np.arange(size[1]) + 0.5) * values.shape[0] / size[1]).astype(int)
    columns = ((np.arange(size[0]) + 0.5) * values.shape[1] / size[0]).astype(int)
    return values[rows][:, columns]


def smoothed(values):
    """Means over squares of `SMOOTHED_PX` pixels around each pixel; the scale of an image stays."""
    return uniform_filter(values, size=(SMOOTHED_PX, SMOOTHED_PX, 1), mode="nearest")


def stops_map(predicted_y, photo_y):
    """PNG of log2(render / photo), blue where the render is too dark, red where too bright; dark pixels grey."""
    with np.errstate(divide="ignore", invalid="ignore"):
        stops = np.where(predicted_y > NOTHING, np.log2(predicted_y / photo_y), np.nan)
    colours = colormaps["RdBu_r"](np.clip(stops / STOPS_RANGE / 2 + 0.5, 0, 1))[..., :3]
    return masked(colours, photo_y, stops)


def duv_map(predicted_xyz, photo_xyz):
    """PNG of the u'v' distance; dark pixels grey."""
    distance = duv(predicted_xyz, photo_xyz)
    colours = colormaps["viridis"](np.clip(distance / DUV_RANGE, 0, 1))[..., :3]
    return masked(colours, photo_xyz[..., 1], distance)


def masked(colours, photo_y, values):
    """The coloured map with grey where the photograph is dark or the value undefined."""
    colours[(photo_y < DARK) | ~np.isfinite(values)] = 0.35
    return png(colours)


def gradient(name):
    """A CSS gradient of a colour map, left to right."""
    stops = ", ".join("#%02x%02x%02x" % tuple(int(255 * c) for c in colormaps[name](x)[:3]) for x in np.linspace(0, 1, 13))
    return f"linear-gradient(to right, {stops})"
