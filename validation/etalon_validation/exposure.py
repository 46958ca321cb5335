"""Judges how a picture is exposed, with nothing fitted: levels, clipping, noise.

A picture is called well exposed by three conditions on the subject's pixels, the
lamp's own left out:

- its mean luminance, which is what an integrating reflected-light meter reads,
  is within one stop of the luminance that such a meter asks for at the camera's
  settings, L = K N^2 / (S t) with K = 12.5 cd s m-2 (ISO 2720). One stop is the
  step that exposures are bracketed by;
- fewer than 1 % of the pixels clip a channel of the developed picture, whose 1
  stands for the saturation exposure 78 / S lx s (ISO 12232);
- fewer than 1 % fall below the first level above black of an 8-bit sRGB picture.
"""

from dataclasses import asdict, dataclass

import numpy as np

from .camera import Pinhole
from .difference import WHITE_XYZ, XYZ_TO_SRGB, colour
from .errors import InputError
from .photograph import linear_to_srgb
from .polygons import erode, mask

# Calibration constant of reflected-light meters, cd s m-2 (ISO 2720).
METER_K = 12.5
# Mean luminance may be this far from what the meter asks for.
METER_STOPS = 1.0
# Share of the pixels that may clip, and that may be black.
CLIPPED_SHARE = 0.01
BLACK_SHARE = 0.01
# The first level above black of an 8-bit picture, sRGB-encoded.
FIRST_CODE = 1 / 255
PERCENTILES = (1, 5, 25, 50, 75, 95, 99)


@dataclass(frozen=True)
class Parts:
    """Which pixels (height, width) show the subject, and which the lamp."""

    subject: np.ndarray
    lamp: np.ndarray


@dataclass(frozen=True)
class Condition:
    """One condition of a good exposure: its figure, its bound, and whether it holds."""

    name: str
    value: float
    bound: float
    unit: str
    holds: bool


def sphere_mask(camera: Pinhole, centre, radius, margin_px):
    """Pixels whose view passes a sphere nearer than its radius and a margin."""
    rows, columns = np.mgrid[0 : camera.size[1], 0 : camera.size[0]]
    rays = camera.rays(np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1))
    offset = np.asarray(centre, float) - camera.position
    along = rays @ offset
    distance = np.linalg.norm(offset - along[:, None] * rays, axis=1)
    reach = radius + margin_px * np.linalg.norm(offset) / camera.focal_px
    return ((distance <= reach) & (along > 0)).reshape(rows.shape)


def parts(camera, plan, scene, path):
    """The pixels of subject and lamp, from the `exposure.json` of a case and its scene."""
    outline = erode(camera.project(plan["subject"]["outline"]), float(plan["subject"]["erode_px"]))
    if len(outline) < 3:
        raise InputError(path, "the subject's outline covers no pixel", "correct subject.outline")
    lamp = next((entry for entry in scene["objects"] if entry.get("name") == plan["lamp"]), None)
    if lamp is None or "sphere" not in lamp["shape"]:
        raise InputError(path, f'the scene has no sphere "{plan["lamp"]}"', "name the lamp of the scene")
    sphere = lamp["shape"]["sphere"]
    seen = sphere_mask(camera, sphere["center"], float(sphere["radius"]), 1.0)
    return Parts(mask(outline, camera.size) & ~seen, seen)


def developed(render):
    """Linear sRGB (height, width, 3) with 1 at display white, not clipped."""
    xyz, white = render.xyz, render.record["camera"].get("white_xyz")
    if white:
        white = np.asarray(white, float) / white[1]
        xyz = colour.adaptation.chromatic_adaptation_VonKries(xyz, white, WHITE_XYZ, transform="Bradford")
    return xyz @ XYZ_TO_SRGB.T / float(render.record["camera"]["white_luminance_cd_m2"])


def metered_luminance(camera):
    """Luminance in cd/m2 that a reflected-light meter asks for: K N^2 / (S t)."""
    return METER_K * camera["f_stop"] ** 2 / (camera["iso"] * camera["shutter_s"])


def distribution(values):
    """Mean and percentiles of values as plain numbers."""
    found = {"mean": float(values.mean())}
    return found | {f"p{p:02d}": float(value) for p, value in zip(PERCENTILES, np.percentile(values, PERCENTILES))}


def shares(linear, luminance_level, where):
    """Shares of pixels that clip, and that are black, of those chosen."""
    return {
        "clipped": float((linear[where] >= 1).any(axis=-1).mean()),
        "black": float((linear_to_srgb(luminance_level[where]) < FIRST_CODE).mean()),
    }


def judge(render, found):
    """All figures of the exposure, and the conditions that make it a good one."""
    camera = render.record["camera"]
    linear, luminance = developed(render), render.xyz[..., 1]
    level = luminance / float(camera["white_luminance_cd_m2"])
    target = metered_luminance(camera)
    mean = float(luminance[found.subject].mean())
    off = float(np.log2(mean / target)) if mean > 0 else -np.inf
    of_subject, of_frame = (shares(linear, level, where) for where in (found.subject, np.ones_like(found.subject)))
    conditions = (
        Condition("mean luminance against what a meter asks for", off, METER_STOPS, "stops", abs(off) <= METER_STOPS),
        Condition("clipped outside the lamp", 100 * of_subject["clipped"], 100 * CLIPPED_SHARE, "%", of_subject["clipped"] < CLIPPED_SHARE),
        Condition("below the first 8-bit level", 100 * of_subject["black"], 100 * BLACK_SHARE, "%", of_subject["black"] < BLACK_SHARE),
    )
    return {
        "well_exposed": all(condition.holds for condition in conditions),
        "conditions": [asdict(condition) for condition in conditions],
        "meter": {
            "asks_for_cd_m2": target, "subject_cd_m2": mean, "subject_relative_standard_error": relative_error_of_mean(render, found.subject),
            "subject_stops": off, "frame_cd_m2": float(luminance.mean()), "frame_stops": float(np.log2(max(luminance.mean(), 1e-30) / target)),
        },
        "pixels": {"subject": int(found.subject.sum()), "lamp": int(found.lamp.sum()), "frame": int(luminance.size)},
        "level": {"subject": distribution(level[found.subject]), "frame": distribution(level)},
        "shares": {"subject": of_subject, "frame": of_frame},
        "noise": noise(render, found.subject),
    }


def relative_error_of_mean(render, where):
    """Relative standard error of the mean luminance, pixels taken as independent."""
    total = render.xyz[..., 1][where].sum()
    return float(np.sqrt((render.stderr[..., 1][where] ** 2).sum()) / total) if total > 0 else None


def relative_errors(render, where):
    """Relative standard error of the luminance of each chosen pixel that has any."""
    luminance, error = render.xyz[..., 1][where], render.stderr[..., 1][where]
    return error[luminance > 0] / luminance[luminance > 0]


def noise(render, where):
    """How the relative standard error is distributed over pixels, and that of the picture as a whole."""
    errors = relative_errors(render, where)
    if not len(errors):
        return None
    return distribution(errors) | {
        "rms": float(np.sqrt((errors**2).mean())), "picture": render.record.get("relative_error"),
        "below_1_percent": float((errors < 0.01).mean()), "below_5_percent": float((errors < 0.05).mean()), "below_10_percent": float((errors < 0.1).mean()),
    }
