"""Error against processor time without a reference: what the scatter of independent runs says.

The error of an integrator is the variance of a pixel over its runs, divided by the square of one
picture R that all integrators share: the mean of their means, weighted by the inverse of the
relative variance of each over the whole picture. With a picture for each, an integrator that misses light
would be divided by less, and one with bright single pixels by its own bright pixels. With equal
weights the noisier would still hide its own noise, since R is high where its runs happen to be.
No choice of R notices light that an integrator has not found at all, and what is not found does
not scatter: the error is that of an unbiased integrator only where integrators agree.
"""

import tempfile
from dataclasses import dataclass

import numpy as np

from .efficiency import FIRST_SEED, floor_of, plain_and_trimmed, samples_at_equal_time, timed_render
from .errors import InputError

# Fewer runs do not tell how much runs scatter.
FEWEST_REPEATS = 8
# Resampled sets of runs behind an interval, and the seed that draws them.
BOOTSTRAP_SETS = 1000
BOOTSTRAP_SEED = 1
# Per cent below and above an interval of 95 %.
INTERVAL_PERCENT = (2.5, 97.5)
# Blocks along each side of the picture whose means are compared.
BLOCKS_PER_SIDE = 4
# Scores above this are no chance: with 8 runs of each and 17 scores, one in about 500 comparisons.
AGREEMENT_SIGMAS = 5
# Relative squared error of R above which it hides the noise it is to judge: for a pixel that holds light in
# three runs of ten, ratios come out 9 % too near to 1 at 0.026, and right at 0.001.
UNSURE_REFERENCE = 0.01
LABELS = ("plain", "trimmed")


@dataclass(frozen=True)
class Runs:
    """Luminance of independent renders, run by row by column, and their processor seconds."""

    images: np.ndarray
    cpu_s: np.ndarray


def repeated_renders(program, scene, resolution, integrators, spp, repeats):
    """Runs of each integrator at equal processor time, in turns, each with a seed of its own."""
    if repeats < FEWEST_REPEATS:
        raise InputError("--repeats", f"{repeats} runs do not tell how much runs scatter", f"give at least {FEWEST_REPEATS}")
    if len(integrators) < 2:
        raise InputError("--integrators", "one integrator has nothing to be compared with", "give two or more, such as path,bdpt")
    found = {integrator: [] for integrator in integrators}
    with tempfile.TemporaryDirectory() as folder:

        def render(integrator, count, seed):
            return timed_render(program, scene, integrator, count, seed, resolution, folder)

        samples = samples_at_equal_time(render, integrators, spp)
        seed = FIRST_SEED
        for _ in range(repeats):
            for integrator in integrators:
                # The same seed may mean the same random numbers, and integrators that err alike.
                seed += 1
                found[integrator].append(render(integrator, samples[integrator], seed))
    runs = {name: Runs(*(np.array(part) for part in zip(*renders))) for name, renders in found.items()}
    for name, run in runs.items():
        if not np.ptp(run.images, axis=0).any():
            raise InputError(scene, f"all runs of {name} give the same picture", "take a scene that it renders with noise")
    return samples, runs


def judge(samples, runs):
    """Errors, their ratios to the first integrator's at equal time, and whether means agree: for JSON."""
    first = next(iter(runs))
    repeats = runs[first].cpu_s.size
    reference, reference_error = shared_reference(runs)
    # Each run once, then the drawn sets; R stays, or drawn runs would be judged by their own bright pixels.
    costs = {name: costs_of(run, np.ones((1, repeats)), reference) for name, run in runs.items()}
    generator = np.random.default_rng(BOOTSTRAP_SEED)
    resampled = {name: costs_of(run, draw_sets(generator, repeats), reference) for name, run in runs.items()}
    integrators = {}
    for name, run in runs.items():
        cpu_s = float(run.cpu_s.mean())
        integrators[name] = {"spp": samples[name], "cpu_s": cpu_s}
        for index, label in enumerate(LABELS):
            ratios = resampled[first][:, index] / resampled[name][:, index]
            integrators[name][label] = {
                "relative_mse": float(costs[name][0, index]) / cpu_s,
                "times_lower_at_equal_time": float(costs[first][0, index] / costs[name][0, index]),
                "interval_95": np.percentile(ratios, INTERVAL_PERCENT).tolist(),
            }
    agreement = {name: scores(runs[first].images, run.images) for name, run in runs.items() if name != first}
    agree = all(max(abs(found["z_picture"]), found["largest_z_of_blocks"]) < AGREEMENT_SIGMAS for found in agreement.values())
    return {"repeats": repeats, "reference_relative_mse": reference_error, "integrators": integrators, "agreement": agreement, "agree": agree}


