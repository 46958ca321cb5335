"""Many studies on one sheet: small panels of error against CPU seconds, and a table of efficiencies.

Everything is read from the `converge.json` files below one folder, so that
scenes may be studied one after the other, on different days, and the sheet
says no more than those files. A panel shows medians over all pixels; where the
error is that of a few pixels, the trimmed one stands beside it, broken.
"""

import io
import json
import math
from pathlib import Path

import matplotlib

from .converge_plot import COLOURS, GREY, INK, MARKERS
from .errors import InputError

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

COLUMNS, PANEL_IN = 4, (2.9, 2.35)
# Order of the legend and the table; what is not named here follows by name.
ORDER = ("path", "light", "bdpt", "mlt", "auto")

# What the sheet reads of a study.
NEEDED = {"series", "size", "date", "machine", "threads", "repeats"}


def read_studies(folder):
    """The studies below a folder, by the folder's name."""
    studies = {}
    for file in sorted(Path(folder).glob("*/converge.json")):
        try:
            studies[file.parent.name] = json.loads(file.read_text(encoding="utf-8"))
        except ValueError as error:
            raise InputError(file, f"is no study ({error})", "make it again, or remove it") from None
        if not isinstance(studies[file.parent.name], dict) or not NEEDED <= set(studies[file.parent.name]):
            raise InputError(file, "is no study", "make it again, or remove it")
    return studies


def write_overview(folder):
    """`overview.svg`, `overview.png` and `overview.md` of all studies below a folder; their paths."""
    studies = read_studies(folder)
    names = series_names(studies)
    figure = draw(studies, names)
    paths = [Path(folder) / f"overview.{kind}" for kind in ("svg", "png", "md")]
    for path in paths[:2]:
        buffer, kind = io.BytesIO(), path.suffix[1:]
        with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
            figure.savefig(buffer, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else None)
        path.write_bytes(buffer.getvalue())
    pyplot.close(figure)
    paths[2].write_text("\n".join(table(studies, names)) + "\n", encoding="utf-8")
    return paths


def series_names(studies):
    """All series that occur, in the order of the legend."""
    found = {name for study in studies.values() for name in study["series"]}
    return sorted(found, key=lambda name: (ORDER.index(name) if name in ORDER else len(ORDER), name))


def draw(studies, names):
    """The sheet."""
    rows = math.ceil((len(studies) + 1) / COLUMNS)
    wide, tall = PANEL_IN
    figure, grid = pyplot.subplots(rows, COLUMNS, figsize=(COLUMNS * wide, rows * tall), squeeze=False, layout="constrained")
    panels = list(grid.flat)
    for panel, (name, study) in zip(panels, studies.items()):
        draw_study(panel, name, study, names)
    for panel in panels[len(studies):]:
        panel.axis("off")
    lines = [pyplot.Line2D([], [], color=COLOURS[index % 7], marker=MARKERS[index % 7], label=name) for index, name in enumerate(names)]
    lines.append(pyplot.Line2D([], [], color=INK, linestyle=(0, (3, 2)), label="without the largest 0.1 % of pixels,\nwhere those are most of the error"))
    lines.append(pyplot.Line2D([], [], color=GREY, linewidth=0.8, linestyle="--", label="slope -1"))
    panels[len(studies)].legend(handles=lines, fontsize=7.6, loc="upper left", edgecolor="none")
    panels[len(studies)].text(0.02, 0.02, "\n".join(made_with(studies)), fontsize=6.2, color=INK, va="bottom", transform=panels[len(studies)].transAxes)
    figure.supxlabel("CPU seconds of the whole run", fontsize=9)
    figure.supylabel("relMSE of luminance, median", fontsize=9)
    return figure


def draw_study(panel, name, study, names):
    """One scene."""
    panel.set_xscale("log", base=2)
    panel.set_yscale("log")
    drawn = []
    for label, series in study["series"].items():
        index = names.index(label)
        points = [point for point in series["points"] if point["relmse_median"] > 0]
        x, y = [point["cpu_s_median"] for point in points], [point["relmse_median"] for point in points]
        look = {"color": COLOURS[index % 7], "linewidth": 1.2}
        panel.fill_between(x, [point["relmse_10"] if point["relmse_10"] > 0 else point["relmse_median"] for point in points], [point["relmse_90"] for point in points], color=look["color"], alpha=0.15, linewidth=0)
        panel.plot(x, y, marker=MARKERS[index % 7], markersize=3.2, **look)
        heavy = [point for point in points if "heavy tail" in point["flags"] and point["trimmed_median"] > 0]
        if heavy:
            panel.plot([point["cpu_s_median"] for point in heavy], [point["trimmed_median"] for point in heavy], linestyle=(0, (3, 2)), **look)
        drawn += zip(x, y)
    if drawn:
        product, low, high = min(x * y for x, y in drawn), min(x for x, _ in drawn), max(x for x, _ in drawn)
        panel.plot([low, high], [0.8 * product / low, 0.8 * product / high], color=GREY, linewidth=0.8, linestyle="--")
    panel.set_title(name, loc="left", fontsize=8.5)
    panel.tick_params(labelsize=7)
    panel.grid(color="#dcdddf", linewidth=0.5)
    panel.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def made_with(studies):
    """Program, machine and date, one line for each that occurs."""
    lines = set()
    for study in studies.values():
        size = "x".join(str(side) for side in study["size"])
        commit = (study.get("git_hash") or "unknown commit")[:12]
        lines.add(f"{study['date']}, {commit}\n{study['machine']['cpu']}, {study['threads'] or study['machine']['processors']} threads\n{size}, {study['repeats']} repeats a point")
    return sorted(lines)


def table(studies, names):
    """Efficiency over the best on each scene, with its 95 % interval: all pixels, then trimmed."""
    yield "| scene | " + " | ".join(names) + " |"
    yield "|---" * (len(names) + 1) + "|"
    for scene, study in studies.items():
        yield f"| {scene} | " + " | ".join(cell(study["series"].get(name)) for name in names) + " |"


def cell(series):
    """Both ratios of a series, and what is flagged about it."""
    if series is None:
        return ""
    both = " / ".join(ratio(series[name]) for name in ("ratio_to_best", "ratio_to_best_trimmed"))
    flags = [flag["name"] for flag in series["flags"] if flag["name"] in ("heavy tail", "bias floor", "disagreement", "few repeats")]
    return both + (f" ({', '.join(flags)})" if flags else "")


def ratio(estimate):
    """A ratio and its interval; a dash for what is not known of either."""
    if estimate is None:
        return "-"
    if estimate["high"] is None:
        return f"{estimate['value']:.2g} [-]"
    if estimate["value"] == estimate["low"] == estimate["high"] == 1:
        return "**1**"
    return f"{estimate['value']:.2g} [{estimate['low']:.2g}, {estimate['high']:.2g}]"
