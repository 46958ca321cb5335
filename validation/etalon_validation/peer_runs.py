"""One run of either renderer as a process of its own: its picture, its seconds, and what of them was rendering."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from .converge_data import Run
from .converge_runs import first_error, run_process
from .errors import InputError, read_json
from .peer_llvm import LIBRARY
from .peer_mitsuba import LLVM, SCALAR

# What variants are called in plots and tables.
SHORT = {SCALAR: "mitsuba scalar", LLVM: "mitsuba llvm"}
PREFIX = {SCALAR: "scalar", LLVM: "llvm"}


@dataclass(frozen=True)
class Contestant:
    """A series of the session: `words(spp, seed, output, times)` is the command of a run.

    `stages` reads the seconds that it tells of itself, by the keys of `times` in Etalon's report.
    `has_setup`: its seconds of rendering hold some that do not grow with samples.
    """

    name: str
    words: Callable
    stages: Callable
    environment: dict | None = None
    is_foreign: bool = False
    has_setup: bool = False


def etalon(program, scene, integrator, resolution, threads, name=None):
    """An integrator of Etalon, by its own name or another."""

    def words(spp, seed, output, times):
        size = "{}x{}".format(*resolution)
        return [program, "render", scene, "-o", output, "--integrator", integrator, "--spp", spp, "--seed", seed, "--resolution", size, "--threads", threads, "--report", times]

    return Contestant(name or integrator, words, etalon_stages)


def etalon_stages(report):
    """Seconds of each stage; where a report has no `times`, those of rendering alone."""
    times = report.get("times")
    return times if isinstance(times, dict) else {"render": {"cpu_s": report.get("cpu_seconds"), "wall_s": report.get("seconds")}}


def mitsuba(python, case, spectra, resolution, threads, variant, library=None):
    """A variant of Mitsuba in an environment of its own; `library` is the LLVM of a compiled one."""

    def words(spp, seed, output, times):
        size = "{}x{}".format(*resolution)
        return [
            python, "-m", "etalon_validation", "mitsuba-render", "--case", case, "--spectra", spectra, "--resolution", size, "--integrator", f"{PREFIX[variant]}-path",
            "--spp", spp, "--seed", seed, "--threads", threads, "-o", output, "--times", times,
        ]

    environment = {"PYTHONPATH": str(Path(__file__).parents[1]), "PYTHONDONTWRITEBYTECODE": "1"}
    if library is not None:
        environment[LIBRARY] = str(library)
    return Contestant(SHORT[variant], words, lambda report: report, environment, is_foreign=True)


def peer(driver, ready, integrator, case, spectra, resolution, threads):
    """An integrator of a peer by its driver and what `ready` gave."""

    def words(spp, seed, output, times):
        size = "{}x{}".format(*resolution)
        return [
            *ready.words, driver.COMMAND, "--case", case, "--spectra", spectra, "--resolution", size, "--integrator", integrator,
            "--spp", spp, "--seed", seed, "--threads", threads, "-o", output, "--times", times,
        ]

    has_setup = integrator in getattr(driver, "SETUP", ())
    return Contestant(f"{driver.NAME} {integrator}", words, lambda report: report, ready.environment, is_foreign=True, has_setup=has_setup)


def run(contestant, point, repeat, spp, seed, output):
    """A `Run` with its picture at `output`; seconds are those of the whole process, by the system's account of it."""
    times = output.with_suffix(".json")
    cpu_s, wall_s = measured(contestant, [str(word) for word in contestant.words(spp, seed, output, times)])
    stages = contestant.stages(read_json(times, "run it by hand to see why"))
    times.unlink()
    known = {}
    for stage in ("pilot", "bootstrap", "render"):
        for unit in ("cpu_s", "wall_s"):
            known[f"{stage}_{unit}"] = (stages.get(stage) or {}).get(unit)
    for unit, whole in (("cpu_s", cpu_s), ("wall_s", wall_s)):
        rest = [known[f"{stage}_{unit}"] or 0.0 for stage in ("pilot", "bootstrap", "render")]
        # Whatever is none of the others: start, imports, scene, compilation, writing the picture.
        known[f"load_{unit}"] = max(whole - sum(rest), 0.0) if known[f"render_{unit}"] is not None else None
    return Run(series=contestant.name, point=point, repeat=repeat, cpu_s=cpu_s, wall_s=wall_s, spp=spp, seed=seed, file=str(output), **known)


def measured(contestant, words):
    """Processor and wall seconds of a process that must end well."""
    code, cpu_s, wall_s, said = run_process(words, contestant.environment)
    if code:
        raise InputError(contestant.name, f"failed: {first_error(said)}", f"run it by hand to see why: {' '.join(words)}")
    return cpu_s, wall_s
