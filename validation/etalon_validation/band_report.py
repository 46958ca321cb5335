"""Writes the report of a render scored band by band: report.json and report.html."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np
from matplotlib import pyplot

from . import __version__
from .band_regions import find_regions, read_scene
from .band_score import DARK_SHARE, measure_images, measure_render, score_bands
from .bands import read_bands, read_plan
from .lens import model_field
from .maps import STOPS_RANGE, gradient, resized, smoothed, stops_map
from .overlay import display
from .page import svg, today, write_page
from .registration import scene_camera
from .render import check_scene, read_channels, read_render
from .report import data_uri, environment, finite
from .thumbnails import write_pair

# Pictures in the page are at most this wide: seven bands of two megapixels would weigh 50 MB.
PAGE_WIDTH_PX = 560
# The picture of a band is shown with this percentile at white.
WHITE_PERCENTILE = 99.0


def fallen_off(channels, render, scene, render_file):
    """Band channels (bands, height, width) with the vignetting that the render's record states."""
    facts = render.record["camera"]
    camera = scene_camera(scene, scene["length_unit"], render.size)
    factors, _ = model_field(facts.get("vignetting"), facts, camera, render_file) if camera else (None, None)
    return channels if factors is None else channels * factors[..., 0]


def band_report(case, render_file, place, points, output):
    """Scores a render against band images and writes both reports; returns the report."""
    plan = read_plan(case)
    scene, scene_path = read_scene(case)
    render = read_render(render_file)
    channels = read_channels(render_file, [band.channel for band in plan.bands])
    check_scene(render, case)
    channels = fallen_off(channels, render, scene, render_file)
    images = read_bands(place, plan)
    sight = find_regions(plan, scene, scene_path, render.size, images.size, points)
    photo = measure_images(images, sight.pairs)
    rendered = measure_render(channels, render.xyz[..., 1], render.stderr[..., 1], sight.pairs)
    levels = score_bands(plan.bands, sight.pairs, photo, rendered, place)
    report = finite(compose(plan, render, images, sight, levels))
    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    (output / "report.json").write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    pictures = {str(band.nm): picture(images.values[i], channels[i], sight) for i, band in enumerate(plan.bands)}
    middle = next(i for i, band in enumerate(plan.bands) if band.counted)
    write_pair(output, grey(channels[middle]), grey(images.values[middle]))
    write_page(
        output / "report.html", "bands.html.jinja", report=report, pictures=pictures, size=images.size, plot=svg(factor_plot(report)),
        stops_gradient=gradient("RdBu_r"), stops_range=STOPS_RANGE, dark_percent=100 * DARK_SHARE, today=today(), percentile=WHITE_PERCENTILE, shown=plan.bands[middle].nm,
    )
    return report


def compose(plan, render, images, sight, levels):
    """The content of report.json."""
    record = render.record
    reference = {
        "kind": "bands", "file": images.file, "sha256": images.sha256, "hashes": images.hashes, "archive": images.archive,
        "response": images.response, "warnings": warnings(images, sight),
    }
    return {
        "kind": "bands", "scene": record.get("scene"), "scene_hash": record.get("scene_hash"), "reference": reference,
        "bands": [asdict(band) for band in plan.bands], "pose": sight.pose, "dropped": list(sight.dropped), "assumptions": [str(line) for line in plan.table.get("assumptions", [])], "levels": levels,
        "samples_per_pixel": record.get("samples_per_pixel"), "seconds": record.get("seconds"), "cpu_seconds": record.get("cpu_seconds"),
        "version": record.get("version"), "integrator": record.get("integrator"), "seed": record.get("seed"), "camera": record.get("camera"),
        "render": {"file": render.file, "sha256": render.sha256, "width": render.size[0], "height": render.size[1]},
        "harness_version": __version__, "environment": environment(),
    }


def warnings(images, sight):
    """What a reader must know before any figure."""
    found = []
    if not images.archive.startswith("known"):
        found.append(f"{images.file}: not known to be the published archive ({images.archive})")
    if sight.pose["kind"] == "scene":
        found.append("the pose of the camera is not published and no points were given: it is taken to be the scene's, and regions may show other parts of the box than the render's")
    return found


def grey(values):
    """A band as linear RGB with its white percentile at 1."""
    white = max(np.percentile(values, WHITE_PERCENTILE), 1e-30)
    return np.repeat(np.clip(values / white, 0, 1)[..., None], 3, axis=-1)


def picture(photo, render, sight):
    """Photograph, render, and where both have one camera their ratio, as data URIs."""
    width = min(PAGE_WIDTH_PX, photo.shape[1])
    size = (width, round(width * photo.shape[0] / photo.shape[1]))
    theirs, ours = (resized(values[..., None], size)[..., 0] for values in (photo, render))
    found = {"photo": data_uri(display(grey(theirs))), "render": data_uri(display(grey(ours))), "stops": None}
    if sight.pose["kind"] == "scene":
        theirs, ours = (resized(smoothed(values[..., None]), size)[..., 0] for values in (photo, render))
        found["stops"] = ratio_map(theirs, ours)
    return found


def ratio_map(photo, render):
    """The map of the render over the photograph in stops, with the median ratio taken out; None where all is dark."""
    lit = (photo > DARK_SHARE * photo.max()) & (render > 0)
    if not lit.any():
        return None
    factor = np.median(photo[lit] / render[lit])
    return data_uri(stops_map(factor * render / photo.max(), photo / photo.max()))


def factor_plot(report):
    """Each band's factor against the common one, with its interval."""
    figure, axes = pyplot.subplots(figsize=(7.2, 3.2), layout="constrained")
    one = report["levels"]["L1"]["fitted"]["log2_factor"]
    for band in report["bands"]:
        fitted = report["levels"]["L2"]["fitted"][str(band["nm"])]
        if fitted["log2_factor"] is None:
            continue
        at, ends = fitted["log2_factor"] - one, fitted["interval_95"] or [fitted["log2_factor"]] * 2
        ink = "#2563a8" if band["counted"] else "#9a9da3"
        axes.errorbar(band["nm"], at, [[max(fitted["log2_factor"] - ends[0], 0)], [max(ends[1] - fitted["log2_factor"], 0)]], fmt="o", color=ink, capsize=4)
    axes.axhline(0, color="#1c1d1f", linewidth=0.8)
    axes.grid(color="#dcdddf", linewidth=0.6)
    axes.set(xlabel="band, nm", ylabel="band over common, stops")
    return figure


def describe(report):
    """A line per level and per band for the terminal."""
    lines = [f"{name} rms {show(level['overall']['rms_stops'])} stops over the counted bands" for name, level in report["levels"].items()]
    for band in report["bands"]:
        fitted, left = (report["levels"]["L2"][key][str(band["nm"])] for key in ("fitted", "bands"))
        lines.append(f"{band['nm']} nm  factor {show(fitted['stops_from_common'], sign=True)} stops from the common, rms {show(left['rms_stops'])} stops{'' if band['counted'] else '  (not counted)'}")
    return "\n".join(lines)


def show(value, sign=False):
    """A number for the terminal; a dash where there is none."""
    return "-" if value is None else f"{value:{'+' if sign else ''}.3f}"
