"""Draws a study: error against CPU seconds on logarithmic axes, and efficiency over the best.

Plain and trimmed errors stand side by side on the same scale, so that what a
few pixels do is seen. Lines join medians, shades are 10 to 90 % of the repeats;
slopes and efficiencies are those of the means and say so in numbers. Colours
are Okabe and Ito's, markers differ too: nothing is told by colour alone.
"""

import io
import textwrap
from pathlib import Path

import matplotlib
import numpy as np

from .converge_analysis import REFERENCE_SHARE

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
MARKERS = ("o", "s", "^", "D", "v", "P", "X")
INK, GREY, SHADE = "#1c1d1f", "#8a8d91", "#ececee"
WIDTH_IN, PANELS_IN, LINE_IN = 11.5, 4.3, 0.17
CAPTION_CHARACTERS = 165
# What fits beside the panel of efficiencies.
TICK_CHARACTERS = 10
SECONDS = "CPU seconds of the whole run"
# Room beyond the smallest and largest value of a logarithmic axis, as a factor.
MARGIN = 1.35
KINDS = (("relmse", "relative mean squared error of luminance", "all pixels"), ("trimmed", "", "without the largest 0.1 % of pixels"))


def plot(reports, folder, caption, reference_relmse=None, stem="converge", seconds=SECONDS):
    """Writes `converge.svg` and `converge.png`, or another stem, into a folder and returns their paths.

    `reports` are `SeriesReport`s in the order of the legend, `caption` the lines below the
    figure (scene, size, date, machine), `reference_relmse` the reference's own error or None.
    """
    figure = draw(reports, caption, reference_relmse, seconds)
    paths = [Path(folder) / f"{stem}.{kind}" for kind in ("svg", "png")]
    for path in paths:
        # To memory first: a failure leaves no half-written file. Without a date files compare.
        buffer, kind = io.BytesIO(), path.suffix[1:]
        with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
            figure.savefig(buffer, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else None)
        path.write_bytes(buffer.getvalue())
    pyplot.close(figure)
    return paths


def draw(reports, caption, reference_relmse, seconds=SECONDS):
    """The figure: two panels of errors, one of efficiencies, flags and caption below."""
    remarks = [f"{report.name}: {flag.name}: {flag.text}" for report in reports for flag in report.flags]
    remarks = [line for text in remarks + [""] + list(caption) for line in textwrap.wrap(text, CAPTION_CHARACTERS, subsequent_indent="    ") or [""]]
    below = 0.75 + LINE_IN * len(remarks)
    height = PANELS_IN + below
    figure = pyplot.figure(figsize=(WIDTH_IN, height))
    bottom, tall = below / height, (PANELS_IN - 0.4) / height
    left = figure.add_axes((0.065, bottom, 0.345, tall))
    right = figure.add_axes((0.425, bottom, 0.345, tall), sharex=left, sharey=left)
    for axes, (kind, label, title) in zip((left, right), KINDS):
        draw_errors(axes, reports, kind, reference_relmse if kind == "relmse" else None)
        axes.set_title(title, loc="left", fontsize=10)
        axes.set_xlabel(seconds)
        axes.set_ylabel(label)
    right.tick_params(labelleft=False, which="both")
    limit(left, reports)
    draw_efficiencies(figure.add_axes((0.845, bottom, 0.14, tall)), reports)
    figure.text(0.012, 0.1 / height, "\n".join(remarks), fontsize=7.4, va="bottom", linespacing=1.35, color=INK)
    return figure


def look(index):
    """Colour and marker of a series by its place."""
    return COLOURS[index % len(COLOURS)], MARKERS[index % len(MARKERS)]


