"""Runs of the program as a user would start them, each a process of its own.

What a run costs is what its process took, loading and everything else included;
the system tells it when the process ends. Stages are what the run's own facts
say, where they do.
"""

import json
import os
import platform
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .converge_data import STAGES
from .errors import InputError
from .render import read_pixels

# Samples per pixel of the first trial run, by what the next one has more, and the share of the budget that samples take in the last.
TRIAL_SPP, TRIAL_GROWTH, TRIAL_SHARE = 2, 4, 0.25
# CPU seconds of a sample per pixel at least: those of a few operations.
LEAST_SAMPLE_S = 1e-8
# Samples per pixel below which no budget goes; budgets that would be smaller are left out.
FEWEST_SPP = 2


@dataclass(frozen=True)
class Job:
    """What is rendered: the scene's file, and size and threads where they are not the program's own choice."""

    scene: Path
    resolution: str | None = None
    threads: int | None = None


@dataclass(frozen=True)
class Made:
    """A finished run: luminance in cd/m2, seconds of the process, and the facts in its file."""

    luminance: np.ndarray
    cpu_s: float
    wall_s: float
    facts: dict

    def stages(self):
        """Seconds of the stages by the names of a `Run`'s fields."""
        times = self.facts.get("times") or {}
        found = {}
        for stage in STAGES:
            entry = times.get(stage) or {}
            found |= {f"{stage}_cpu_s": entry.get("cpu_s"), f"{stage}_wall_s": entry.get("wall_s")}
        if found["render_wall_s"] is None and isinstance(self.facts.get("seconds"), (int, float)):
            found["render_wall_s"] = float(self.facts["seconds"])
        return found


def first_error(text):
    """The line of a program's complaint that says what is wrong."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("error")]
    return (errors or lines or ["no reason given"])[0].removeprefix("error: ")


def run_process(words, environment=None):
    """Exit code, CPU and wall seconds of a process and all that it waited for, and what it wrote on stderr.

    `environment`: variables besides our own.
    """
    with tempfile.TemporaryFile() as said:
        before = time.perf_counter()
        try:
            process = subprocess.Popen([str(word) for word in words], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=said, env=os.environ | (environment or {}))
        except OSError as error:
            raise InputError(words[0], f"cannot be run ({error.strerror})", "build it, or name another program") from None
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except KeyboardInterrupt:
            process.kill()
            raise
        process.returncode = os.waitstatus_to_exitcode(status)
        wall_s = time.perf_counter() - before
        said.seek(0)
        text = said.read().decode("utf-8", "replace")
    return process.returncode, round(usage.ru_utime + usage.ru_stime, 6), round(wall_s, 6), text


def render(program, job, integrator, spp, seed):
    """One run of the program as `Made`; only options that every version of it has are used."""
    with tempfile.TemporaryDirectory(prefix="etalon-converge-") as folder:
        file = Path(folder) / "run.exr"
        words = [program, "render", job.scene, "-o", file, "--integrator", integrator, "--spp", spp, "--seed", seed]
        words += ["--resolution", job.resolution] if job.resolution else []
        words += ["--threads", job.threads] if job.threads else []
        code, cpu_s, wall_s, text = run_process(words)
        # 4: no light was found, which is a picture too: a black one.
        if code not in (0, 4) or not file.is_file():
            raise InputError(job.scene, f"cannot be rendered with {integrator}: {first_error(text)}", "see what etalon check says of it")
        spec, names, pixels = read_pixels(file)
        if "Y" not in names:
            raise InputError(program, "writes no channel Y", "give a program that writes luminance")
        luminance = pixels[..., names.index("Y")]
        if not np.isfinite(luminance).all():
            raise InputError(job.scene, f"has values that are not finite when rendered with {integrator}", "render it by hand to see which samples")
        record = spec.getattribute("etalon")
        return Made(luminance.astype(np.float32), cpu_s, wall_s, json.loads(record) if isinstance(record, str) else {})


@dataclass(frozen=True)
class Speed:
    """What trial runs tell: CPU seconds before the first sample, and those of a sample per pixel."""

    setup_s: float
    sample_s: float
    facts: dict
    size: tuple

    def samples_in(self, cpu_s):
        """Samples per pixel that fit into CPU seconds."""
        return (cpu_s - self.setup_s) / self.sample_s


def try_out(program, job, integrator, budget_s, seed):
    """The `Speed` of an integrator by runs of more and more samples, thrown away, until samples take a quarter of the budget."""
    spp, taken = TRIAL_SPP, []
    while True:
        made = render(program, job, integrator, spp, seed)
        taken.append((spp, made.cpu_s))
        # Set-up may be most of it: what samples add must be seen, unless the budget is spent already.
        if made.cpu_s - taken[0][1] >= TRIAL_SHARE * budget_s or made.cpu_s >= budget_s:
            break
        spp *= TRIAL_GROWTH
    (last, last_s), (before, before_s) = taken[-1], taken[-2] if len(taken) > 1 else (0, 0.0)
    # Where set-up alone takes the budget, samples may seem to take nothing.
    sample_s = max((last_s - before_s) / (last - before), LEAST_SAMPLE_S)
    return Speed(max(last_s - sample_s * last, 0.0), sample_s, made.facts, made.luminance.shape[::-1])


def budgets(speed, budget_s, points):
    """Samples per pixel of doubling budgets up to one of about `budget_s` CPU seconds, the smallest first."""
    most = max(speed.samples_in(budget_s), FEWEST_SPP)
    count = points
    while count > 1 and most / 2 ** (count - 1) < FEWEST_SPP:
        count -= 1
    least = max(FEWEST_SPP, round(most / 2 ** (count - 1)))
    # Budgets that are left out are the small ones, so that an index means the same seconds for all.
    return {points - count + step: least * 2**step for step in range(count)}


def machine():
    """What the figures were taken on."""
    model = next((line.split(":", 1)[1].strip() for line in cpu_lines() if line.startswith("model name")), platform.processor() or platform.machine())
    return {"cpu": model, "processors": os.cpu_count(), "system": f"{platform.system()} {platform.release()}", "load_average": list(os.getloadavg())}


def cpu_lines():
    """What Linux says of the processors; nothing elsewhere."""
    try:
        return Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return []
