"""How cost grows with a scene and its picture: measured, fitted and drawn into a folder.

Time to a fixed error, CPU seconds of a sample, time to load and peak memory,
against resolution, triangles, lamps, path depth, channels and threads. The
number of wavelengths of a path is fixed when the program is built, and
`validation/plan.md` has what others cost; what can be varied is how many
spectral layers are recorded.
"""

import csv
import json
import os
import platform
import subprocess
from dataclasses import asdict
from datetime import date

from .errors import InputError
from .growth_data import TARGET_ERROR, Series
from .growth_fit import exponents, point_of
from .growth_plot import plot
from .growth_runs import measure

COLUMNS = (
    "axis", "integrator", "value", "width", "height", "threads", "spp", "seed", "load_cpu_s", "render_cpu_s",
    "render_wall_s", "relmse", "to_error_cpu_s", "peak_bytes",
)


def run(study, tell=print):
    """Measures, writes growth.csv, growth.json and the plot, and returns the series."""
    if not study.program.is_file():
        raise InputError(study.program, "there is no such program", "build it by cargo build --release")
    study.folder.mkdir(parents=True, exist_ok=True)
    found, left_out = measure(study, tell, lambda so_far: write_csv(study.folder / "growth.csv", so_far))
    series = series_of(study.axes, found, left_out)
    said = conditions(study)
    report = said | {"target_error": TARGET_ERROR, "series": [as_json(one) for one in series]}
    (study.folder / "growth.json").write_text(json.dumps(report, indent=2, allow_nan=False) + "\n", encoding="utf-8")
    plot(series, study.folder, in_words(said))
    return series


def series_of(axes, found, left_out):
    """A `Series` for each axis and integrator."""
    names = {axis.name: axis for axis in axes}
    made = []
    for (axis, integrator), settings in found.items():
        points = tuple(point_of(setting, runs) for setting, runs in settings)
        made.append(Series(names[axis], integrator, points, left_out[axis, integrator], exponents(points)))
    return made


def write_csv(path, found):
    """One line for each run; what ends the program midway leaves the file as it was."""
    part = path.with_suffix(".csv.part")
    with part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for (axis, integrator), settings in found.items():
            for setting, runs in settings:
                known = {"axis": axis, "integrator": integrator, "value": setting.counted, "threads": setting.threads}
                known |= dict(zip(("width", "height"), setting.size))
                writer.writerows(known | {key: value for key, value in asdict(one).items() if key in COLUMNS} for one in runs)
    part.replace(path)


def as_json(one):
    """A series as plain data."""
    return {
        "axis": one.axis.name, "integrator": one.integrator, "points": [point.as_json() for point in one.points],
        "left_out": {str(value): reason for value, reason in one.left_out.items()},
        "exponents": {name: slope and asdict(slope) for name, slope in one.exponents.items()},
    }


def conditions(study):
    """Where and how it was measured."""
    version = subprocess.run([str(study.program), "--version"], capture_output=True, text=True, check=False).stdout.strip()
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return {
        "version": version, "date": date.today().isoformat(), "machine": platform.machine(), "processors": os.cpu_count(),
        "load_average": load, "threads": study.threads, "budget_cpu_s": study.budget_s, "repeats": study.repeats, "full": study.full,
    }


def in_words(said):
    """The caption of the plot."""
    load = "" if said["load_average"] is None else f", load average {said['load_average']:.1f} at the end"
    return (
        f"{said['version']}, {said['date']}, {said['machine']} with {said['processors']} processors{load}; {said['threads']} threads, {said['repeats']} runs a point. "
        "Whiskers: 95 % of means. Numbers: exponent of the cost with its 95 % interval, which holds noise and bend. Dotted: in proportion. "
        "CPU s per sample are those of one sample of one pixel, all threads together."
    )


def describe(series):
    """Lines for the terminal: exponents, and what was left out."""
    lines = []
    for one in series:
        told = [f"{name} {slope.value:.2f} ({slope.low:.2f} to {slope.high:.2f})" for name, slope in one.exponents.items() if slope]
        lines.append(f"{one.axis.name} {one.integrator}: {len(one.points)} points; " + ("; ".join(told) or "too few for an exponent"))
        lines += [f"  left out {value}: {reason}" for value, reason in one.left_out.items()]
    return lines
