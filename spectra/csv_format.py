"""The one file format of a curve set: header lines `# key: value`, one row of column names, then numbers.

A table that reads here is sound: known quantity and columns, finite numbers, wavelengths strictly increasing,
reflectances and transmissions within 0..1.
"""

import csv
import math
from dataclasses import dataclass

COLUMNS = {
    "observer": ["wavelength_nm", "x", "y", "z"],
    "illuminant": ["wavelength_nm", "value"],
    "emission": ["wavelength_nm", "value"],
    "lines": ["wavelength_nm", "power"],
    "reflectance": ["wavelength_nm", "value"],
    "transmission": ["wavelength_nm", "value"],
    "sensitivity": ["wavelength_nm", "r", "g", "b"],
    "refractive_index": ["wavelength_nm", "n"],
    "complex_refractive_index": ["wavelength_nm", "n", "k"],
    "sellmeier": ["b", "c_um2"],
}
QUANTITIES_OF_KIND = {
    "observer": {"observer"},
    "illuminant": {"illuminant"},
    "emission": {"emission"},
    "line": {"lines"},
    "reflectance": {"reflectance"},
    "transmission": {"transmission"},
    "sensitivity": {"sensitivity"},
    "glass": {"sellmeier", "refractive_index"},
    "metal": {"complex_refractive_index"},
}
REQUIRED_KEYS = ["title", "quantity", "unit", "source", "conditions"]
# Everything else here is a power, a response or an index, none of which is negative either.
AT_MOST_ONE = {"reflectance", "transmission"}


class Unsound(ValueError):
    """A curve set that breaks the format; the message names the file and the fault."""


@dataclass
class CurveSet:
    """One CSV: header values as text, numbers as floats."""

    header: dict
    rows: list

    @property
    def quantity(self):
        return self.header["quantity"]

    def range_nm(self):
        """First and last wavelength, in nanometres."""
        if self.quantity == "sellmeier":
            return tuple(float(end) for end in self.header["range_nm"].split("-"))
        return self.rows[0][0], self.rows[-1][0]

    def step(self):
        """Distance between samples, as the provenance table prints it."""
        if self.quantity == "sellmeier":
            return "formula"
        if self.quantity == "lines":
            return f"{len(self.rows)} lines"
        steps = {round(b[0] - a[0], 6) for a, b in zip(self.rows, self.rows[1:])}
        return f"{steps.pop():g}" if len(steps) == 1 else "uneven"


def compose(header, rows):
    """The text of a file from header values and rows of already written numbers."""
    lines = [f"# {key}: {value}" for key, value in header.items()]
    lines.append(",".join(COLUMNS[header["quantity"]]))
    lines += [",".join(row) for row in rows]
    return "\n".join(lines) + "\n"


def parse(text, path):
    """The curve set in a file's text; `path` is `<kind>/<name>.csv`. Raises Unsound."""

    def require(condition, fault):
        if not condition:
            raise Unsound(f"{path}: {fault}")

    require(text.isascii() and text.endswith("\n"), "must be ASCII and end with a newline")
    lines = text.splitlines()
    header = dict(line[2:].split(": ", 1) for line in lines if line.startswith("# "))
    body = list(csv.reader(line for line in lines if not line.startswith("# ")))
    for key in REQUIRED_KEYS:
        require(header.get(key), f"header line `# {key}: ...` is missing")
    quantity = header["quantity"]
    require(quantity in QUANTITIES_OF_KIND[path.split("/")[0]], f"quantity {quantity} does not belong in this folder")
    require(quantity != "sellmeier" or "range_nm" in header, "header line `# range_nm: ...` is missing")
    require(body[0] == COLUMNS[quantity], f"columns must be {','.join(COLUMNS[quantity])}")
    rows = [[float(cell) for cell in row] for row in body[1:]]
    require(rows and all(len(row) == len(body[0]) for row in rows), "a row has the wrong number of cells")
    require(all(math.isfinite(cell) for row in rows for cell in row), "a number is not finite")
    require(all(cell >= 0 for row in rows for cell in row), "a number is negative")
    if quantity != "sellmeier":
        require(all(a[0] < b[0] for a, b in zip(rows, rows[1:])), "wavelengths must strictly increase")
    if quantity in AT_MOST_ONE:
        require(all(row[1] <= 1 for row in rows), f"a {quantity} is above 1")
    return CurveSet(header, rows)
