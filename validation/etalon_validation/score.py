"""Scores a render against a photograph or a region table: the content of report.json.

Each level of the ladder is scored with the same draws of the same budget, so
that figures of two levels differ by the fit and by nothing else.
"""

import numpy as np

from . import __version__
from .budget import DRAWS, causes, distance_intervals, drawn, interval, spread, table as budget_table
from .calibration import PATTERNS
from .compare import compare
from .difference import ITP_WHITE_CD_M2, SRGB_TO_XYZ, above_white, chromaticity, delta_e_2000, delta_e_itp, duv
from .errors import InputError
from .findings import calibration_error, findings
from .fitted import parameter_intervals
from .ladder import EXPECTED_MIXTURE, NAMES, Setting, climb
from .perceptual import whole_picture
from .verdict import FALSE_ALARMS, judge, together, verdict

# Figures of every row of `regions`.
FIGURES = ("duv", "luminance_ratio", "delta_e_2000", "delta_e_itp")


def number(value, digits=6):
    """A finite number rounded for JSON, or None."""
    return round(float(value), digits) if np.isfinite(value) else None


def ends(values, digits=6):
    """An interval for JSON, or None where it has no finite ends."""
    pair = [number(value, digits) for value in values]
    return None if None in pair else pair


def score_level(level, both, regions, setting, all_causes, sides):
    """Figures, budget and verdicts of one level."""
    draws = spread(level.name, both, setting, sides)
    counted = np.array([region.flag is None for region in regions])
    rows, undefined = region_rows(level, both, regions, draws, counted)
    fitted = level.fitted | parameter_intervals(level.name, both, setting, all_causes)
    return {
        "title": NAMES[level.name], "fitted": fitted, "verdict": together(rows), "regions": rows, "undefined": undefined,
        "overall": overall(rows, undefined), "budget": budget_table(level.name, both, setting, all_causes, counted),
    }


def region_rows(level, both, regions, draws, counted):
    """A row of figures per region, and apart the regions where a side has no light."""
    predicted, photo = level.predicted @ both.to_xyz.T, both.photo @ both.to_xyz.T
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = predicted[:, 1] / photo[:, 1]
        log_ratio = np.log(np.where(ratio > 0, ratio, np.nan))
    figures = {"duv": duv(predicted, photo), "luminance_ratio": ratio, "delta_e_2000": delta_e_2000(predicted, photo), "delta_e_itp": delta_e_itp(predicted, photo)}
    intervals = distance_intervals(draws, both, predicted) | {"luminance_ratio": np.exp(interval(draws.log_ratio)).T}
    judged = judge(draws, log_ratio, chromaticity(predicted) - chromaticity(photo), counted)
    relative_photo = np.sqrt(both.photo_error**2 @ both.luminance**2) / np.maximum(photo[:, 1], 1e-12)
    too_bright = above_white(predicted, photo)
    rows, undefined = [], []
    for index, region in enumerate(regions):
        row = {
            "name": region.name, "surface": region.surface, "pixels": int(both.pixels[index]),
            "photo_linear": [number(value) for value in both.photo[index]],
            "predicted_linear": [number(value) for value in level.predicted[index]],
        }
        found = {key: number(figures[key][index], 3 if key.startswith("delta") else 6) for key in FIGURES}
        if None in found.values() or not ratio[index] > 0:
            reason = "the photograph" if not photo[index, 1] > 0 else "the render" if not predicted[index, 1] > 0 else "one side"
            undefined.append(row | {"reason": f"{reason} has no light here"})
            continue
        rows.append(row | found | {f"{key}_95": ends(intervals[key][index]) for key in FIGURES} | {
            "above_white": bool(too_bright[index]), "photo_luminance": number(photo[index, 1]),
            "render_noise": number(both.noise[index]), "photo_noise": number(relative_photo[index]),
            "render_noise_dominates": bool(both.noise[index] > relative_photo[index]),
            "in_overall": region.flag is None, "flag": region.flag,
        } | verdict_of(judged[index], intervals["duv"][index, 1] - figures["duv"][index]))
    return rows, undefined


def verdict_of(judged, duv_radius):
    """The verdict's keys of a region; all None where it is kept out."""
    if judged is None:
        return dict.fromkeys(("verdict", "multiple_of_u", "luminance_multiple_of_u", "chromaticity_multiple_of_u", "luminance_u", "p", "p_adjusted", "difference_matters"))
    shown = {key: value if isinstance(value, bool) else number(value) for key, value in judged.items()}
    return {"verdict": verdict(judged, duv_radius)} | shown


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
        "mean_delta_e_itp": some(column("delta_e_itp"), np.mean),
        "nrmse": number(nrmse), "count": len(counted),
        "left_out": [row["name"] for row in rows if not row["in_overall"]] + [row["name"] for row in undefined],
    }


