"""Draws one scene of a session: error against CPU seconds of rendering, and efficiency over the best.

Etalon's series are drawn in full lines, those of peers dashed, each renderer in
one colour; markers tell integrators apart. The legend stands beside the panels:
there may be more series than a panel has room for.
"""

import textwrap

import matplotlib
import numpy as np
from matplotlib import ticker

from .converge_plot import COLOURS, GREY, INK, MARKERS, MARGIN

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

WIDTH_IN, PANELS_IN, LINE_IN, ROW_IN = 12.5, 4.2, 0.17, 0.27
CAPTION_CHARACTERS = 185
PANELS = (("relmse", "all pixels"), ("trimmed", "without the largest 0.1 % of pixels"))


def looks(names):
    """Colour, marker and line of each series by its name: colours go by the first word, the renderer."""
    renderers = list(dict.fromkeys(name.split()[0] for name in names))
    found = {}
    for renderer in renderers:
        for place, name in enumerate(name for name in names if name.split()[0] == renderer):
            found[name] = (COLOURS[renderers.index(renderer) % len(COLOURS)], MARKERS[place % len(MARKERS)], "-" if renderer == renderers[0] else "--")
    return found


def draw(reports, caption):
    """The figure of one scene; `reports` have the seconds of rendering alone."""
    lines = [line for text in caption for line in textwrap.wrap(text, CAPTION_CHARACTERS, subsequent_indent="    ")]
    below = 0.65 + LINE_IN * len(lines)
    tall = max(PANELS_IN, ROW_IN * len(reports) + 1.0)
    height = tall + below
    figure = pyplot.figure(figsize=(WIDTH_IN, height))
    bottom, share = below / height, (tall - 0.35) / height
    left = figure.add_axes((0.06, bottom, 0.265, share))
    right = figure.add_axes((0.335, bottom, 0.265, share), sharex=left, sharey=left)
    styles = looks([report.name for report in reports])
    for axes, (kind, title) in zip((left, right), PANELS):
        draw_errors(axes, reports, kind, styles)
        axes.set_title(title, loc="left", fontsize=10)
        axes.set_xlabel("CPU seconds of rendering alone")
    left.set_ylabel("relative mean squared error of luminance")
    right.tick_params(labelleft=False, which="both")
    draw_efficiencies(figure.add_axes((0.765, bottom, 0.2, share)), reports, styles)
    figure.text(0.01, 0.08 / height, "\n".join(lines), fontsize=7.4, va="bottom", linespacing=1.35, color=INK)
    return figure


def draw_errors(axes, reports, kind, styles):
    """Medians over the repeats with their 10 to 90 % bands, and a line of slope -1 below the lowest."""
    axes.set_xscale("log", base=2)
    axes.set_yscale("log")
    least = np.inf
    for report in reports:
        colour, marker, line = styles[report.name]
        x = np.array([point.cpu_s_median for point in report.points])
        low, middle, high = (np.array([getattr(point, f"{kind}_{part}") for point in report.points]) for part in ("10", "median", "90"))
        seen = middle > 0
        if not seen.any():
            continue
        axes.fill_between(x[seen], np.where(low > 0, low, middle / 10)[seen], high[seen], color=colour, alpha=0.12, linewidth=0)
        axes.plot(x[seen], middle[seen], color=colour, marker=marker, linestyle=line, markersize=5, linewidth=1.3)
        least = min(least, (x * middle)[seen].min())
    if np.isfinite(least):
        x = np.array([min(point.cpu_s_median for report in reports for point in report.points), max(point.cpu_s_median for report in reports for point in report.points)])
        axes.plot(x, 0.7 * least / x, color=GREY, linewidth=1, linestyle=":")
        axes.set_xlim(x[0] / MARGIN, x[1] * MARGIN)
    axes.grid(color="#dcdddf", linewidth=0.6)
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))


def draw_efficiencies(axes, reports, styles):
    """Efficiency over the best with intervals, which is the legend too: filled for all pixels, open for the trimmed."""
    axes.set_xscale("log")
    lows = []
    for row, report in enumerate(reports):
        colour, marker, _ = styles[report.name]
        for ratio, shift, face in ((report.ratio_to_best, -0.14, colour), (report.ratio_to_best_trimmed, 0.14, "white")):
            if ratio is None:
                continue
            low, high = (max(ratio.low, ratio.value / 30), min(ratio.high, ratio.value * 30)) if np.isfinite(ratio.high) else (ratio.value,) * 2
            lows.append(low)
            axes.plot([low, high], [row + shift] * 2, color=colour, linewidth=1.4)
            axes.plot([ratio.value], [row + shift], color=colour, marker=marker, markerfacecolor=face, markersize=5.5)
        if report.ratio_to_best is not None:
            axes.annotate(f"{report.ratio_to_best.value:.2g}", (1.02, row), xycoords=("axes fraction", "data"), fontsize=7.4, va="center", annotation_clip=False)
    axes.axvline(1, color=GREY, linewidth=1, linestyle="--")
    axes.set_yticks(range(len(reports)), [report.name for report in reports], fontsize=9)
    axes.set_ylim(len(reports) - 0.5, -0.5)
    axes.set_xlim(min([*lows, 0.5]) / 1.5, 2)
    low = axes.get_xlim()[0]
    axes.xaxis.set_major_locator(ticker.LogLocator(subs=(1, 2, 5) if low > 0.02 else (1,)))
    axes.xaxis.set_major_formatter(ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(ticker.NullFormatter())
    axes.grid(color="#dcdddf", linewidth=0.6, axis="x")
    axes.set_title("efficiency over the best", loc="left", fontsize=10)
    axes.set_xlabel("1/(relMSE x CPU s), ratio; open: trimmed")


def write(figure, folder, stem):
    """SVG and PNG; the figure stays open."""
    with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
        figure.savefig(folder / f"{stem}.svg", metadata={"Date": None})
        figure.savefig(folder / f"{stem}.png", dpi=150)
