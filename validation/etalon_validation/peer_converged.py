"""A renderer's own converged picture: the mean of independent runs, kept for the next session.

The scatter of the runs is its noise, by the same rule for every renderer. A kept
picture stands only for what made it: scene, tables, size, version, the harness
and, of this program, the binary itself are its key; with another key, fewer
seconds than are asked for or another byte in its files it is made again.
"""

import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .converge_reference import FileReference, divisor_of, read_reference
from .errors import InputError
from .peer_picture import read_picture
from .peer_runs import run
from .peer_session import costs
from .peer_write import write_luminance
from .photograph import sha256_of

# Independent runs, and the first of their seeds; sessions begin at 999.
RUNS, FIRST_SEED = 16, 1
# Runs that find the best of several integrators, thrown away, and their share of the seconds.
TRIALS, TRIAL_SEED, TRIAL_SHARE = 4, 901, 0.1


@dataclass(frozen=True)
class Converged:
    """Luminance of each run (run, row, column) in cd/m2, their mean as a reference, and how it was made."""

    runs: np.ndarray
    reference: FileReference
    facts: dict


def converged(name, candidates, folder, key, budget_s, threads, say=print):
    """The `Converged` picture of a renderer by the best of some contestants, kept or made in about `budget_s` wall seconds."""
    files = {kind: Path(folder) / f"{name.replace(' ', '-')}.{kind}" for kind in ("exr", "npz", "json")}
    key = key | {"candidates": [candidate.name for candidate in candidates], "runs": RUNS}
    facts = kept(files, key, budget_s)
    if facts is None:
        Path(folder).mkdir(parents=True, exist_ok=True)
        # A failure in between leaves nothing that could be taken for whole.
        files["json"].unlink(missing_ok=True)
        facts = make(candidates, files, budget_s * threads) | {"name": name, "key": key, "budget_s": budget_s}
        facts["sha256"] = {kind: sha256_of(files[kind]) for kind in ("exr", "npz")}
        files["json"].write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
        say(f"reference of {name}: {facts['runs']} runs of {facts['integrator']} at {facts['spp']} spp, {facts['cpu_s']:.0f} CPU s")
    with np.load(files["npz"]) as stored:
        runs = stored["luminance"]
    return Converged(runs, read_reference(files["exr"]), facts)


def kept(files, key, budget_s):
    """Facts of a picture that is there and stands for the key, or `None`."""
    try:
        facts = json.loads(files["json"].read_text(encoding="utf-8"))
        is_whole = all(sha256_of(files[kind]) == facts["sha256"][kind] for kind in ("exr", "npz"))
        # Budgets are shared out by division: equal ones may differ in the last bit.
        return facts if is_whole and facts["key"] == key and facts["budget_s"] >= budget_s * (1 - 1e-9) else None
    except (OSError, ValueError, KeyError, TypeError, InputError):
        return None


def make(candidates, files, cpu_s):
    """Renders, writes mean and runs, and returns what was done."""
    found = costs(candidates)
    best = candidates[0]
    if len(candidates) > 1:
        share = TRIAL_SHARE * cpu_s / (TRIALS * len(candidates))
        best = most_efficient([(candidate, *stack_of(candidate, samples(share, found[candidate.name]), TRIALS, TRIAL_SEED, files)) for candidate in candidates])
        cpu_s *= 1 - TRIAL_SHARE
    spp = samples(cpu_s / RUNS, found[best.name])
    runs, taken_s = stack_of(best, spp, RUNS, FIRST_SEED, files)
    write_luminance(files["exr"], runs.mean(axis=0), runs.std(axis=0, ddof=1) / np.sqrt(RUNS))
    with files["npz"].open("wb") as file:
        np.savez(file, luminance=runs.astype(np.float32))
    return {"integrator": best.name, "spp": spp, "runs": RUNS, "cpu_s": taken_s}


def samples(cpu_s, cost):
    """Samples per pixel in so many CPU seconds, one at least."""
    return max(1, int(cpu_s / cost.cpu_s_per_spp))


def stack_of(contestant, spp, count, first_seed, files):
    """Luminance (run, row, column) of runs that differ in their seeds, and the CPU seconds of rendering them."""
    output, images, taken_s = files["exr"].with_suffix(".run.exr"), [], 0.0
    for seed in range(first_seed, first_seed + count):
        done = run(contestant, 0, seed, spp, seed, output)
        images.append(read_picture(output).luminance)
        taken_s += done.render_cpu_s or done.cpu_s
    output.unlink(missing_ok=True)
    return np.array(images, float), taken_s


def most_efficient(tried):
    """The contestant with the least variance times seconds, relative to what all found together."""
    divisor = divisor_of(np.mean([images.mean(axis=0) for _, images, _ in tried], axis=0))
    return min(tried, key=lambda entry: (entry[1].var(axis=0, ddof=1) / divisor).mean() * entry[2])[0]


def digest_of(paths):
    """One hash of the content of files, in their order."""
    whole = hashlib.sha256()
    for path in paths:
        whole.update(Path(path).name.encode() + b"\0" + Path(path).read_bytes() + b"\0")
    return whole.hexdigest()
