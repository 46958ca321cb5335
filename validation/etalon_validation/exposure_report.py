"""The report of a picture that no photograph exists of: its exposure, its time, its noise."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import pyplot

from . import __version__
from .errors import InputError, meaning, read_json
from .exposure import METER_K, PERCENTILES, developed, judge, metered_luminance, parts, relative_errors
from .lens import model_field
from .overlay import display
from .page import svg, today, write_page
from .photograph import srgb_to_linear
from .registration import scene_camera
from .render import check_scene
from .report import data_uri, environment, finite
from .thumbnails import write_thumbnail

# Speed points of ISO 12232 and ISO 2720 and the developed level of a mid grey, for comparison between anchors.
SATURATION_LX_S, SOS_LX_S, MID_GREY = 78.0, 10.0, 0.18
# Ends of the histogram, in stops below saturation.
HISTOGRAM_STOPS = (-13, 2)
# Smaller relative errors than this are drawn at the edge of the noise plot.
LEAST_DRAWN = 1e-3
ACCENT, WARN, LAMP = "#2563a8", "#a05a00", "#c9a227"


def fallen_off(render, camera):
    """The render as it falls on the sensor, with the vignetting that its record states."""
    facts = render.record["camera"]
    factors, _ = model_field(facts.get("vignetting"), facts, camera, render.file)
    return render if factors is None else replace(render, xyz=render.xyz * factors, stderr=render.stderr * factors)


def exposure_report(case, render, output, threads):
    """Writes report.json, report.html and the thumbnail; returns the report."""
    check_scene(render, case)
    plan_file = Path(case) / "exposure.json"
    plan = read_json(plan_file, "a case that is judged by its exposure needs it")
    scene = read_json(Path(case) / "scene.json", "correct it")
    with meaning(plan_file, "correct it"):
        camera = scene_camera(scene, scene["length_unit"], render.size)
        if camera is None:
            raise InputError(Path(case) / "scene.json", "has no camera", "add one")
        render = fallen_off(render, camera)
        found = parts(camera, plan, scene, plan_file)
        published = dict(plan["published"])
        times = published_times(published, render.record)
    if not found.subject.any():
        raise InputError(render.file, "no pixel lies in the subject", "render at a higher resolution")
    report = finite(compose(render, found, plan["subject"]["name"], published, times, threads))
    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    (output / "report.json").write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    write_thumbnail(output / "thumbnail-render.png", np.clip(developed(render), 0, 1))
    write_page(
        output / "report.html", "exposure.html.jinja", report=report, size=render.size, picture=data_uri(display(developed(render))),
        histogram=svg(histogram(render, found)), noise_plot=svg(noise_plot(render, found)), percentiles=PERCENTILES, meter_k=METER_K, today=today(),
    )
    return report


def compose(render, found, subject, published, times, threads):
    """The content of report.json."""
    record, camera = render.record, render.record["camera"]
    width, height = render.size
    q = float(camera["exposure_constant_q"])
    return {
        "kind": "exposure", "scene": record.get("scene"), "scene_hash": record.get("scene_hash"), "subject": subject,
        "exposure": judge(render, found), "camera": camera, "anchors": anchors(camera, q),
        "published": published, "times": times, "threads": threads, "processor": processor(),
        "samples_per_pixel": record.get("samples_per_pixel"), "paths": (record.get("samples_per_pixel") or 0) * width * height,
        "seconds": record.get("seconds"), "cpu_seconds": record.get("cpu_seconds"), "integrator": record.get("integrator"), "seed": record.get("seed"),
        "version": record.get("version"), "plan": record.get("plan", []), "missing": record.get("missing", []),
        "render": {"file": render.file, "sha256": render.sha256, "width": width, "height": height},
        "harness_version": __version__, "environment": environment(),
    }


def anchors(camera, q):
    """How much brighter than with the camera's own anchor the picture would be developed with each, in stops."""
    scale = camera["f_stop"] ** 2 / (camera["iso"] * camera["shutter_s"])
    whites = {"saturation": SATURATION_LX_S / q * scale, "sos": SOS_LX_S / q * scale / MID_GREY, "meter": metered_luminance(camera) / MID_GREY}
    return {name: {"white_luminance_cd_m2": white, "stops": float(np.log2(camera["white_luminance_cd_m2"] / white))} for name, white in whites.items()}


def published_times(published, record):
    """The published times, each with its ratio to the processor seconds of this render."""
    cpu = record.get("cpu_seconds")
    return [entry | {"seconds": float(entry["seconds"]), "over_cpu_seconds": float(entry["seconds"]) / cpu if cpu else None} for entry in published["times"]]


def processor():
    """The processor's name as Linux tells it, or None."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), None)


def histogram(render, found):
    """Levels of the subject and the lamp in stops below saturation."""
    level = render.xyz[..., 1] / render.saturation
    bins = np.linspace(*HISTOGRAM_STOPS, 8 * (HISTOGRAM_STOPS[1] - HISTOGRAM_STOPS[0]) + 1)
    figure, axes = pyplot.subplots(figsize=(7.2, 3.2), layout="constrained")
    for name, where, ink in (("subject", found.subject, ACCENT), ("lamp", found.lamp, LAMP)):
        stops = np.log2(np.maximum(level[where], 1e-12))
        weights = np.full(stops.size, 100 / max(found.subject.sum(), 1))
        axes.hist(np.clip(stops, *HISTOGRAM_STOPS), bins=bins, weights=weights, color=ink, alpha=0.85, label=name)
    camera = render.record["camera"]
    code = float(srgb_to_linear(1 / 255)) * camera["white_luminance_cd_m2"] / render.saturation
    marks = (("saturation", 1.0), ("meter", metered_luminance(camera) / render.saturation), ("8-bit 1", code))
    for name, at in marks:
        axes.axvline(np.log2(at), color=WARN, linewidth=1)
        axes.text(np.log2(at), 1.01, name, color=WARN, fontsize=8, ha="center", va="bottom", transform=axes.get_xaxis_transform())
    axes.set(xlim=HISTOGRAM_STOPS, xlabel="luminance in stops relative to the saturation luminance", ylabel="% of the subject's pixels")
    axes.legend(frameon=False, fontsize=8)
    return figure


def noise_plot(render, found):
    """Share of the subject's pixels whose relative standard error is below a value."""
    errors = np.sort(relative_errors(render, found.subject))
    figure, axes = pyplot.subplots(figsize=(7.2, 3.2), layout="constrained")
    if len(errors):
        axes.plot(100 * np.maximum(errors, LEAST_DRAWN), 100 * (np.arange(len(errors)) + 1) / len(errors), color=ACCENT, linewidth=1.8)
    axes.set(xscale="log", xlim=(100 * LEAST_DRAWN, 100), ylim=(0, 100), xlabel="relative standard error of a pixel's luminance, %", ylabel="% of pixels below")
    axes.grid(color="#dcdddf", linewidth=0.6)
    return figure
