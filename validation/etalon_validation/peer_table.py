"""The table of a peer: processor seconds and a picture a line, in a CSV that a person can write by hand.

Lines of one point of the curve have the same number in a column `spp`, or about
the same processor seconds: sorted, these begin a new point where the next is
more than `APART` times the one before. Points are meant to be doublings, so this
is plain unless runs of one point scatter by half; such a table is refused and
asked for the column.
"""

import csv
import difflib
import math
import re
from dataclasses import dataclass
from pathlib import Path

from .errors import InputError

# What stands in place of seconds on the line of the peer's own reference.
REFERENCE = "reference"
NEEDED = ("cpu_seconds", "file")
KNOWN = (*NEEDED, "wall_seconds", "load_cpu_seconds", "load_wall_seconds", "spp", "scale")
# Sorted seconds that grow by more than this begin a new point.
APART = 1.25
# Seconds of one point that reach over more than this may be two points.
WIDEST = 1.6
# A cell, quoted or plain.
CELL = re.compile(r'\s*"(?P<quoted>(?:[^"]|"")*)"\s*|(?P<plain>[^,]*)')


@dataclass(frozen=True)
class PeerRow:
    """One picture: where it stands in the table, and the seconds that it took.

    `cpu_s` and `wall_s` hold what loading took, `load_*` says how much; a
    reference has none of them.
    `scale` is cd/m2 per unit of the file, `None` where the table does not say.
    """

    place: str
    file: Path
    cpu_s: float | None
    wall_s: float | None
    load_cpu_s: float | None
    load_wall_s: float | None
    spp: int | None
    scale: float | None


@dataclass(frozen=True)
class PeerTable:
    """Everything one CSV says; `points` are lists of repeats in the order of their seconds."""

    name: str
    file: Path
    points: tuple
    reference: Path | None
    reference_place: str | None
    reference_scale: float | None

    @property
    def rows(self):
        """Every picture but the reference."""
        return [row for point in self.points for row in point]


def cells(line):
    """Pairs of column, counted from 1, and text of a line of comma-separated values."""
    found, start = [], 0
    while True:
        match = CELL.match(line, start)
        quoted = match.group("quoted")
        text = match.group("plain").strip() if quoted is None else quoted.replace('""', '"')
        lead = len(match.group()) - len(match.group().lstrip())
        found.append((start + lead + 1, text))
        if match.end() >= len(line) or line[match.end()] != ",":
            return found
        start = match.end() + 1


def read_table(name, path):
    """The table of the peer `name`; pictures stand relative to the CSV's folder.

    Raises `InputError` with file, line and column for whatever is wrong in it.
    """
    path = Path(path)
    lines = read_lines(path)
    if not lines:
        raise InputError(path, "is empty", f"begin it with the line {','.join(NEEDED)}")
    head = read_header(path, *lines[0])
    rows, reference, seen = [], None, {}
    for number, line in lines[1:]:
        row = read_row(path, number, line, head)
        same = seen.setdefault(row.file.resolve(), row.place)
        if same != row.place:
            raise InputError(row.place, f"is the picture of {same} again", "list every picture once; repeats are independent runs")
        if row.cpu_s is not None:
            rows.append(row)
        elif reference is None:
            reference = row
        else:
            raise InputError(row.place, f"is a second reference, after {reference.place}", "keep one")
    if not rows:
        raise InputError(path, "lists no picture", "add a line of processor seconds and file for each")
    own = (reference.file, reference.place, reference.scale) if reference else (None, None, None)
    return PeerTable(name, path, group(rows), *own)


def read_lines(path):
    """Numbered lines of a text file, without comments and empty ones."""
    try:
        text = path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(path, "no such file", "check the path of --peer NAME=FILE.csv") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"cannot be read ({error})", "give a CSV in UTF-8") from None
    return [(number, line) for number, line in enumerate(text.splitlines(), 1) if line.strip() and not line.lstrip().startswith("#")]


def read_header(path, number, line):
    """Names of the columns in their order."""
    names = []
    for column, name in cells(line):
        place = f"{path}:{number}:{column}"
        if name not in KNOWN:
            near = difflib.get_close_matches(name, KNOWN, 1)
            raise InputError(place, f'unknown column "{name}"', f'did you mean "{near[0]}"?' if near else f"known are {', '.join(KNOWN)}")
        if name in names:
            raise InputError(place, f'column "{name}" is there twice', "keep one")
        names.append(name)
    for name in NEEDED:
        if name not in names:
            raise InputError(f"{path}:{number}:1", f'column "{name}" is missing', f"begin the table with the line {','.join(NEEDED)}")
    return names


