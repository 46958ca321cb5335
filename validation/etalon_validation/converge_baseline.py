"""Whether a program has become less efficient than an earlier one of itself.

Both run in one session, in pairs of the same seed and samples, the order turned
round from pair to pair (ABBA), so that what the machine does to one it does to
the other. The error is the scatter over seeds: it needs no reference, and it
does not see a bias, so pictures are compared too. Where the two programs draw
the same bits, their errors are equal and time alone decides.
"""

import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import stats

from .converge_bias import paired_z, sigmas
from .converge_data import Estimate
from .converge_reference import divisor_of
from .converge_runs import FEWEST_SPP, first_error, render, try_out
from .errors import InputError

# Drawn sets of pairs behind an interval, and the seed that draws them.
SETS = 2000
SEED = 1
CONFIDENCE = 0.95
FIRST_SEED = 1
# An interval of fewer pairs is too wide to decide anything.
FEWEST_PAIRS = 5
# What the first word of --version is, and seconds to say it.
PROGRAM, VERSION_S = "etalon", 60


@dataclass(frozen=True)
class Comparison:
    """The new program against the old one on one scene with one integrator. Ratios above 1: the new one is better."""

    scene: str
    integrator: str
    spp: int
    pairs: int
    old_cpu_s: float
    new_cpu_s: float
    # CPU seconds and relative mean squared error of the old program over those of the new one.
    speed: Estimate
    precision: Estimate
    # Their product.
    efficiency: Estimate
    is_identical: bool
    # Difference of the pictures' expectations in standard errors, and whether that is beyond chance.
    z: float
    differs: bool
    # "holds", "undecided" or "fell".
    verdict: str
    # Commits that the programs say they were built from.
    old_commit: str | None
    new_commit: str | None


@dataclass(frozen=True)
class Pairs:
    """Luminance (run, row, column) and CPU seconds of both programs, in pairs of one seed."""

    old: np.ndarray
    new: np.ndarray
    old_cpu_s: np.ndarray
    new_cpu_s: np.ndarray
    # Commits that the programs say they were built from.
    old_commit: str | None = None
    new_commit: str | None = None


def check_program(file):
    """Refuses what is not an earlier build of the program."""
    file = Path(file)
    remedy = "give the program built from an earlier commit, as target/release/etalon of another worktree: seconds measured at another time depend on what the machine did then"
    if not file.is_file():
        raise InputError(file, "no such program", remedy)
    with file.open("rb") as content:
        is_text = content.read(1) == b"{"
    if file.suffix in (".json", ".csv", ".exr") or is_text:
        raise InputError(file, "is a report and no program", remedy)
    try:
        ended = subprocess.run([file.resolve(), "--version"], stdin=subprocess.DEVNULL, capture_output=True, timeout=VERSION_S, check=False)
    except OSError:
        raise InputError(file, "cannot be run", remedy) from None
    except subprocess.TimeoutExpired:
        raise InputError(file, f"does not say its version within {VERSION_S} s", remedy) from None
    said, complaint = (text.decode("utf-8", "replace") for text in (ended.stdout, ended.stderr))
    if ended.returncode != 0:
        raise InputError(file, f"does not say its version ({first_error(complaint)})", remedy)
    if said.split()[:1] != [PROGRAM]:
        raise InputError(file, f'is another program: --version says "{first_error(said)}"', remedy)


def measure(old, new, job, integrator, budget_s, pairs, first_seed=FIRST_SEED):
    """The pairs of one scene and integrator, and the samples per pixel: as many as take the new program about `budget_s`."""
    speed = try_out(new, job, integrator, budget_s, 0)
    spp = max(FEWEST_SPP, round(speed.samples_in(budget_s)))
    found = {"old": [], "new": []}
    for pair in range(pairs):
        turn = [("old", old), ("new", new)]
        for name, program in turn if pair % 2 == 0 else reversed(turn):
            made = render(program, job, integrator, spp, first_seed + pair)
            found[name].append((made.luminance, made.cpu_s, made.facts.get("git_hash")))
    (old_images, old_s, old_commits), (new_images, new_s, new_commits) = (zip(*found[name]) for name in ("old", "new"))
    if old_images[0].shape != new_images[0].shape:
        raise InputError(job.scene, "has another size with the old program", "give --resolution")
    return Pairs(np.stack(old_images), np.stack(new_images), np.array(old_s), np.array(new_s), old_commits[0], new_commits[0]), spp