def draw_sets(generator, repeats):
    """How often each run is in each resampled set."""
    return generator.multinomial(repeats, np.full(repeats, 1 / repeats), size=BOOTSTRAP_SETS).astype(float)


def costs_of(run, sets, reference):
    """Relative mean squared error times processor seconds, plain and trimmed, for each set of runs.

    `sets` holds rows of how often each run counts.
    """
    pixels, reference = run.images.reshape(run.cpu_s.size, -1), reference.ravel()
    divisor = reference**2 + floor_of(reference)
    costs = np.empty((len(sets), len(LABELS)))
    for index, times in enumerate(sets):
        mean = times @ pixels / times.sum()
        variance = times @ (pixels - mean) ** 2 / (times.sum() - 1)
        costs[index] = times @ run.cpu_s / times.sum() * np.array(plain_and_trimmed(variance / divisor))
    return costs


def shared_reference(runs):
    """R, and its own relative squared error.

    The weights' variances are relative to the plain mean of means: absolute ones are those of a
    lamp in view.
    """
    means = np.array([run.images.mean(axis=0) for run in runs.values()])
    errors = np.array([run.images.var(axis=0, ddof=1) / run.cpu_s.size for run in runs.values()])
    plain = means.mean(axis=0)
    weights = 1 / (errors / (plain**2 + floor_of(plain))).mean(axis=(1, 2))
    weights = (weights / weights.sum())[:, None, None]
    reference = (weights * means).sum(axis=0)
    squared_error = (weights**2 * errors).sum(axis=0)
    return reference, float((squared_error / (reference**2 + floor_of(reference))).mean())


def scores(one, other):
    """Differences of the means of two sets of runs in standard errors: whole picture, and blocks."""
    whole = [images.mean(axis=(1, 2))[:, None] for images in (one, other)]
    parts = [block_means(images) for images in (one, other)]
    blocks = np.abs(score(*parts))
    return {"z_picture": float(score(*whole)[0]), "largest_z_of_blocks": float(blocks.max()), "blocks": int(blocks.size)}


def score(one, other):
    """Mean of `other` less that of `one` over the standard error of the difference (Welch)."""
    difference = other.mean(axis=0) - one.mean(axis=0)
    error = np.sqrt(sum(values.var(axis=0, ddof=1) / len(values) for values in (one, other)))
    return np.divide(difference, error, out=np.where(difference == 0, 0.0, np.copysign(np.inf, difference)), where=error > 0)


def block_means(images):
    """Means of the picture's blocks, run by block; sides that do not divide give blocks of unlike size."""
    rows = np.array_split(images, min(BLOCKS_PER_SIDE, images.shape[1]), axis=1)
    cells = [cell for row in rows for cell in np.array_split(row, min(BLOCKS_PER_SIDE, images.shape[2]), axis=2)]
    return np.stack([cell.mean(axis=(1, 2)) for cell in cells], axis=1)


def describe_alone(report):
    """A line per integrator, one on the reference that they share, and one per comparison of means."""
    lines = []
    for name, found in report["integrators"].items():
        plain, trimmed = found["plain"], found["trimmed"]
        lines.append(
            f"{name}: {found['spp']} spp, {found['cpu_s']:.2f} CPU s, relMSE {plain['relative_mse']:.5f}, trimmed {trimmed['relative_mse']:.5f}; "
            f"{gain(trimmed)} times lower at equal time (plain {gain(plain)})"
        )
    error = report["reference_relative_mse"]
    remark = ": the noisier integrator's relMSE is a lower bound, and ratios are too near to 1; give more --repeats or --spp" if error > UNSURE_REFERENCE else ""
    lines.append(f"mean of {report['repeats']} runs of each: relMSE {error:.5f}{remark}")
    first = next(iter(report["integrators"]))
    for name, found in report["agreement"].items():
        lines.append(f"{name} less {first}: z {found['z_picture']:+.2f} of the whole picture, largest |z| {found['largest_z_of_blocks']:.2f} of {found['blocks']} blocks")
    if not report["agree"]:
        lines.append(f"|z| above {AGREEMENT_SIGMAS}: one of them is biased, or its runs have not found all light; the ratios mean nothing")
    return "\n".join(lines)


def gain(figures):
    """A ratio with its interval."""
    low, high = figures["interval_95"]
    return f"{figures['times_lower_at_equal_time']:.2f} [{low:.2f}, {high:.2f}]"
