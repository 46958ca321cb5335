"""Draws a study: a column for each axis, a row for each cost, both logarithmic.

A line of slope one stands in grey wherever an exponent is told, so that
growth is seen against proportion. Whiskers are 95 % intervals of means. Columns
share nothing but their rows' meaning: each has its own scale.
"""

import io
import textwrap
from pathlib import Path

import matplotlib
import numpy as np

from .converge_plot import COLOURS, GREY, INK, MARKERS
from .growth_data import QUANTITIES

matplotlib.use("Agg")
from matplotlib import pyplot, ticker  # noqa: E402

COLUMN_IN, ROW_IN = 2.75, 2.1
LOOKS = {name: (COLOURS[index], MARKERS[index]) for index, name in enumerate(("path", "bdpt", "mlt"))}


def plot(series, folder, caption):
    """Writes `growth.svg` and `growth.png` and returns their paths."""
    figure = draw(series, caption)
    paths = [Path(folder) / f"growth.{kind}" for kind in ("svg", "png")]
    for path in paths:
        # To memory first: a failure leaves no half-written file. Without a date files compare.
        buffer, kind = io.BytesIO(), path.suffix[1:]
        with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
            figure.savefig(buffer, format=kind, dpi=110, metadata={"Date": None} if kind == "svg" else None)
        path.write_bytes(buffer.getvalue())
    pyplot.close(figure)
    return paths


def draw(series, caption):
    """The figure: axes in columns, quantities in rows, the caption below."""
    axes = list(dict.fromkeys(one.axis for one in series))
    # What no program told, as the memory of earlier ones, has no row.
    rows = {name: label for name, label in QUANTITIES.items() if any(getattr(point, name) is not None for one in series for point in one.points)}
    lines = textwrap.wrap(caption, 190)
    height = ROW_IN * len(rows) + 0.9 + 0.17 * len(lines)
    figure, grid = pyplot.subplots(len(rows), len(axes), figsize=(COLUMN_IN * len(axes) + 0.3, height), sharex="col", squeeze=False)
    for column, axis in enumerate(axes):
        ours = [one for one in series if one.axis == axis and one.points]
        for row, (name, label) in enumerate(rows.items()):
            panel(grid[row][column], ours, name)
            if column == 0:
                grid[row][column].set_ylabel(label, fontsize=9)
        grid[0][column].set_title(axis.name, loc="left", fontsize=10)
        grid[-1][column].set_xlabel(axis.label, fontsize=9)
    below = (0.55 + 0.17 * len(lines)) / height
    figure.subplots_adjust(left=0.055, right=0.99, top=1 - 0.3 / height, bottom=below, wspace=0.27, hspace=0.12)
    figure.text(0.012, 0.08 / height, "\n".join(lines), fontsize=7.6, va="bottom", color=INK)
    return figure


def panel(axes, series, name):
    """One quantity on one axis, a line for each integrator, with its exponent in the legend."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    for one in series:
        known = [(point.value, getattr(point, name)) for point in one.points if getattr(point, name) is not None]
        if not known:
            continue
        x, means = [value for value, _ in known], [estimate.value for _, estimate in known]
        colour, marker = LOOKS.get(one.integrator, (INK, "o"))
        axes.errorbar(x, means, yerr=whiskers(known), color=colour, marker=marker, markersize=4, linewidth=1.2, capsize=2, label=words(one, name))
    proportion(axes, series, name)
    # Within one decade a logarithmic scale has a single labelled tick: its parts are labelled instead.
    low, high = axes.get_ylim()
    if high < 10 * low:
        axes.set_ylim(low / 1.6, high * 1.6)
    axes.yaxis.set_minor_formatter(ticker.LogFormatterSciNotation(labelOnlyBase=False, minor_thresholds=(1.2, 0.5)))
    axes.tick_params(labelsize=7, which="both")
    axes.grid(True, which="major", linewidth=0.4, color="#dddddd")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(fontsize=6.5, frameon=False, loc="best", handlelength=1.4)


def whiskers(known):
    """Lengths of the whiskers below and above; none where nothing is known."""
    pairs = [(e.value - (e.value if e.low is None else e.low), (e.value if e.high is None else e.high) - e.value) for _, e in known]
    return np.array(pairs).T


def words(one, name):
    """An integrator with its exponent and its interval."""
    slope = one.exponents[name]
    return one.integrator if slope is None else f"{one.integrator} {slope.value:.2f} ({slope.low:.2f} to {slope.high:.2f})"


def proportion(axes, series, name):
    """A grey line of slope one through the last point of the first series."""
    points = [point for point in (series[0].points if series else ()) if getattr(point, name) is not None]
    if len(points) < 2:
        return
    low, high = axes.get_ylim()
    x = np.array([points[0].value, points[-1].value], float)
    axes.plot(x, getattr(points[-1], name).value * x / x[1], color=GREY, linewidth=0.8, linestyle=":", zorder=0)
    axes.set_ylim(low, high)
