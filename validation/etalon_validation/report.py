"""Writes report.json and the self-contained report.html."""

import base64
import json
import math
import platform
from importlib import metadata
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined

from .maps import DUV_RANGE, SMOOTHED_PX, STOPS_RANGE, duv_map, gradient, resized, smoothed, stops_map
from .overlay import display, outlines_svg, spoken

PACKAGES = ("colour-science", "OpenImageIO", "numpy", "scipy", "matplotlib", "scikit-image", "flip-evaluator")
# Bars in the region table end here.
BAR_DUV = 0.06
BAR_STOPS = 1.0
BAR_DELTA_E = 20.0
# Ends of the luminance chart, stops relative to white.
CHART_STOPS = (-7.5, 0.5)
SPACES = {"linear_srgb": "linear sRGB", "camera_rgb": "camera RGB"}


def environment():
    """Versions of everything that takes part in the figures."""
    return {"python": platform.python_version()} | {name: metadata.version(name) for name in PACKAGES}


def data_uri(png_bytes):
    """PNG bytes as a data URI."""
    return "data:image/png;base64," + base64.b64encode(png_bytes).decode("ascii")


def write_report(folder, report, table, regions, render, photograph, both, levels):
    """Both reports into `folder`; maps are drawn only when the photograph is at hand."""
    folder = Path(folder)
    report["environment"] = environment()
    report = finite(report)
    (folder / "report.json").write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    engine = Environment(loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    engine.filters["fixed"] = lambda value, digits: "–" if value is None else f"{value:.{digits}f}"
    engine.filters["spoken"] = spoken
    engine.filters["range"] = lambda ends, pattern: "–" if not ends or None in ends else f"{pattern % ends[0]} to {pattern % ends[1]}".replace("-", "−")
    engine.filters["stops"] = lambda ratio: np.log2(ratio) if ratio and ratio > 0 else None
    page = engine.get_template("report.html.jinja").render(
        report=report, images=images(table, render, photograph, both, levels),
        outlines=outlines_svg(regions, table.size), size=table.size, chart=chart(report), fits=fits(report),
        bars={"duv": BAR_DUV, "stops": BAR_STOPS, "delta_e": BAR_DELTA_E},
        stops_gradient=gradient("RdBu_r"), duv_gradient=gradient("viridis"), stops_range=STOPS_RANGE, duv_range=DUV_RANGE,
        smoothed_px=SMOOTHED_PX, chart_stops=CHART_STOPS, space=SPACES[report["compared_in"]],
    )
    (folder / "report.html").write_text(page, encoding="utf-8")


def finite(value):
    """The same JSON value with None where a number is not finite."""
    if isinstance(value, dict):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [finite(entry) for entry in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def images(table, render, photograph, both, levels):
    """Photograph, render and maps of each level as data URIs; without a photograph the renders alone."""
    channels = resized(both.channels, table.size)
    found = {"renders": {}, "stops": {}, "duv": {}, "photo": None}
    for level in levels:
        found["renders"][level.name] = data_uri(display(level.apply(channels)))
    if photograph is not None:
        found["photo"] = data_uri(display(photograph.rgb))
        photo_xyz = smoothed(photograph.rgb @ both.to_xyz.T)
        for level in levels[1:]:
            predicted = smoothed(level.apply(channels) @ both.to_xyz.T)
            found["stops"][level.name] = data_uri(stops_map(predicted[..., 1], photo_xyz[..., 1]))
            found["duv"][level.name] = data_uri(duv_map(predicted, photo_xyz))
    return found


def fits(report):
    """One sentence per level: what was fitted."""
    sentence = {"L0": "Nothing was fitted."}
    one = report["levels"]["L1"]["fitted"]
    sentence["L1"] = f"The render is exposed by {one['exposure_stops']:+.2f} stops (factor {one['exposure_factor']:.3g})."
    gains = report["levels"]["L2"]["fitted"]["gains"]
    sentence["L2"] = "Gains R, G, B: " + ", ".join(f"{gain:.3g}" for gain in gains) + "."
    rows = report["levels"]["L3"]["fitted"]["matrix_all_regions"]
    sentence["L3"] = (
        "Matrix on all regions: " + "; ".join(" ".join(f"{value:+.3f}" for value in row) for row in rows)
        + ". Each figure below comes from a matrix fitted without that region's surface. Images and maps use the matrix on all regions."
    )
    veil = report["levels"]["L4"]["fitted"]
    sentence["L4"] = (
        f"Veiling glare of {100 * veil['glare_share']:.2g} % of the light, and gains R, G, B: " + ", ".join(f"{gain:.3g}" for gain in veil["gains"])
        + ". Each figure below comes from a fit without that region's surface. Images and maps use the fit on all regions."
    )
    return sentence


def chart(report):
    """Log-log dots of render against photograph luminance per level, as percentages of the plot."""
    points = {}
    low, high = CHART_STOPS
    for name, level in report["levels"].items():
        points[name] = []
        for row in level["regions"]:
            photo, ratio = row["photo_luminance"], row["luminance_ratio"]
            x, y = np.log2(photo), np.log2(photo * ratio)
            place = [round(float(100 * (np.clip(value, low, high) - low) / (high - low)), 2) for value in (x, y)]
            colour = np.clip(np.array(row["photo_linear"]) / max(max(row["photo_linear"]), 1e-6), 0, 1) ** (1 / 2.2)
            points[name].append({"x": place[0], "y": 100 - place[1], "name": spoken(row["name"]), "dark": not row["in_overall"], "colour": "#%02x%02x%02x" % tuple(int(255 * c) for c in colour)})
    return points
