"""Scores a render against a photograph or a region table: the content of report.json."""

from dataclasses import dataclass

import numpy as np

from . import __version__
from .difference import SRGB_TO_XYZ, XYZ_TO_SRGB, above_white, delta_e_2000, duv
from .errors import InputError
from .ladder import EXPECTED_MIXTURE, NAMES, climb
from .polygons import mask

# Draws behind each 95 % interval, and their seed: intervals are reproducible.
DRAWS = 400
SEED = 20070711


@dataclass(frozen=True)
class Comparison:
    """Region means of render and photograph in one space of three channels."""

    render: np.ndarray
    render_error: np.ndarray
    photo: np.ndarray
    photo_error: np.ndarray
    to_xyz: np.ndarray
    pixels: np.ndarray
    channels: np.ndarray
    luminance: np.ndarray
    noise: np.ndarray
    notes: tuple


def scaled_polygon(region, table, render):
    """A region's polygon in the pixels of a render that may be larger or smaller than the photograph."""
    if region.in_render is not None:
        return region.in_render
    scale = np.array(render.size, float) / np.array(table.size, float)
    if abs(scale[0] / scale[1] - 1) > 0.005:
        raise InputError(render.file, f"has {render.size} pixels, the photograph {table.size}", "render at the photograph's aspect ratio")
    return region.polygon * scale


def region_means(values, errors, masks):
    """Means over each mask and their standard errors, pixels taken as independent."""
    means = np.array([values[inside].mean(axis=0) for inside in masks])
    spread = np.array([np.sqrt((errors[inside] ** 2).sum(axis=0)) / inside.sum() for inside in masks])
    return means, spread


def compare(table, regions, render):
    """Brings render and photograph into one space: the camera's channels if both have them, else linear sRGB."""
    masks = [mask(scaled_polygon(region, table, render), render.size) for region in regions]
    for region, inside in zip(regions, masks):
        if not inside.any():
            raise InputError(render.file, f'no pixel lies in region "{region.name}"', "render at a higher resolution")
    xyz, xyz_error = region_means(render.xyz / render.saturation, render.stderr / render.saturation, masks)
    photo = np.array([region.rgb for region in regions])
    photo_error = np.array([region.error for region in regions])
    usable = np.array([not region.dark for region in regions])
    if usable.sum() < 4:
        raise InputError(table.path, f"{usable.sum()} regions are bright enough to fit", "measure more regions")
    pixels = np.array([inside.sum() for inside in masks])
    noise = xyz_error[:, 1] / np.maximum(xyz[:, 1], 1e-12)
    if table.space == "camera_rgb" and render.sensor is not None:
        sensor = np.array([render.sensor[inside].mean(axis=0) for inside in masks])
        scale = xyz[usable, 1].mean() / sensor[usable, 1].mean()
        # The metric that turns camera channels into XYZ comes from the render alone.
        weights = 1 / np.maximum(xyz[usable, 1:2], 1e-9)
        to_xyz = np.linalg.lstsq(scale * sensor[usable] * weights, xyz[usable] * weights, rcond=None)[0].T
        relative = xyz_error / np.maximum(xyz, 1e-12)
        notes = (
            "Compared in camera RGB: render radiance weighted with the camera's sensitivity, scaled so that the mean green value equals the mean luminance over saturation. L0 and L1 stand on this scale.",
            "u'v', luminance and dE2000 need XYZ: one matrix from camera RGB to XYZ, fitted on the render's own regions without any photograph value, is applied to both sides.",
        )
        return Comparison(scale * sensor, scale * sensor * relative, photo, photo_error, to_xyz, pixels, scale * render.sensor, to_xyz[1], noise, notes)
    notes = ("Compared in linear sRGB with white D65: the photograph's colour encoding is assumed, not known.",)
    if table.space == "camera_rgb":
        notes += ("The photograph is camera RGB but the render has no sensor channels: below L3 its chromaticity is not comparable.",)
    to_rgb = XYZ_TO_SRGB.T
    return Comparison(
        xyz @ to_rgb, np.sqrt(xyz_error**2 @ to_rgb**2), photo, photo_error, SRGB_TO_XYZ,
        pixels, render.xyz / render.saturation @ to_rgb, SRGB_TO_XYZ[1], noise, notes,
    )


def interval(values):
    """The central 95 % of draws along the first axis, as a list of [low, high] or None."""
    finite = [column[np.isfinite(column)] for column in values.T]
    return [[number(end) for end in np.percentile(column, (2.5, 97.5))] if len(column) else None for column in finite]


def number(value, digits=6):
    """A finite number rounded for JSON, or None."""
    return round(float(value), digits) if np.isfinite(value) else None


