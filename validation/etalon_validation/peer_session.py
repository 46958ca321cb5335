"""A paired session: Mitsuba and Etalon in turns, at budgets that double, on as many threads.

Every series gets about the same processor seconds of rendering at a point, by
first runs of each that are thrown away. All points and series of a repeat run
before the next repeat, each beginning with another series, so that what else
the machine does falls on all. Seeds are those of no reference.
"""

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .converge_data import Run, Series
from .errors import InputError
from .peer_picture import read_picture
from .peer_runs import run
from .peer_table import REFERENCE, write_table

POINTS = 6
FEWEST_POINTS = 3
REPEATS = 5
# Far from the seeds of the peer's reference, 0 to 31.
FIRST_SEED = 1000
TRIAL_SEED = 999
TRIAL_SPP = 16
# How many times as many samples the second trial of a series with set-up takes.
TRIAL_LEAD = 8
# A reference has at least so many times the samples of the last point of Etalon's path tracer.
REFERENCE_LEAD = 16


@dataclass(frozen=True)
class Cost:
    """What first runs of a series told: seconds that do not grow with samples, and those per sample of each pixel."""

    load_s: float
    cpu_s_per_spp: float


@dataclass(frozen=True)
class Schedule:
    """Samples per pixel of each series at each point, and the wall seconds that all of it should take."""

    spp: dict
    expected_s: float


def costs(contestants, drop=None):
    """The `Cost` of each series by runs that are thrown away; `drop(contestant, error)` may take what fails."""
    found = {}
    for contestant in contestants:
        try:
            found[contestant.name] = cost_of(contestant)
        except InputError as error:
            if drop is None:
                raise
            drop(contestant, error)
    return found


def cost_of(contestant):
    """The `Cost` of one series."""
    tried = trial(contestant, TRIAL_SPP)
    # Processor seconds, which hardly grow with what else the machine does; most of loading is on one thread.
    load_s, sample_s = max(tried.cpu_s - tried.render_cpu_s, 0.0), tried.render_cpu_s / TRIAL_SPP
    if not contestant.has_setup:
        return Cost(load_s, sample_s)
    longer = trial(contestant, TRIAL_LEAD * TRIAL_SPP)
    each_s = (longer.render_cpu_s - tried.render_cpu_s) / (longer.spp - tried.spp)
    if each_s <= 0:
        # Set-up hides the samples: they take no more than everything together.
        each_s = longer.render_cpu_s / longer.spp
    return Cost(load_s + max(tried.render_cpu_s - each_s * TRIAL_SPP, 0.0), min(each_s, sample_s))


def trial(contestant, spp):
    """A `Run` that is thrown away."""
    with tempfile.TemporaryDirectory() as folder:
        tried = run(contestant, 0, 0, spp, TRIAL_SEED, Path(folder) / "trial.exr")
    if not tried.render_cpu_s or tried.render_cpu_s <= 0:
        raise InputError(contestant.name, "tells no seconds of rendering", "use a build of this version")
    return tried


def schedule(found, budget_s, threads, most_spp, share=1.0, slack=1.0):
    """The `Schedule` that fills a budget of wall seconds: as many points as it has room for, at most `POINTS`.

    `most_spp` bounds the samples of Etalon's first series, `None` those of none. The seconds are
    this share of what the user gave as a budget. No series goes below one sample per pixel: one may
    cost `slack` times the smallest point, which begins later then.
    """
    series, slowest = len(found), max(cost.cpu_s_per_spp for cost in found.values()) / slack
    first = next(iter(found.values())).cpu_s_per_spp
    load_s = sum(cost.load_s for cost in found.values())
    for points in range(POINTS, FEWEST_POINTS - 1, -1):
        doublings = 2**points - 1
        left_s = budget_s - REPEATS * points * load_s
        smallest = left_s * threads / (REPEATS * series * doublings)
        if most_spp is not None:
            smallest = min(smallest, first * most_spp / 2 ** (points - 1))
        if smallest >= slowest:
            # Down to whole samples: the budget is kept.
            base = {name: max(1, int(smallest / cost.cpu_s_per_spp)) for name, cost in found.items()}
            rendering = sum(doublings * base[name] * cost.cpu_s_per_spp for name, cost in found.items())
            return Schedule({name: tuple(spp * 2**point for point in range(points)) for name, spp in base.items()}, REPEATS * (points * load_s + rendering / threads))
    least = REPEATS * (FEWEST_POINTS * load_s + series * (2**FEWEST_POINTS - 1) * slowest / threads)
    raise InputError(
        f"--budget {budget_s / share:g}", f"has no room for {FEWEST_POINTS} points of {REPEATS} repeats of {series} series",
        f"give at least {np.ceil(least / share):g} s" + ("" if most_spp is None else f", and a reference of at least {int(np.ceil(REFERENCE_LEAD * slowest / first * 2 ** (FEWEST_POINTS - 1)))} samples per pixel as --spp"),
    )


def rounds(contestants, plan, folder, taken_seed=0, say=print, drop=None):
    """Every run of the schedule, in turns; pictures go into a folder for each series. `taken_seed` is that of our reference.

    A series that fails ends the session, or is left out where `drop(contestant, error)` takes it.
    """
    runs = {contestant.name: [] for contestant in contestants}
    points = len(next(iter(plan.spp.values())))
    is_free = not FIRST_SEED <= taken_seed < FIRST_SEED + REPEATS * points
    first_seed = FIRST_SEED if is_free else taken_seed + 1
    for repeat in range(REPEATS):
        say(f"repeat {repeat + 1} of {REPEATS}")
        for point in range(points):
            first = (repeat * points + point) % len(contestants)
            for contestant in contestants[first:] + contestants[:first]:
                place = Path(folder) / contestant.name.replace(" ", "-")
                place.mkdir(parents=True, exist_ok=True)
                spp = plan.spp[contestant.name][point]
                output = place / f"{spp}spp-{repeat + 1}.exr"
                if contestant.name not in runs:
                    continue
                try:
                    runs[contestant.name].append(run(contestant, point, repeat, spp, first_seed + repeat * points + point, output))
                except InputError as error:
                    if drop is None:
                        raise
                    drop(contestant, error)
                    del runs[contestant.name]
    return {name: tuple(sorted(found, key=lambda entry: (entry.point, entry.repeat))) for name, found in runs.items()}


def series_of(name, runs):
    """Etalon's runs with their luminance in cd/m2."""
    images = np.stack([read_picture(entry.file).luminance for entry in runs]).astype(np.float32)
    return Series(name, runs, images)


def write_peer(path, runs: tuple[Run, ...], reference):
    """The table that `--peer` reads: runs of a peer with paths relative to it, and its own reference."""
    folder = Path(path).parent
    rows = [
        {
            "cpu_seconds": f"{entry.cpu_s:.6f}", "file": Path(entry.file).relative_to(folder), "wall_seconds": f"{entry.wall_s:.6f}",
            "load_cpu_seconds": f"{entry.load_cpu_s:.6f}", "load_wall_seconds": f"{entry.load_wall_s:.6f}", "spp": entry.spp,
        }
        for entry in runs
    ]
    write_table(path, [*rows, {"cpu_seconds": REFERENCE, "file": os.path.relpath(reference, folder)}])
