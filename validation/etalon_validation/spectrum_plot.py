"""Draws one table of `spectra/`: its curves, the colours below the axis, its facts as a caption.

The request is a JSON object: `name`, `kind` (the table's folder), `csv` (its
text) and `description` (lines for the caption).
"""

import io
import json
import re
import textwrap
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np

from .difference import WHITE_XYZ, XYZ_TO_SRGB, colour
from .errors import InputError, meaning
from .photograph import linear_to_srgb

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

SUFFIXES = (".svg", ".png")
# The range that spectra are rendered over, in nm; glasses have no wavelengths of their own.
FIRST_NM, LAST_NM = 360, 830
GRID_NM = np.arange(FIRST_NM, LAST_NM + 1.0)
# Plots stop here: tables run far into the infrared, and eyes and sensors do not.
DRAWN_NM = (300, 1000)
# Words and colours of columns; "value" stands alone and is drawn in ink.
COLUMNS = {
    "x": ("x̄", "#c0392b"), "y": ("ȳ", "#27863f"), "z": ("z̄", "#2a5fb0"),
    "r": ("red channel", "#c0392b"), "g": ("green channel", "#27863f"), "b": ("blue channel", "#2a5fb0"),
    "n": ("refractive index n", "#1c1d1f"), "k": ("extinction coefficient k", "#a05a00"), "value": ("", "#1c1d1f"),
}
CAPTION_CHARACTERS = 112
# Where the values of the description begin, after their names.
CAPTION_INDENT = 11


@dataclass(frozen=True)
class Table:
    """A spectral table: its facts, and columns of numbers by name."""

    facts: dict
    columns: dict


def read_table(text, place):
    """The table in a CSV text with `# key: value` lines before its header."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    facts = dict(re.match(r"#\s*([^:]+):\s*(.*)", line).groups() for line in lines if re.match(r"#\s*[^:]+:", line))
    head, *rows = [line for line in lines if not line.startswith("#")]
    numbers = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    names = head.split(",")
    if numbers.ndim != 2 or numbers.shape[1] != len(names):
        raise InputError(place, f"its rows have not the {len(names)} columns of its header", "correct the table")
    return Table(facts, dict(zip(names, numbers.T)))


def refractive_index(table):
    """n over 360 to 830 nm from Sellmeier coefficients (n^2 = 1 + sum b l^2 / (l^2 - c), l in um), or None."""
    if not {"b", "c_um2"} <= set(table.columns):
        return None
    square = (GRID_NM[:, None] / 1000) ** 2
    return np.sqrt(1 + (table.columns["b"] * square / (square - table.columns["c_um2"])).sum(axis=1))


def curves(table):
    """Wavelengths in nm and the curves (n, values) by column name."""
    index = refractive_index(table)
    if index is not None:
        return GRID_NM, {"n": index}
    wavelengths = table.columns["wavelength_nm"]
    kept = (wavelengths >= DRAWN_NM[0]) & (wavelengths <= DRAWN_NM[1])
    return wavelengths[kept], {name: values[kept] for name, values in table.columns.items() if name != "wavelength_nm"}


def observer():
    """CIE 1931 colour-matching functions on the grid (n, 3)."""
    functions = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]
    return np.stack([np.interp(GRID_NM, functions.wavelengths, column) for column in functions.values.T], axis=1)


def spectral_colours():
    """Display colours of the grid's wavelengths, darkening towards the ends of vision."""
    linear = np.maximum(observer() @ XYZ_TO_SRGB.T, 0)
    fade = np.clip(observer().sum(axis=1) / 0.12, 0, 1)[:, None]
    return linear_to_srgb(fade * linear / np.maximum(linear.max(axis=1, keepdims=True), 1e-9))


def patch_colour(kind, wavelengths, values):
    """Display colour of a lamp, or of a surface or filter under equal energy; None where a table has none."""
    outside = {"illuminant": 0, "emission": 0, "reflectance": None, "transmission": None}
    if kind not in outside or set(values) != {"value"}:
        return None
    curve = np.interp(GRID_NM, wavelengths, values["value"], left=outside[kind], right=outside[kind])
    xyz, white = curve @ observer(), observer().sum(axis=0)
    if kind in ("illuminant", "emission"):
        linear = xyz @ XYZ_TO_SRGB.T
        linear = np.maximum(linear, 0) / max(linear.max(), 1e-12)
    else:
        adapted = colour.adaptation.chromatic_adaptation_VonKries(xyz / white[1], white / white[1], WHITE_XYZ, transform="Bradford")
        linear = np.maximum(adapted @ XYZ_TO_SRGB.T, 0)
    return linear_to_srgb(linear)


