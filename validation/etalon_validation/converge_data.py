"""What a convergence study is made of: runs, series of runs, and what is found about them.

A series is anything that makes pictures of one scene in more or less time: an
integrator of this program, or another renderer. All are judged by the same
functions, so they share these types, and nothing here knows who made a run.
Luminance is in cd/m2, times are in seconds; CPU seconds are of the whole
process with all its threads, loading included. "Relative" means divided by
R^2 + (1 % of the mean of R)^2, R the reference.
"""

import csv
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path

import numpy as np

from .errors import InputError

# Stages of a run that are shown apart, where the run's facts tell them.
STAGES = ("load", "pilot", "bootstrap", "render")


@dataclass(frozen=True)
class Run:
    """One picture and what it took. What is not known is None."""

    series: str
    # Index of the budget, 0 the smallest; runs of one index are repeats of each other.
    point: int
    repeat: int
    cpu_s: float
    wall_s: float | None = None
    # Samples per pixel, and the seed of its random numbers.
    spp: int | None = None
    seed: int | None = None
    # What the program says that it used; for "auto" its choice.
    integrator: str | None = None
    load_cpu_s: float | None = None
    load_wall_s: float | None = None
    pilot_cpu_s: float | None = None
    pilot_wall_s: float | None = None
    bootstrap_cpu_s: float | None = None
    bootstrap_wall_s: float | None = None
    render_cpu_s: float | None = None
    render_wall_s: float | None = None
    # The picture: below the study's folder while that is being made, or where a foreign list names it.
    file: str = ""

    @property
    def setup_cpu_s(self):
        """CPU seconds before the first sample that counts; None where the render's are not known."""
        return None if self.render_cpu_s is None else max(self.cpu_s - self.render_cpu_s, 0.0)


@dataclass(frozen=True)
class Series:
    """Runs under one name, and their luminance (run, row, column) in cd/m2 in the same order."""

    name: str
    runs: tuple[Run, ...]
    images: np.ndarray
    # Made by another program: never part of a pooled reference.
    is_foreign: bool = False
    # Paths that carry light and that it says it cannot make: such a series is no reference.
    missing: tuple[str, ...] = ()

    def at(self, point):
        """Indices of the runs of a point."""
        return [index for index, run in enumerate(self.runs) if run.point == point]

    @property
    def points(self):
        """Indices of its points, the cheapest first."""
        return sorted({run.point for run in self.runs})


@dataclass(frozen=True)
class Score:
    """Errors of one run's luminance, the reference's own noise subtracted; any may come out below zero."""

    # (cd/m2)^2
    mse: float
    relmse: float
    # Without the 0.1 % of pixels with the largest terms.
    relmse_trimmed: float
    # Share of those pixels in the sum of all, before the noise is subtracted.
    largest_share: float
    # What was subtracted: mean variance of the reference, (cd/m2)^2 and relative; 0 where it is not known.
    reference_mse: float
    reference_relmse: float


@dataclass(frozen=True)
class Point:
    """The repeats of one budget: means (which fits and efficiencies use), medians and 10-90 % bands (which plots show)."""

    series: str
    point: int
    repeats: int
    spp: int | None
    # Means; `setup_cpu_s` is what comes before the first sample that counts.
    cpu_s: float
    wall_s: float | None
    setup_cpu_s: float | None
    load_cpu_s: float | None
    pilot_cpu_s: float | None
    bootstrap_cpu_s: float | None
    render_cpu_s: float | None
    cpu_s_median: float
    mse_mean: float
    mse_median: float
    mse_10: float
    mse_90: float
    relmse_mean: float
    relmse_median: float
    relmse_10: float
    relmse_90: float
    trimmed_mean: float
    trimmed_median: float
    trimmed_10: float
    trimmed_90: float
    # Median share of the largest 0.1 % of pixels, and share of the worst repeat in the sum over repeats.
    largest_share: float
    worst_repeat_share: float
    # The reference's own relative mean squared error over relmse_mean; infinite where that is not above zero.
    reference_share: float
    # 1 / (relmse_mean cpu_s), in 1/s; None where relmse_mean is not above zero. The same for the trimmed.
    efficiency: float | None
    efficiency_trimmed: float | None
    flags: tuple[str, ...] = ()


