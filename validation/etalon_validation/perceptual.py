"""Figures over the whole picture: nRMSE of valid pixels, and how different the pictures look (SSIM, FLIP).

The last two are not evidence of accuracy: they weigh what an eye notices on a
display, and a picture with the wrong lamp can look right. They are absent
without the photograph, for a region table has no picture.
"""

from pathlib import Path

import flip_evaluator
import numpy as np
from skimage.metrics import structural_similarity

from .layout import Layout
from .maps import resized
from .photograph import LINEAR, linear_to_srgb
from .polygons import mask
from .regions import NOISE_FLOOR

# SSIM with the windows of its authors (Wang et al. 2004): Gaussian, 1.5 pixels.
SSIM_SIGMA_PX = 1.5
# HDR-FLIP looks at exposures from the photograph's own to four stops brighter; fixed, so that reports compare.
FLIP_STOPS = (0.0, 4.0)
FLIP_EXPOSURES = 3
# FLIP's own default: a 0.7 m wide display of 3840 pixels seen from 0.7 m.
FLIP_PIXELS_PER_DEGREE = 67.0206
# Codes of integer photographs at or above this are taken as saturated where the photograph does not say which are.
SATURATED = 254.5 / 255
ABSENT = "the photograph itself is not at hand"


def inside_box(case, size):
    """Pixels (h, w) of an image of `size` that show a face of the case's layout; None without a layout of that size."""
    case = Path(case)
    if not all((case / name).is_file() for name in ("layout.json", "pose.json")):
        return None
    layout = Layout(case / "layout.json")
    if tuple(layout.camera.size) != tuple(size):
        return None
    camera, inside = layout.camera.undistorted, np.zeros((size[1], size[0]), bool)
    for face in layout.faces.values():
        if ((face.quad - camera.position) @ camera.look > 0).all():
            inside |= mask(camera.project(face.quad), size)
    for polygon in layout.keep_out:
        inside &= ~mask(polygon, size)
    return inside if inside.any() else None


def valid_pixels(photograph, predicted, inside=None):
    """Pixels that carry a measurement: inside the scene, finite on both sides, neither saturated nor at the photograph's black level."""
    saturated = getattr(photograph, "saturated", None)
    if saturated is None:
        limit = np.inf if photograph.encoding == LINEAR else SATURATED
        saturated = (linear_to_srgb(photograph.rgb) >= limit).any(axis=-1)
    known = np.isfinite(photograph.rgb).all(axis=-1) & np.isfinite(predicted).all(axis=-1)
    known = known if inside is None else known & inside
    return known & ~np.asarray(saturated, bool) & (photograph.rgb.mean(axis=-1) >= NOISE_FLOOR)


def nrmse(predicted, photo, valid):
    """Root mean square of prediction less photograph over pixels and channels, over the photograph's mean; None where no pixel is valid."""
    if not valid.any():
        return None
    return float(np.sqrt(((predicted[valid] - photo[valid]) ** 2).mean()) / photo[valid].mean())


def ssim(predicted, photo):
    """Structural similarity of both through the sRGB curve, 1 for equal."""
    first, second = linear_to_srgb(photo), linear_to_srgb(predicted)
    smallest = min(first.shape[:2])
    if smallest < 11:
        return None
    return float(structural_similarity(first, second, channel_axis=2, data_range=1, gaussian_weights=True, sigma=SSIM_SIGMA_PX, use_sample_covariance=False))


def flip(predicted, photo, kind):
    """Mean FLIP, 0 for equal; `kind` LDR through the sRGB curve, HDR over `FLIP_STOPS`."""
    sides = [linear_to_srgb(side) if kind == "LDR" else np.maximum(side, 0) for side in (photo, predicted)]
    first, second = (np.ascontiguousarray(side, np.float32) for side in sides)
    chosen = {"ppd": FLIP_PIXELS_PER_DEGREE}
    if kind == "HDR":
        chosen |= {"startExposure": FLIP_STOPS[0], "stopExposure": FLIP_STOPS[1], "numExposures": FLIP_EXPOSURES}
    _, mean, _ = flip_evaluator.evaluate(first, second, kind, inputsRGB=kind == "LDR", applyMagma=False, computeMeanError=True, parameters=chosen)
    return float(mean)


def whole_picture(photograph, both, levels, inside=None):
    """The `picture` entry of the report; with `available` false where there is no photograph."""
    if photograph is None:
        return {"available": False, "reason": ABSENT}
    channels = resized(both.channels, photograph.size)
    photo = np.where(np.isfinite(photograph.rgb), photograph.rgb, 0)
    figures = {}
    for level in levels:
        predicted = level.apply(channels)
        valid = valid_pixels(photograph, predicted, inside)
        found = {"nrmse": nrmse(predicted, photograph.rgb, valid), "ssim": ssim(predicted, photo)}
        found |= {"flip_ldr": flip(predicted, photo, "LDR"), "flip_hdr": flip(predicted, photo, "HDR")}
        figures[level.name] = {key: value if value is None else round(value, 5) for key, value in found.items()}
    return {
        "available": True, "levels": figures, "valid_pixels": int(valid.sum()), "valid_share": round(float(valid.mean()), 5),
        "inside_box": inside is not None, "perceptual": ["ssim", "flip_ldr", "flip_hdr"],
        "ssim_sigma_px": SSIM_SIGMA_PX, "flip_pixels_per_degree": FLIP_PIXELS_PER_DEGREE,
        "flip_hdr_stops": list(FLIP_STOPS), "flip_hdr_exposures": FLIP_EXPOSURES, "flip_hdr_tonemapper": "ACES",
    }