def vertical_label(kind, table):
    """What the vertical axis measures, with its unit."""
    if refractive_index(table) is not None:
        return "refractive index n, dimensionless"
    unit = table.facts.get("unit", "").split(";")[0]
    quantity = {
        "observer": "colour-matching functions, relative", "illuminant": unit, "emission": unit, "reflectance": "reflectance, 0 to 1",
        "transmission": "transmittance, 0 to 1", "sensitivity": "relative response per power, largest 1", "metal": "n and k, dimensionless", "glass": unit,
    }
    return textwrap.fill(quantity.get(kind, unit) or "value", 60)


def draw_figure(request, table):
    """The figure: curves, a band of spectral colours, and the facts."""
    kind, (wavelengths, values) = request["kind"], curves(table)
    caption = [line for text in request["description"] if not text.startswith("title ") for line in textwrap.wrap(text, CAPTION_CHARACTERS, subsequent_indent=CAPTION_INDENT * " ")]
    height = 4.6 + 0.19 * len(caption)
    figure = pyplot.figure(figsize=(8, height))
    top, bottom = 1 - 0.55 / height, (0.9 + 0.19 * len(caption)) / height
    axes = figure.add_axes((0.11, bottom, 0.86, top - bottom))
    for name, column in values.items():
        label, ink = COLUMNS.get(name, (name, "#1c1d1f"))
        if kind == "line":
            axes.vlines(wavelengths, 0, column, color=ink, linewidth=1.2)
            continue
        axes.plot(wavelengths, column, color=ink, linewidth=1.6, label=label or None)
    if len(values) > 1:
        axes.legend(frameon=False)
    low, high = min(wavelengths[0], FIRST_NM), max(wavelengths[-1], LAST_NM)
    axes.set_xlim(low, high)
    if refractive_index(table) is None and kind != "glass":
        least = min(column.min() for column in values.values())
        axes.set_ylim(bottom=min(0, 1.05 * least), top=1 if kind in ("reflectance", "transmission") else None)
    axes.set_xlabel("wavelength, nm", labelpad=14)
    axes.set_ylabel(vertical_label(kind, table))
    axes.grid(color="#dcdddf", linewidth=0.6)
    axes.set_title(table.facts.get("title", request["name"]), loc="left", fontsize=12)
    band = axes.inset_axes((0, -0.035, 1, 0.03))
    band.imshow(spectral_colours()[None], extent=(FIRST_NM, LAST_NM, 0, 1), aspect="auto")
    band.set_xlim(low, high)
    band.set_axis_off()
    axes.tick_params(axis="x", pad=11)
    patch = patch_colour(kind, wavelengths, values)
    if patch is not None:
        swatch = axes.inset_axes((0.95, 1.015, 0.05, 0.06))
        swatch.set_facecolor(patch)
        swatch.set(xticks=[], yticks=[])
    figure.text(0.02, 0.12 / height, "\n".join(caption), family="monospace", fontsize=7.2, va="bottom", linespacing=1.35)
    return figure


def plot_spectrum(text, file):
    """Draws the request in `text` to an SVG or PNG file."""
    file = Path(file)
    if file.suffix.lower() not in SUFFIXES:
        raise InputError(file, f'cannot draw to "{file.suffix}"', "end the file's name with .svg or .png")
    if not file.parent.is_dir():
        raise InputError(file.parent, "no such folder", "make it first")
    with meaning("standard input", "send name, kind, csv and description as JSON"):
        request = json.loads(text)
        table = read_table(str(request["csv"]), str(request["name"]))
        figure = draw_figure(request, table)
    # Drawn to memory first: a failure leaves no half-written file. The date is left out so that files compare.
    buffer, kind = io.BytesIO(), file.suffix.lower()[1:]
    with pyplot.rc_context({"svg.hashsalt": "etalon", "svg.fonttype": "path"}):
        figure.savefig(buffer, format=kind, dpi=150, metadata={"Date": None} if kind == "svg" else None)
    pyplot.close(figure)
    file.write_bytes(buffer.getvalue())
