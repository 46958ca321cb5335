"""A study of one scene: which runs are made, in which order, and what is kept of them.

Every run has a seed of its own. Within a repeat the runs of all integrators and
budgets are in an order that is drawn once, and repeats follow each other, so
that a machine that slows down slows all alike. Pictures and `runs.csv` grow as
runs end; a study that was broken off goes on where the same is asked again.
The folder is the user's: a file goes only where the study's own list names it.
"""

import contextlib
import csv
import hashlib
import json
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from .converge_data import Run, Series, append_row, names, read_runs, write_rows
from .converge_runs import budgets, render, try_out
from .errors import InputError
from .photograph import sha256_of

FIRST_SEED = 1
ORDER_SEED = 1
PICTURES = "pictures"
PLAN = "plan.json"
RUNS = "runs.csv"
ELSEWHERE = "give -o another folder, or take this file out of it"


@dataclass(frozen=True)
class Asked:
    """What the user wants of one scene."""

    program: Path
    integrators: tuple
    budget_s: float
    points: int
    repeats: int


def prepared(asked, job, folder, taken_seeds=(), check=lambda _facts: None):
    """Samples per pixel by integrator and point, from trial runs or from a study of the same that was broken off.

    Also what every integrator cannot do, and the size of pictures. `check` may refuse the facts of a
    trial run, before anything of an earlier study is removed.
    """
    key = key_of(asked, job, taken_seeds)
    plan = earlier_plan(folder)
    if plan is not None and plan["key"] == key and (folder / RUNS).is_file():
        check(plan["facts"])
        return plan
    plan = {"key": key, "spp": {}, "missing": {}, "trials": {}}
    for integrator in asked.integrators:
        speed = try_out(asked.program, job, integrator, asked.budget_s, 0)
        plan["facts"] = {name: speed.facts.get(name) for name in ("version", "git_hash", "scene", "scene_hash")}
        check(plan["facts"])
        found = budgets(speed, asked.budget_s, asked.points)
        plan["spp"][integrator] = {str(point): spp for point, spp in found.items()}
        plan["missing"][integrator] = list(speed.facts.get("missing") or [])
        plan["trials"][integrator] = {"setup_cpu_s": speed.setup_s, "cpu_s_per_spp": speed.sample_s}
        plan["size"] = list(speed.size)
    forget(folder)
    (folder / PICTURES).mkdir(parents=True, exist_ok=True)
    write_rows(folder / RUNS, Run, [])
    # Whole or not at all: half a plan would be taken for the user's file.
    part = folder / f"{PLAN}.part"
    part.write_text(json.dumps(plan, indent=2) + "\n", encoding="utf-8")
    part.replace(folder / PLAN)
    return plan


def earlier_plan(folder):
    """The plan of a study that was broken off in a folder, or None; refuses a folder whose files of these names are not a study's."""
    runs, file = folder / RUNS, folder / PLAN
    if runs.exists():
        try:
            with runs.open(newline="", encoding="utf-8") as text:
                columns = next(csv.reader(text), [])
        except (OSError, UnicodeDecodeError, csv.Error):
            columns = []
        if columns != names(Run):
            raise InputError(runs, "is not the table of runs of a study by this version, and would be overwritten", ELSEWHERE)
    if not file.exists():
        return None
    try:
        plan = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        plan = None
    if not isinstance(plan, dict) or not {"key", "spp", "missing", "trials", "facts", "size"} <= set(plan):
        raise InputError(file, "is not the plan of a study, and would be overwritten", ELSEWHERE)
    return plan


def key_of(asked, job, taken_seeds):
    """What must be the same for a study to go on."""
    told = asdict(asked) | asdict(job) | {"seeds": list(taken_seeds), "program": sha256_of(asked.program), "scene": sha256_of(job.scene)}
    return hashlib.sha256(json.dumps(told, default=str, sort_keys=True).encode()).hexdigest()


def forget(folder):
    """Removes what an earlier study of something else has left."""
    if (folder / RUNS).is_file():
        remove_pictures(folder, read_runs(folder / RUNS))
    for name in (PLAN, RUNS):
        (folder / name).unlink(missing_ok=True)


def picture_of(series, point, repeat):
    """Where the luminance of a run lies, below the study's folder."""
    return f"{PICTURES}/{series}-{point}-{repeat}.npy"


def remove_pictures(folder, runs):
    """Removes the pictures of runs, and their folder where nothing else is in it."""
    for run in runs:
        # A name that a study does not give is not its file.
        if run.file == picture_of(run.series, run.point, run.repeat):
            (folder / run.file).unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        (folder / PICTURES).rmdir()


def order(plan, repeats, taken_seeds):
    """All runs to make, as `Run`s without seconds, in their order."""
    jobs = [(integrator, int(point), spp, repeat) for repeat in range(repeats) for integrator, found in plan["spp"].items() for point, spp in found.items()]
    free = (seed for seed in range(FIRST_SEED, FIRST_SEED + len(jobs) + len(taken_seeds)) if seed not in taken_seeds)
    runs = [Run(name, point, repeat, 0.0, spp=spp, seed=seed, file=picture_of(name, point, repeat)) for (name, point, spp, repeat), seed in zip(jobs, free)]
    generator = np.random.default_rng(ORDER_SEED)
    each = len(runs) // repeats
    return [runs[repeat * each + place] for repeat in range(repeats) for place in generator.permutation(each)]


def make_all(asked, job, plan, folder, taken_seeds, say):
    """All runs of a study, those that are there already included; the luminance of each lies in the folder."""
    done = {(run.series, run.point, run.repeat): run for run in read_runs(folder / RUNS) if (folder / run.file).is_file()}
    wanted, started = order(plan, asked.repeats, taken_seeds), time.perf_counter()
    if done:
        say(f"going on: {len(done)} of {len(wanted)} runs are there")
    made = []
    for index, empty in enumerate(wanted):
        run = done.get((empty.series, empty.point, empty.repeat)) or make(asked.program, job, empty, folder)
        made.append(run)
        if (index + 1) % (len(wanted) // asked.repeats) == 0:
            say(f"repeat {run.repeat + 1} of {asked.repeats}: {index + 1} runs, {time.perf_counter() - started:.0f} s")
    return made


def make(program, job, empty, folder):
    """Makes one run, and keeps its line and its luminance."""
    made = render(program, job, empty.series, empty.spp, empty.seed)
    known = {name: value for name, value in asdict(empty).items() if value is not None}
    known |= {"cpu_s": made.cpu_s, "wall_s": made.wall_s, "integrator": made.facts.get("integrator"), "spp": made.facts.get("samples_per_pixel", empty.spp)}
    run = Run(**(known | made.stages()))
    np.save(folder / run.file, made.luminance)
    append_row(folder / RUNS, run)
    return run


def series_of(made, plan, folder):
    """The runs of each integrator with their pictures, the cheapest first."""
    found = []
    for name in plan["spp"]:
        runs = tuple(sorted((run for run in made if run.series == name), key=lambda run: (run.point, run.repeat)))
        found.append(Series(name, runs, np.stack([np.load(folder / run.file) for run in runs]), missing=tuple(plan["missing"][name])))
    return found


def finish(folder, made):
    """`runs.csv` in order, and what only a study that is broken off needs removed: to be called once the reports are written."""
    write_rows(folder / RUNS, Run, sorted((replace(run, file="") for run in made), key=lambda run: (run.series, run.point, run.repeat)))
    (folder / PLAN).unlink(missing_ok=True)
    remove_pictures(folder, made)