def draw_errors(axes, reports, kind, reference_relmse):
    """One panel: medians, bands, biases, the reference's own error, and a line of slope -1."""
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    if reference_relmse:
        edge = reference_relmse / REFERENCE_SHARE
        axes.axhspan(0, edge, color=SHADE, zorder=0, label=f"reference floor: below {edge:.1e}")
    for index, report in enumerate(reports):
        colour, marker = look(index)
        x = np.array([point.cpu_s_median for point in report.points])
        low, middle, high = (np.array([getattr(point, f"{kind}_{name}") for point in report.points]) for name in ("10", "median", "90"))
        seen = middle > 0
        if not seen.any():
            continue
        axes.fill_between(x[seen], np.where(low > 0, low, middle / 100)[seen], high[seen], color=colour, alpha=0.2, linewidth=0)
        axes.plot(x[seen], middle[seen], color=colour, marker=marker, markersize=5, linewidth=1.5, label=label_of(report, kind))
        if kind == "relmse" and report.bias is not None and report.bias.is_significant:
            axes.axhline(report.bias.squared.value, color=colour, linewidth=1, linestyle=(0, (1, 2)), label=f"{report.name}: squared " + ("bias" if any(flag.name == "bias floor" for flag in report.flags) else "difference"))
    guide(axes, reports, kind)
    axes.grid(color="#dcdddf", linewidth=0.6)
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.legend(fontsize=7.6, loc="upper right", framealpha=0.85, edgecolor="none")


def label_of(report, kind):
    """A legend entry: name, slope with its interval, set-up."""
    slope = getattr(report.fit, kind)
    words = "slope not known" if slope is None or not np.isfinite(slope.high) else f"slope {slope.value:.2f} [{slope.low:.2f}, {slope.high:.2f}]"
    setup = report.points[-1].setup_cpu_s
    return f"{report.name}: {words}" + (f", set-up {setup:.2g} s" if setup is not None and kind == "relmse" else "")


def guide(axes, reports, kind):
    """A line of slope -1 just below the lowest series."""
    found = [(point.cpu_s_median, getattr(point, f"{kind}_median")) for report in reports for point in report.points]
    found = [(x, y) for x, y in found if y > 0]
    if not found:
        return
    x = np.array([min(x for x, _ in found), max(x for x, _ in found)])
    axes.plot(x, 0.8 * min(x * y for x, y in found) / x, color=GREY, linewidth=1, linestyle="--", label="slope -1")


def limit(axes, reports):
    """Limits of both panels: all medians and bands, and room for the legend."""
    points = [point for report in reports for point in report.points]
    values = [getattr(point, f"{kind}_{name}") for point in points for kind, *_ in KINDS for name in ("10", "median", "90")]
    values = [value for value in values if value > 0]
    x = [point.cpu_s_median for point in points]
    axes.set_xlim(min(x) / MARGIN, max(x) * MARGIN)
    if values:
        low, high = min(values), max(values)
        axes.set_ylim(low / MARGIN, high * MARGIN * (high / low) ** 0.25)


def draw_efficiencies(axes, reports):
    """Efficiency over the best with intervals: filled for all pixels, open for the trimmed."""
    axes.set_xscale("log")
    names = [report.name for report in reports]
    lows = []
    for index, report in enumerate(reports):
        colour, marker = look(index)
        for ratio, shift, face in ((report.ratio_to_best, -0.13, colour), (report.ratio_to_best_trimmed, 0.13, "white")):
            if ratio is None:
                continue
            # Without interval: the mark alone.
            low, high = (max(ratio.low, ratio.value / 100), min(ratio.high, ratio.value * 100)) if np.isfinite(ratio.high) else (ratio.value,) * 2
            lows.append(low)
            axes.plot([low, high], [index + shift] * 2, color=colour, linewidth=1.5)
            axes.plot([ratio.value], [index + shift], color=colour, marker=marker, markerfacecolor=face, markersize=6)
            axes.annotate(f"{ratio.value:.3g}", (ratio.value, index + shift), xytext=(0, 6 if shift < 0 else -12), textcoords="offset points", ha="center", fontsize=7.4)
    axes.axvline(1, color=GREY, linewidth=1, linestyle="--")
    axes.set_yticks(range(len(names)), [textwrap.fill(name, TICK_CHARACTERS) for name in names])
    axes.set_ylim(len(names) - 0.5, -0.5)
    low = min(lows, default=0.1)
    axes.set_xlim(min(low / 2, 0.3), 2.5)
    decades = np.log10(2.5 / min(low / 2, 0.3))
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if decades < 1.7 else (1,)))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.grid(color="#dcdddf", linewidth=0.6, axis="x")
    axes.set_title("efficiency over the best", loc="left", fontsize=10)
    axes.set_xlabel("1/(relMSE × CPU s), ratio;\nopen: trimmed")