def assumptions(both, render, reference, calibration):
    """What a reader must grant before the figures mean anything."""
    declared = "" if calibration.declared else " No calibration.json is there: calibration uncertainty is missing from every interval and verdict."
    return list(both.notes) + [
        f"Photograph: {reference['encoding']}.",
        f"The value 1 stands for {render.saturation:.6g} cd/m2 (the camera's saturation luminance).",
        "Colour differences compare region means under D65 at Y = 1 without chromatic adaptation; dE2000 of a region above white is marked and kept out of the mean.",
        f"dE ITP is absolute: both sides are seen with Y = 1 at {ITP_WHITE_CD_M2:g} cd/m2 (reference white of ITU-R BT.2408), not at the luminance of the scene.",
        f"Intervals are 95 %, from {DRAWS} draws of the whole budget with every fit made anew (JCGM 101): noise of both sides, rounding, registration and the declared calibration.{declared} Those of distances are the distance plus and minus the radius that holds 95 % of the draws, and are therefore rather too wide than too narrow.",
        f"A region differs where luminance ratio and chromaticity together fall outside the budget; of the regions called different at a level, at most {100 * FALSE_ALARMS:g} % are expected to be false alarms, whatever their errors share (Benjamini-Yekutieli).",
        "Regions whose mean linear value in the photograph is below 0.01, or of which more than 1 % is saturated there, are listed, flagged and kept out of fits and overall figures.",
        "A region's render value is the mean over its pixels with the mean's standard error; bright single pixels are neither removed nor clipped. Where that error is larger than the photograph's, the region says so.",
        f"L3 predicts every region with a matrix fitted without any region of its surface (leave one surface out). Its entries are expected within {EXPECTED_MIXTURE:g} of the channel gains, so that a colour that no other surface shows keeps the gains.",
        "L4 is L2 and a uniform veil: a share of the light, spread as the mean of the whole render, light from outside the frame not counted. It also predicts every region without its surface; below zero it is not glare.",
    ]


def score(table, regions, render, reference, calibration, photograph=None, inside=None):
    """The whole report as a JSON object, and the comparison and levels behind it.

    `inside` (h, w) marks the photograph's pixels that show the scene; None for all of them.
    """
    both = compare(table, regions, render, reference["encoding"], photograph)
    surfaces = np.array([region.surface for region in regions])
    usable = np.array([region.flag is None for region in regions])
    if len(set(surfaces[usable])) < 2:
        raise InputError(table.path, "all regions show one surface", "measure a second surface, the matrix is tested on surfaces it has not seen")
    setting = Setting.of(both.render, both.photo, both.luminance, surfaces, usable, both.mean_picture)
    levels = climb(both.render, both.photo, setting)
    all_causes = causes(both, surfaces, calibration)
    sides = drawn(both, all_causes)
    scored = {level.name: score_level(level, both, regions, setting, all_causes, sides) for level in levels}
    picture = whole_picture(photograph, both, levels, inside)
    record = render.record
    report = {
        "scene": record.get("scene"), "scene_hash": record.get("scene_hash"), "reference": reference,
        "calibration_error": calibration_error(scored, calibration), "levels": scored, "findings": findings(scored, calibration, picture), "picture": picture,
        "calibration": {
            "declared": calibration.declared, "draws": DRAWS, "place_px": number(calibration.place_px, 4),
            "components": [{"name": c.name, "pattern": c.pattern, "relative_standard_uncertainty": c.u, "kind": c.kind, "degrees_of_freedom": c.degrees_of_freedom, "removed_by": PATTERNS[c.pattern], "source": c.source} for c in calibration.components],
        },
        "samples_per_pixel": record.get("samples_per_pixel"), "seconds": record.get("seconds"), "cpu_seconds": record.get("cpu_seconds"),
        "version": record.get("version"), "integrator": record.get("integrator"), "seed": record.get("seed"),
        "render": {"file": render.file, "sha256": render.sha256, "width": render.size[0], "height": render.size[1]},
        "camera": record.get("camera"), "plan": record.get("plan", []), "itp_white_cd_m2": ITP_WHITE_CD_M2,
        "compared_in": "camera_rgb" if both.to_xyz is not SRGB_TO_XYZ else "linear_srgb",
        "assumptions": assumptions(both, render, reference, calibration), "harness_version": __version__,
    }
    return report, both, levels
