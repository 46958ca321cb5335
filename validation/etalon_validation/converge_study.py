"""A study of one scene: which runs are made, in which order, and what is kept of them.

Every run has a seed of its own. Within a repeat the runs of all integrators and
budgets are in an order that is drawn once, and repeats follow each other, so
that a machine that slows down slows all alike. Pictures and `runs.csv` grow as
runs end; a study that was broken off goes on where the same is asked again.
"""

import hashlib
import json
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from .converge_data import Run, Series, append_row, read_runs, write_rows
from .converge_runs import budgets, render, try_out
from .photograph import sha256_of

FIRST_SEED = 1
ORDER_SEED = 1
PICTURES = "pictures"
PLAN = "plan.json"
RUNS = "runs.csv"


@dataclass(frozen=True)
class Asked:
    """What the user wants of one scene."""

    program: Path
    integrators: tuple
    budget_s: float
    points: int
    repeats: int


def prepared(asked, job, folder, taken_seeds=()):
    """Samples per pixel by integrator and point, from trial runs or from a study of the same that was broken off.

    Also what every integrator cannot do, and the size of pictures.
    """
    key = key_of(asked, job, taken_seeds)
    file = folder / PLAN
    if file.is_file():
        try:
            plan = json.loads(file.read_text(encoding="utf-8"))
        except json.JSONDecodeError:
            plan = {}
        if plan.get("key") == key and (folder / RUNS).is_file():
            return plan
    forget(folder)
    plan = {"key": key, "spp": {}, "missing": {}, "trials": {}}
    for integrator in asked.integrators:
        speed = try_out(asked.program, job, integrator, asked.budget_s, 0)
        found = budgets(speed, asked.budget_s, asked.points)
        plan["spp"][integrator] = {str(point): spp for point, spp in found.items()}
        plan["missing"][integrator] = list(speed.facts.get("missing") or [])
        plan["trials"][integrator] = {"setup_cpu_s": speed.setup_s, "cpu_s_per_spp": speed.sample_s}
        plan["facts"] = {name: speed.facts.get(name) for name in ("version", "git_hash", "scene", "scene_hash")}
        plan["size"] = list(speed.size)
    (folder / PICTURES).mkdir(parents=True, exist_ok=True)
    write_rows(folder / RUNS, Run, [])
    file.write_text(json.dumps(plan, indent=2) + "\n", encoding="utf-8")
    return plan


def key_of(asked, job, taken_seeds):
    """What must be the same for a study to go on."""
    told = asdict(asked) | asdict(job) | {"seeds": list(taken_seeds), "program": sha256_of(asked.program), "scene": sha256_of(job.scene)}
    return hashlib.sha256(json.dumps(told, default=str, sort_keys=True).encode()).hexdigest()


def forget(folder):
    """Removes what an earlier study of something else has left."""
    for file in [folder / PLAN, folder / RUNS, *folder.glob(f"{PICTURES}/*.npy")]:
        file.unlink(missing_ok=True)


def order(plan, repeats, taken_seeds):
    """All runs to make, as `Run`s without seconds, in their order."""
    jobs = [(integrator, int(point), spp, repeat) for repeat in range(repeats) for integrator, found in plan["spp"].items() for point, spp in found.items()]
    free = (seed for seed in range(FIRST_SEED, FIRST_SEED + len(jobs) + len(taken_seeds)) if seed not in taken_seeds)
    runs = [Run(name, point, repeat, 0.0, spp=spp, seed=seed, file=f"{PICTURES}/{name}-{point}-{repeat}.npy") for (name, point, spp, repeat), seed in zip(jobs, free)]
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
    """`runs.csv` in order, and what only a study that is broken off needs removed."""
    for file in [folder / PLAN, *folder.glob(f"{PICTURES}/*.npy")]:
        file.unlink(missing_ok=True)
    (folder / PICTURES).rmdir()
    made = [replace(run, file="") for run in made]
    write_rows(folder / RUNS, Run, sorted(made, key=lambda run: (run.series, run.point, run.repeat)))
