"""Renders the points of all axes, again and again in a drawn order, within a budget of CPU seconds.

Every run is a process of its own and tells its own cost (`times`, `memory` of
its report). The first pass goes up each axis and finds how many samples a run
of a point may take; what cannot fit is left out and named. Later passes take
the same samples with other seeds in an order drawn once, so that what else the
machine does meets all points alike. A point that fails is named and costs no
other its runs; those before its failure stay.
"""

import json
import random
import tempfile
from dataclasses import dataclass
from pathlib import Path

from .converge_runs import first_error, run_process
from .errors import InputError, meaning
from .growth_data import TARGET_ERROR, Axis, Run, Setting
from .growth_scenes import hall_file, triangles_of, write_hall

# Passes over all points: from fewer, means have no interval to speak of.
REPEATS = 3
# Fewest samples per pixel of a run: its error needs several blocks.
LEAST_SPP, MOST_SPP = 4, 1 << 14
# CPU seconds of a sample where nothing was measured yet.
GUESSED_SAMPLE_S = 4e-6
# Share of the budget that the passes of a single point may take, where its fewest samples or its set-up take more than its part.
MOST_SHARE = 0.06
# Size of the picture where it is not what is varied, in pixels.
SIZE = (160, 90)

AXES = (
    Axis("resolution", "pixels", (80, 160, 320, 640, 1280, 1920, 3840), ("path", "bdpt", "mlt")),
    Axis("triangles", "triangles", tuple(10**n for n in range(2, 8)), ("path",)),
    Axis("lights", "lamps", tuple(10**n for n in range(6)), ("path", "bdpt")),
    Axis("depth", "bounces at most", (1, 2, 4, 8, 16, 32, 64), ("path", "bdpt")),
    Axis("channels", "spectral layers beside X, Y, Z", (1, 4, 16, 64, 256), ("path", "bdpt")),
    Axis("threads", "threads", (1, 2, 4, 8, 16, 32, 64), ("path", "bdpt", "mlt")),
)


@dataclass(frozen=True)
class Study:
    """What a study is asked for."""

    program: Path
    folder: Path
    # CPU seconds of all runs together.
    budget_s: float
    threads: int
    # Whether points are taken however long they are; what memory cannot hold is left out all the same.
    full: bool
    repeats: int = REPEATS
    axes: tuple = AXES


def contents(axis_name, value):
    """Lamps and triangles of the hall at a point."""
    return {"lights": (value, 0), "triangles": (1, value)}.get(axis_name, (1, 0))