@dataclass(frozen=True)
class Estimate:
    """A figure with its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True)
class Fit:
    """Slopes of log error on log CPU seconds; None below three points.

    `relmse_render` is on the CPU seconds after set-up, or on samples per pixel where those are not known: it is the one
    that flags are about.
    """

    mse: Estimate | None
    relmse: Estimate | None
    trimmed: Estimate | None
    relmse_render: Estimate | None


@dataclass(frozen=True)
class Bias:
    """The mean of the largest budget's repeats against the reference, the noise of both subtracted."""

    # Relative mean squared bias, unbiased: may come out below zero.
    squared: Estimate
    # The same in (cd/m2)^2, without interval.
    squared_cd2_m4: float
    # `squared` in standard errors under the hypothesis that there is no bias.
    z: float
    # z above which the bias is called significant; falls with the number of repeats.
    limit: float
    mean_ratio: Estimate
    # z above the limit, and nothing that speaks against the reference: `doubt` says what does.
    is_significant: bool
    doubt: str | None = None

    @property
    def is_clear(self):
        """Whether no bias is seen: both intervals hold what no bias would be."""
        return not self.is_significant and self.squared.low <= 0 and self.mean_ratio.low <= 1 <= self.mean_ratio.high


@dataclass(frozen=True)
class Flag:
    """Something that keeps figures from meaning what they seem to: a fixed name, and why in words."""

    name: str
    text: str


@dataclass(frozen=True)
class SeriesReport:
    """All that is found about one series."""

    name: str
    runs: tuple[Run, ...]
    scores: tuple[Score, ...]
    points: tuple[Point, ...]
    fit: Fit
    # Geometric mean over the points of 1 / (relmse cpu_s), in 1/s; None where no point has one.
    efficiency: float | None
    efficiency_trimmed: float | None
    # Efficiency over that of the best series, which has 1.
    ratio_to_best: Estimate | None
    ratio_to_best_trimmed: Estimate | None
    # None for the series that the reference is made of.
    bias: Bias | None
    flags: tuple[Flag, ...] = field(default=())


def write_rows(file, kind, rows):
    """A CSV with one line a dataclass object of `kind`; its fields are the columns, None is empty, flags are joined by ';'."""
    with Path(file).open("w", newline="", encoding="utf-8") as text:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(names(kind))
        writer.writerows(as_cells(row) for row in rows)


def append_row(file, row):
    """One more line."""
    with Path(file).open("a", newline="", encoding="utf-8") as text:
        csv.writer(text, lineterminator="\n").writerow(as_cells(row))


def names(kind):
    """The columns of a dataclass."""
    return [entry.name for entry in fields(kind)]


def as_cells(row):
    """The cells of one line."""
    return ["" if value is None else ";".join(value) if isinstance(value, tuple) else value for value in asdict(row).values()]


def read_runs(file):
    """The runs in a CSV written by `write_rows`; an `InputError` names the line that is wrong."""
    kinds = {entry.name: str(entry.type) for entry in fields(Run)}
    runs = []
    with Path(file).open(newline="", encoding="utf-8") as text:
        for number, row in enumerate(csv.DictReader(text), start=2):
            try:
                runs.append(Run(**{name: from_cell(row[name], kind) for name, kind in kinds.items()}))
            except (KeyError, TypeError, ValueError) as error:
                raise InputError(f"{file}:{number}", f"is no line of a study's runs ({error})", "give another folder, or remove this one") from None
    return runs


def from_cell(cell, kind):
    """A cell as the type that a field names."""
    if "str" in kind:
        return cell or (None if "None" in kind else "")
    if cell == "" and "None" in kind:
        return None
    return int(cell) if "int" in kind else float(cell)