def judge(pairs, factor, scene, integrator, spp):
    """The `Comparison` of measured pairs; it fell where the whole interval of the efficiency lies below 1 / factor."""
    count = len(pairs.old)
    old, new = (np.asarray(images, float) for images in (pairs.old, pairs.new))
    is_identical = bool((pairs.old == pairs.new).all())
    middle = (old.mean(axis=0) + new.mean(axis=0)) / 2
    if not middle.mean() > 0:
        raise InputError(scene, f"shows no light with {integrator}", "give a larger --budget, or leave it out")
    for images, name, other in ((old, "old", "new"), (new, "new", "old")):
        if not images.mean() > 0:
            raise InputError(scene, f"shows no light with {integrator} of the {name} program, and does with that of the {other} one", "compare the two pictures by etalon compare")
    weights = np.vstack([np.ones(count), np.random.default_rng(SEED).multinomial(count, np.full(count, 1 / count), size=SETS)])
    # A set of one pair only does not scatter.
    weights = weights[(weights > 0).sum(axis=1) > 1]
    speed = weights @ (np.log(pairs.old_cpu_s) - np.log(pairs.new_cpu_s)) / count
    if is_identical:
        precision = np.zeros(len(weights))
    else:
        errors = [scatter(images, middle, weights) for images in (old, new)]
        if not min(part[0] for part in errors) > 0:
            raise InputError(scene, f"does not scatter with {integrator}", "take a scene that is rendered with noise")
        with np.errstate(divide="ignore", invalid="ignore"):
            precision = np.log(errors[0] / errors[1])
    figures = [spread(part, count) for part in (speed, precision, speed + precision)]
    z = paired_z(new - old, middle)
    return Comparison(
        scene, integrator, spp, count, float(pairs.old_cpu_s.mean()), float(pairs.new_cpu_s.mean()), *figures,
        is_identical, z, bool(z > sigmas(count)), verdict_of(figures[2], factor), pairs.old_commit, pairs.new_commit,
    )


def scatter(images, middle, weights):
    """Relative variance over runs for rows of how often each run counts; all by the runs' products, pixels once."""
    vectors = ((images - middle) / np.sqrt(divisor_of(middle) * middle.size)).reshape(len(images), -1)
    products = vectors @ vectors.T
    total = weights.sum(axis=1)
    return (weights @ np.diag(products) - np.einsum("si,ij,sj->s", weights, products, weights) / total) / (total - 1)


def spread(logs, count):
    """A ratio with its interval from its logarithm, the first, and those of drawn sets, the others."""
    drawn = logs[1:][np.isfinite(logs[1:])]
    # Drawn sets scatter too little by the square root of (n - 1) / n.
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, count - 1) * drawn.std(ddof=1) * np.sqrt(count / (count - 1)))
    return Estimate(*(float(np.exp(logs[0] + step)) for step in (0.0, -half, half)))


def verdict_of(efficiency, factor):
    """In one word."""
    if efficiency.high < 1 / factor:
        return "fell"
    return "undecided" if efficiency.low < 1 / factor else "holds"


def complaints(found, factor, allows_difference):
    """Lines of a comparison that end with exit code 1: efficiency that fell, and another picture unless that is allowed."""
    place = f"{found.scene}, {found.integrator}"
    if found.verdict == "fell":
        yield f"{place}: efficiency is {found.efficiency.value:.3f} [{found.efficiency.low:.3f}, {found.efficiency.high:.3f}] of the baseline's, below 1/{factor:g}"
    if found.differs and not allows_difference:
        yield f"{place}: the pictures differ from the baseline's beyond noise (z {found.z:.1f}), and light that is lost passes for efficiency; --allow-difference where that is meant"


def describe(found, factor):
    """One line on a comparison."""
    low, high = found.efficiency.low, found.efficiency.high
    words = {
        "fell": f"efficiency FELL by more than {factor:g}", "holds": f"efficiency did not fall by {factor:g}",
        "undecided": f"undecided whether efficiency fell by {factor:g}; give more --repeats or --budget",
    }[found.verdict]
    pictures = "pictures are the same bits: time alone counts" if found.is_identical else f"error {found.precision.value:.3f} [{found.precision.low:.3f}, {found.precision.high:.3f}]"
    apart = f"; PICTURES DIFFER beyond noise (z {found.z:.1f})" if found.differs else ""
    return (
        f"{found.scene}, {found.integrator}, {found.spp} spp, {found.pairs} pairs: new over old {found.efficiency.value:.3f} [{low:.3f}, {high:.3f}] "
        f"(time {found.speed.value:.3f}, {pictures}): {words}{apart}"
    )
