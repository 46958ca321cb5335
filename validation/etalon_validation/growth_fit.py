"""Means over runs, and exponents: the slope of log cost over log size.

Runs of one setting are compared as ratios, so their means are geometric and
intervals Student's on logarithms. The exponent is the slope of a straight line
through the points' means (scipy's linregress) with n - 2 degrees of freedom: its
interval holds how far the points are off the line, noise and bend together. Cost
need not be a power of anything: where the interval is wide the line is no law,
and the plot shows what is.
"""

import numpy as np
from scipy import stats

from .growth_data import Estimate, Point, QUANTITIES

CONFIDENCE = 0.95
# A line through two points has no residual that could speak against it.
FEWEST_POINTS = 3


def geometric(values):
    """Geometric mean of positive values with its interval; from a single one there is none."""
    logs = np.log(np.asarray(values, float))
    mean = float(logs.mean())
    if logs.size < 2:
        return Estimate(float(np.exp(mean)), None, None)
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, logs.size - 1) * stats.sem(logs))
    return Estimate(*(float(np.exp(mean + k * half)) for k in (0, -1, 1)))


def point_of(setting, runs):
    """The `Point` of a setting's runs."""
    peaks = [run.peak_bytes for run in runs if run.peak_bytes]
    samples = [run.spp * setting.pixels for run in runs]
    # The clock of processors ticks: a load below it took some of it.
    least_s = 1e-4
    return Point(
        value=setting.counted,
        runs=len(runs),
        spp=runs[0].spp,
        cpu_s_per_sample=geometric([run.render_cpu_s / n for run, n in zip(runs, samples)]),
        wall_s_per_sample=geometric([run.render_wall_s / n for run, n in zip(runs, samples)]),
        load_cpu_s=geometric([max(run.load_cpu_s, least_s) for run in runs]),
        relmse_per_sample=geometric([run.relmse * run.spp for run in runs]),
        to_error_cpu_s=geometric([run.to_error_cpu_s for run in runs]),
        peak_bytes=geometric(peaks) if len(peaks) == len(runs) else None,
    )


def exponent(values, costs):
    """Slope of log cost over log value with its interval, or None below three points."""
    if len(values) < FEWEST_POINTS:
        return None
    line = stats.linregress(np.log(np.asarray(values, float)), np.log(np.asarray(costs, float)))
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, len(values) - 2) * line.stderr)
    return Estimate(float(line.slope), float(line.slope) - half, float(line.slope) + half)


def exponents(points):
    """The exponent of each quantity over the points of a series."""
    found = {}
    for name in QUANTITIES:
        known = [(point.value, getattr(point, name).value) for point in points if getattr(point, name) is not None]
        found[name] = exponent(*zip(*known)) if known else None
    return found