@dataclass(frozen=True)
class Line:
    """The cells of one line by column, each with its place."""

    path: Path
    number: int
    row: dict

    def at(self, name):
        """file:line:column of a cell."""
        return f"{self.path}:{self.number}:{self.row[name][0]}"

    def text(self, name):
        """What stands in a cell; nothing where there is no such column."""
        return self.row.get(name, (0, ""))[1]

    def positive(self, name, meaning, zero=False):
        """The number in a cell, above zero or from there; `None` where it is empty."""
        text = self.text(name)
        if not text:
            return None
        try:
            value = float(text)
        except ValueError:
            raise InputError(self.at(name), f'"{text}" is no number', f"give {meaning} with a decimal point, as 12.5") from None
        if not math.isfinite(value) or value < 0 or (value == 0 and not zero):
            raise InputError(self.at(name), f"{name} is {text}", f"give {meaning}, {'zero or above' if zero else 'above zero'}")
        return value


def read_row(path, number, line, head):
    """One line; that of a reference has no seconds."""
    found = cells(line)
    if len(found) != len(head):
        last = found[min(len(head), len(found) - 1)][0]
        raise InputError(f"{path}:{number}:{last}", f"the line has {len(found)} cells, the header {len(head)}", "give each column one cell; quote a name with a comma in it")
    line = Line(path, number, dict(zip(head, found)))
    file = named_file(line)
    scale = line.positive("scale", "cd/m2 per unit of the file")
    if line.text("cpu_seconds") == REFERENCE:
        return PeerRow(line.at("file"), file, None, None, None, None, None, scale)
    if not line.text("cpu_seconds"):
        raise InputError(line.at("cpu_seconds"), "no processor seconds", f'give user and system time of the whole process, or the word "{REFERENCE}"')
    cpu_s, wall_s = (line.positive(name, "seconds") for name in ("cpu_seconds", "wall_seconds"))
    load_cpu_s, load_wall_s = (line.positive(name, "seconds", zero=True) for name in ("load_cpu_seconds", "load_wall_seconds"))
    for name, part, whole, of in (("load_cpu_seconds", load_cpu_s, cpu_s, "cpu_seconds"), ("load_wall_seconds", load_wall_s, wall_s, "wall_seconds")):
        if part is not None and (whole is None or part >= whole):
            raise InputError(line.at(name), f"loading took {part:g} s, {of} say {'nothing' if whole is None else format(whole, 'g')}", f"{of} hold the loading too; give the whole")
    spp = line.positive("spp", "whole samples per pixel")
    if spp is not None and spp != int(spp):
        raise InputError(line.at("spp"), f"spp is {line.text('spp')}", "give whole samples per pixel, or leave the column out")
    return PeerRow(line.at("cpu_seconds"), file, cpu_s, wall_s, load_cpu_s, load_wall_s, None if spp is None else int(spp), scale)


def named_file(line):
    """The picture that a line names, relative to the table's folder."""
    name = line.text("file")
    if not name:
        raise InputError(line.at("file"), "names no file", "name the EXR")
    file = line.path.parent / name
    if not file.is_file():
        raise InputError(line.at("file"), f"there is no file {file}", "give its path relative to the folder of the table")
    return file


def group(rows):
    """Rows as repeats of points, in the order of their seconds; see the head of this file."""
    counted = [row for row in rows if row.spp is not None]
    if counted and len(counted) != len(rows):
        other = next(row for row in rows if row.spp is None)
        raise InputError(other.place, "has no spp, other lines have", "give every line its samples per pixel, or none")
    if counted:
        by_spp = {spp: tuple(row for row in rows if row.spp == spp) for spp in sorted({row.spp for row in rows})}
        return tuple(by_spp.values())
    points = []
    for row in sorted(rows, key=lambda row: row.cpu_s):
        if points and row.cpu_s <= APART * points[-1][-1].cpu_s:
            points[-1].append(row)
        else:
            points.append([row])
    for point in points:
        first, last = point[0], point[-1]
        if last.cpu_s > WIDEST * first.cpu_s:
            raise InputError(last.place, f"{last.cpu_s:g} s may be a repeat of the {first.cpu_s:g} s of {first.place}, or not", 'say which runs belong together in a column "spp", their samples per pixel')
    return tuple(tuple(point) for point in points)


def write_table(path, rows):
    """Writes dictionaries of cells as such a table; numbers in full."""
    used = [name for name in KNOWN if any(name in row for row in rows)]
    with open(path, "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, used, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