def setting_of(study, axis, integrator, value):
    """The scene, size and options of a point."""
    scene = hall_file(study.folder, *contents(axis.name, value))
    size = (value, value * 9 // 16) if axis.name == "resolution" else SIZE
    options = {"depth": ("--max-bounces", value), "channels": ("--spectral-layers", value)}.get(axis.name, ())
    return Setting(
        axis=axis.name, integrator=integrator, value=value,
        counted={"triangles": triangles_of(value), "resolution": size[0] * size[1]}.get(axis.name, value),
        scene=str(scene), size=size, threads=value if axis.name == "threads" else study.threads, options=options,
    )


def render(program, setting, spp, seed):
    """One run as its report tells it."""
    with tempfile.TemporaryDirectory(prefix="etalon-growth-") as folder:
        stem = Path(folder) / "run"
        words = [program, "render", setting.scene, "-o", f"{stem}.exr", "--report", f"{stem}.json", "--integrator", setting.integrator]
        words += ["--spp", spp, "--seed", seed, "--threads", setting.threads, "--resolution", "{}x{}".format(*setting.size), *setting.options]
        code, _, _, said = run_process(words)
        if code != 0:
            # Whoever is ended for want of memory says nothing.
            reason = f"ended by signal {-code}" if code < 0 else first_error(said)
            raise InputError(setting.scene, f"cannot be rendered with {setting.integrator}: {reason}", "see what etalon check says of it")
        return run_of(json.loads(Path(f"{stem}.json").read_text(encoding="utf-8")), setting, spp, seed)


def run_of(report, setting, spp, seed):
    """The `Run` that a report tells."""
    with meaning(setting.scene, "build the program of this version"):
        times = report["times"]
        # What chains learn first is part of what their samples cost.
        parts = [part for part in (times["bootstrap"], times["render"]) if part]
        reached = [to for to in report["error"]["seconds_to"] if to["relative_error"] == TARGET_ERROR]
        return Run(
            spp=spp, seed=seed, load_cpu_s=float(times["load"]["cpu_s"]),
            render_cpu_s=float(sum(part["cpu_s"] for part in parts)), render_wall_s=float(sum(part["wall_s"] for part in parts)),
            relmse=float(report["error"]["relmse"]), to_error_cpu_s=float(reached[0]["cpu_s"]),
            # Earlier programs do not tell.
            peak_bytes=(report.get("memory") or {}).get("peak_resident_bytes"),
        )


def part_of(study):
    """CPU seconds that one run may take."""
    return study.budget_s / (study.repeats * sum(len(axis.values) * len(axis.integrators) for axis in study.axes))


def samples_in(seconds, setting, sample_s):
    """Samples per pixel that fit into CPU seconds, a power of two."""
    fitting = seconds / (sample_s * setting.pixels)
    return min(max(1 << max(int(fitting).bit_length() - 1, 0), LEAST_SPP), MOST_SPP)


def too_much(study, setting, taken, free_bytes):
    """Why a point is left out, judged by those `taken` before it on its axis, or None.

    Loading takes what it took at the first point, and beyond that what grows in proportion.
    """
    if not taken:
        return None
    (_, (first, *_)), (last, (run, *_)) = taken[0], taken[-1]
    growth = setting.counted / last.counted if setting.axis in ("resolution", "triangles", "lights") else 1.0
    if run.peak_bytes and run.peak_bytes * growth > free_bytes:
        return f"about {run.peak_bytes * growth / 2**30:.1f} GiB of memory, of which {free_bytes / 2**30:.1f} are free"
    least_s = LEAST_SPP * setting.pixels * run.render_cpu_s / (run.spp * last.pixels)
    load_s = first.load_cpu_s + max(run.load_cpu_s - first.load_cpu_s, 0.0) * growth
    needed_s = study.repeats * (load_s + least_s)
    most_s = MOST_SHARE * study.budget_s
    if needed_s > most_s and not study.full:
        return f"about {needed_s:.0f} CPU s, more than {most_s:.0f} of the budget; --full takes it"
    return None


def too_many(study, setting):
    """Why a number of threads is left out, or None."""
    return f"more threads than the {study.threads} of this study (--threads)" if setting.threads > study.threads else None


def free_memory():
    """Bytes that a process can have, or infinity where the system does not tell."""
    try:
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        return next(int(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:"))
    except (OSError, StopIteration):
        return float("inf")


def measure(study, tell=print, keep=lambda found: None):
    """Runs of every setting by (axis, integrator), in the order of the values, and what was left out by the same.

    `keep` gets all runs so far again and again, so that what ends the study does not take them along.
    """
    found, left_out = {}, {}
    for axis in study.axes:
        for integrator in axis.integrators:
            runs, out = first_pass(study, axis, integrator)
            found[axis.name, integrator], left_out[axis.name, integrator] = runs, out
            keep(found)
            tell(f"{axis.name} {integrator}: {len(runs)} points, {len(out)} left out")
    if not any(found.values()):
        raise InputError(study.program, f"can render no point: {first_reason(left_out)}", "see what etalon check says of a scene of the study")
    later_passes(study, found, left_out, keep)
    return found, left_out


def first_reason(left_out):
    """Why the first of what was left out is."""
    return next((reason for out in left_out.values() for reason in out.values()), "there is none")


def later_passes(study, found, left_out, keep):
    """Adds the other runs of every setting; one that fails is not tried again."""
    pending = [(series, setting, runs, repeat) for series, settings in found.items() for setting, runs in settings for repeat in range(1, study.repeats)]
    random.Random(1).shuffle(pending)
    for series, setting, runs, repeat in pending:
        if setting.counted in left_out[series]:
            continue
        try:
            runs.append(render(study.program, setting, runs[0].spp, repeat + 1))
            keep(found)
        except (InputError, OSError) as error:
            left_out[series][setting.counted] = f"further runs: {error}"


def first_pass(study, axis, integrator):
    """A run at each value, cheapest first; what one cost decides the samples of the next."""
    series, out = [], {}
    for value in axis.values:
        setting = setting_of(study, axis, integrator, value)
        reason = too_many(study, setting) or too_much(study, setting, series, free_memory())
        if reason:
            out[setting.counted] = reason
            continue
        spp = samples_in(part_of(study), setting, sample_seconds(series))
        try:
            write_hall(study.folder, *contents(axis.name, value))
            series.append((setting, [render(study.program, setting, spp, 1)]))
        except (InputError, OSError) as error:
            out[setting.counted] = str(error)
    return series, out


def sample_seconds(taken):
    """CPU seconds of a sample at the last point that was taken."""
    if not taken:
        return GUESSED_SAMPLE_S
    setting, (run, *_) = taken[-1]
    return run.render_cpu_s / (run.spp * setting.pixels)