def score_level(level, both, regions):
    """Per-region and overall figures of one level."""
    predicted, photo = level.predicted @ both.to_xyz.T, both.photo @ both.to_xyz.T
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = predicted[:, 1] / photo[:, 1]
    distance, difference = duv(predicted, photo), delta_e_2000(predicted, photo)
    generator = np.random.default_rng(SEED)
    draws = (DRAWS, *both.photo.shape)
    noisy_photo = (both.photo + both.photo_error * generator.standard_normal(draws)) @ both.to_xyz.T
    noisy_render = both.render + both.render_error * generator.standard_normal(draws)
    noisy = np.einsum("nij,dnj->dni", level.matrices, noisy_render) @ both.to_xyz.T
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio_interval = interval(noisy[..., 1] / noisy_photo[..., 1])
    duv_interval = interval(duv(noisy, noisy_photo))
    rows, undefined = [], []
    relative_photo = np.sqrt((both.photo_error**2) @ both.to_xyz[1] ** 2) / np.maximum(photo[:, 1], 1e-12)
    too_bright = above_white(predicted, photo)
    for index, region in enumerate(regions):
        row = {
            "name": region.name, "surface": region.surface, "pixels": int(both.pixels[index]),
            "photo_linear": [number(value) for value in both.photo[index]],
            "predicted_linear": [number(value) for value in level.predicted[index]],
        }
        figures = {"duv": number(distance[index]), "luminance_ratio": number(ratio[index]), "delta_e_2000": number(difference[index], 3)}
        if None in figures.values():
            reason = "the photograph" if not photo[index, 1] > 0 else "the render" if not predicted[index, 1] > 0 else "one side"
            undefined.append(row | {"reason": f"{reason} has no light here"})
            continue
        rows.append(row | figures | {
            "duv_95": duv_interval[index], "luminance_ratio_95": ratio_interval[index], "above_white": bool(too_bright[index]),
            "photo_luminance": number(photo[index, 1]),
            "render_noise": number(both.noise[index]), "photo_noise": number(relative_photo[index]),
            "render_noise_dominates": bool(both.noise[index] > relative_photo[index]),
            "in_overall": not region.dark, "flag": "photograph at its black level" if region.dark else None,
        })
    return {"title": NAMES[level.name], "fitted": level.fitted, "regions": rows, "undefined": undefined, "overall": overall(rows, undefined)}


def overall(rows, undefined):
    """Means over the regions that the photograph resolves; each count says over how many its figure is defined."""
    counted = [row for row in rows if row["in_overall"]]

    def column(key):
        return np.array([row[key] for row in counted], float)

    distance, ratio = column("duv"), column("luminance_ratio")
    difference = np.array([row["delta_e_2000"] for row in counted if not row["above_white"]], float)
    stops = np.log2(ratio)
    predicted, photo = column("predicted_linear"), column("photo_linear")
    nrmse = np.sqrt(((predicted - photo) ** 2).mean()) / photo.mean() if counted else np.nan

    def some(values, reduce):
        return number(reduce(values)) if len(values) else None

    return {
        "mean_duv": some(distance, np.mean), "median_duv": some(distance, np.median), "max_duv": some(distance, np.max),
        "rms_stops": some(stops**2, lambda squares: np.sqrt(squares.mean())),
        "mean_delta_e_2000": some(difference, np.mean), "delta_e_2000_count": len(difference),
        "nrmse": number(nrmse), "count": len(counted),
        "left_out": [row["name"] for row in rows if not row["in_overall"]] + [row["name"] for row in undefined],
    }


def score(table, regions, render, reference):
    """The whole report as a JSON object, and the comparison and levels behind it."""
    both = compare(table, regions, render)
    surfaces = [region.surface for region in regions]
    usable = np.array([not region.dark for region in regions])
    if len(set(np.asarray(surfaces)[usable])) < 2:
        raise InputError(table.path, "all regions show one surface", "measure a second surface, the matrix is tested on surfaces it has not seen")
    levels = climb(both.render, both.photo, both.luminance, surfaces, usable)
    record = render.record
    assumptions = list(both.notes) + [
        f"Photograph: {reference['encoding']}.",
        f"The value 1 stands for {render.saturation:.6g} cd/m2 (the camera's saturation luminance).",
        "Colour differences compare region means under D65 at Y = 1 without chromatic adaptation; dE2000 of a region above white is marked and kept out of the mean.",
        "Intervals are 95 %: render noise (pixels and channels independent, which makes the interval of u'v' too wide rather than too narrow) and the photograph's spread (3 x 3 pixels counted as one); fits are held fixed; calibration, glare and vignetting are not included.",
        "Regions whose mean linear value in the photograph is below 0.01 are listed, flagged and kept out of fits and overall figures.",
        "A region's render value is the mean over its pixels with the mean's standard error; bright single pixels are neither removed nor clipped. Where that error is larger than the photograph's, the region says so.",
        f"L3 predicts every region with a matrix fitted without any region of its surface (leave one surface out). Its entries are expected within {EXPECTED_MIXTURE:g} of the channel gains, so that a colour that no other surface shows keeps the gains.",
    ]
    report = {
        "scene": record.get("scene"), "scene_hash": record.get("scene_hash"), "reference": reference,
        "levels": {level.name: score_level(level, both, regions) for level in levels},
        "samples_per_pixel": record.get("samples_per_pixel"), "seconds": record.get("seconds"), "cpu_seconds": record.get("cpu_seconds"),
        "version": record.get("version"), "integrator": record.get("integrator"), "seed": record.get("seed"),
        "render": {"file": render.file, "sha256": render.sha256, "width": render.size[0], "height": render.size[1]},
        "camera": record.get("camera"), "plan": record.get("plan", []),
        "compared_in": "camera_rgb" if both.to_xyz is not SRGB_TO_XYZ else "linear_srgb",
        "assumptions": assumptions, "harness_version": __version__,
    }
    return report, both, levels
