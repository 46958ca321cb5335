"""Region means of render and photograph in one space of three channels, with what blurs them.

The space is the camera's own channels where both sides have them, for a camera
matrix would otherwise be guessed at; else linear sRGB. Noise of a render is
bright or dark in all channels at once, because they share paths: how much they
share is read off neighbouring pixels and not assumed.
"""

import re
from dataclasses import dataclass, field

import numpy as np

from .difference import SRGB_TO_XYZ, XYZ_TO_SRGB
from .errors import InputError
from .photograph import linear_to_srgb, srgb_to_linear
from .polygons import mask
from .regions import CORRELATED_PIXELS


# A region's level in the render is not taken to be below this: it is divided by.
FAINTEST = 1e-9


@dataclass(frozen=True)
class Comparison:
    """Region means of render and photograph in one space of three channels.

    `render_covariance` (n, 3, 3) is that of the render's means; `photo_error` and `quantisation` (n, 3) are
    standard uncertainties of the photograph's. `shift` (n, 2, 3) is how the photograph's mean changes per pixel
    that a region moves right and down; `radius2` (n,) the squared distance from the image centre in half diagonals.
    `noise` is the relative standard error of the render's mean luminance; `mean_picture` (3,) the render's mean.
    """

    render: np.ndarray
    photo: np.ndarray
    to_xyz: np.ndarray
    render_covariance: np.ndarray
    photo_error: np.ndarray
    pixels: np.ndarray
    channels: np.ndarray
    mean_picture: np.ndarray
    noise: np.ndarray = None
    photo_pixels: np.ndarray = None
    quantisation: np.ndarray = None
    shift: np.ndarray = None
    shift_from: str = "none"
    radius2: np.ndarray = None
    notes: tuple = field(default=())

    @property
    def luminance(self):
        """The row that turns channels into luminance."""
        return self.to_xyz[1]


def scaled_polygon(region, table, render):
    """A region's polygon in the pixels of a render that may be larger or smaller than the photograph."""
    scale = np.array(render.size, float) / np.array(table.size, float)
    if abs(scale[0] / scale[1] - 1) > 0.005:
        raise InputError(render.file, f"has {render.size} pixels, the photograph {table.size}", "render at the photograph's aspect ratio")
    return region.polygon * scale if region.in_render is None else region.in_render


def region_masks(table, regions, render):
    """The pixels of the render in each region."""
    masks = [mask(scaled_polygon(region, table, render), render.size) for region in regions]
    for region, inside in zip(regions, masks):
        if not inside.any():
            raise InputError(render.file, f'no pixel lies in region "{region.name}"', "render at a higher resolution")
    return masks


def means(values, masks):
    """Mean of (h, w, 3) over each mask."""
    return np.array([values[inside].mean(axis=0) for inside in masks])


def mean_errors(errors, masks):
    """Standard errors of the means over each mask, pixels taken as independent."""
    return np.array([np.sqrt((errors[inside] ** 2).sum(axis=0)) / inside.sum() for inside in masks])


def shared_noise(channels, masks):
    """Correlation of the channels' noise in each region, (n, 3, 3), from differences of neighbouring pixels."""
    found = []
    for inside in masks:
        pairs = inside[:, 1:] & inside[:, :-1]
        steps = (channels[:, 1:] - channels[:, :-1])[pairs]
        square = steps.T @ steps
        scale = np.sqrt(np.diag(square))
        with np.errstate(divide="ignore", invalid="ignore"):
            correlation = square / np.outer(scale, scale)
        known = len(steps) > 8 and (scale > 0).all()
        found.append(correlation if known else np.eye(3))
    return np.array(found)


def per_pixel_shift(values, masks, scale):
    """Change of each region's mean per photograph pixel that it moves right and down, (n, 2, 3); `scale` (2,) as
    pixels of `values` per pixel of the photograph."""
    height, width = values.shape[:2]
    found = []
    for inside in masks:
        rows, columns = np.nonzero(inside)

        def moved(right, down):
            return values[np.clip(rows + down, 0, height - 1), np.clip(columns + right, 0, width - 1)].mean(axis=0)

        found.append([scale[0] * (moved(1, 0) - moved(-1, 0)) / 2, scale[1] * (moved(0, 1) - moved(0, -1)) / 2])
    return np.array(found)


def code_step(photo, encoding):
    """Standard uncertainty (n, 3) that rounding to integer codes leaves in one pixel; zero for floating values."""
    bits = re.match(r"(\d+)-bit.*sRGB", encoding)
    if not bits:
        return np.zeros_like(photo)
    code = 1 / (2 ** int(bits.group(1)) - 1)
    return (srgb_to_linear(linear_to_srgb(photo) + code) - np.clip(photo, 0, 1)) / np.sqrt(12)


def quantisation(photo, deviation, pixels, encoding):
    """The same for a region's mean: noise of half a code or more makes rounding average out, less does not."""
    one = code_step(photo, encoding)
    dithered = deviation > one * np.sqrt(12) / 2
    return one * np.where(dithered, np.sqrt(np.minimum(1, CORRELATED_PIXELS / pixels))[:, None], 1)


def compare(table, regions, render, encoding="linear", photograph=None):
    """Brings render and photograph into one space: the camera's channels if both have them, else linear sRGB."""
    masks = region_masks(table, regions, render)
    usable = np.array([region.flag is None for region in regions])
    if usable.sum() < 4:
        raise InputError(table.path, f"{usable.sum()} regions are bright enough to fit", "measure more regions")
    xyz = means(render.xyz / render.saturation, masks)
    xyz_error = mean_errors(render.stderr / render.saturation, masks)
    sides = in_camera if table.space == "camera_rgb" and render.sensor is not None else in_srgb
    channels, to_xyz, covariance, notes = sides(render, masks, xyz, xyz_error, usable)
    if table.space == "camera_rgb" and render.sensor is None:
        notes += ("The photograph is camera RGB but the render has no sensor channels: below L3 its chromaticity is not comparable.",)
    photo, pixels = np.array([region.rgb for region in regions]), np.array([region.pixels for region in regions])
    centres = np.array([region.polygon.mean(axis=0) for region in regions]) - np.array(table.size) / 2
    shift, shift_from = shifts(table, regions, masks, channels, photo, photograph)
    return Comparison(
        render=means(channels, masks), photo=photo, to_xyz=to_xyz, render_covariance=covariance,
        photo_error=np.array([region.error for region in regions]), pixels=np.array([inside.sum() for inside in masks]),
        channels=channels, mean_picture=channels.mean(axis=(0, 1)), noise=xyz_error[:, 1] / np.maximum(xyz[:, 1], 1e-12),
        photo_pixels=pixels, quantisation=quantisation(photo, np.array([region.deviation for region in regions]), pixels, encoding),
        shift=shift, shift_from=shift_from, radius2=(centres**2).sum(axis=1) / (np.array(table.size) ** 2 / 4).sum(), notes=notes,
    )


def shifts(table, regions, masks, channels, photo, photograph):
    """`per_pixel_shift` of the photograph; of the render, scaled to the photograph's means, where only the table is at hand."""
    if photograph is not None:
        own = [mask(region.polygon, table.size) for region in regions]
        return per_pixel_shift(photograph.rgb, own, (1, 1)), "the photograph"
    scale = np.array(channels.shape[1::-1]) / np.array(table.size)
    # Relative to the mean over channels: a saturated colour has one that is near zero or below.
    level = np.maximum(means(channels, masks).mean(axis=1), FAINTEST)
    return per_pixel_shift(channels, masks, scale) * (np.maximum(photo.mean(axis=1), 0) / level)[:, None, None], "the render"


def in_camera(render, masks, xyz, xyz_error, usable):
    """Camera RGB on both sides, and the metric that turns it into XYZ, which comes from the render alone."""
    sensor = means(render.sensor, masks)
    scale = xyz[usable, 1].mean() / sensor[usable, 1].mean()
    weights = 1 / np.maximum(xyz[usable, 1:2], 1e-9)
    to_xyz = np.linalg.lstsq(scale * sensor[usable] * weights, xyz[usable] * weights, rcond=None)[0].T
    error = scale * sensor * xyz_error / np.maximum(xyz, 1e-12)
    covariance = shared_noise(render.sensor, masks) * error[:, :, None] * error[:, None, :]
    return scale * render.sensor, to_xyz, covariance, (
        "Compared in camera RGB: render radiance weighted with the camera's sensitivity, scaled so that the mean green value equals the mean luminance over saturation. L0 and L1 stand on this scale.",
        "u'v', luminance and dE need XYZ: one matrix from camera RGB to XYZ, fitted on the render's own regions without any photograph value, is applied to both sides.",
    )


def in_srgb(render, masks, xyz, xyz_error, usable):
    """Linear sRGB on both sides."""
    covariance = shared_noise(render.xyz, masks) * xyz_error[:, :, None] * xyz_error[:, None, :]
    return render.xyz / render.saturation @ XYZ_TO_SRGB.T, SRGB_TO_XYZ, XYZ_TO_SRGB @ covariance @ XYZ_TO_SRGB.T, (
        "Compared in linear sRGB with white D65: the photograph's colour encoding is assumed, not known.",
    )
