"""Slopes and efficiencies of a series, with intervals from drawing its repeats again.

Repeats are drawn with replacement within each point. With n repeats the drawn
means scatter by a factor of sqrt((n - 1) / n) too little, which at five repeats
matters: deviations are stretched by its inverse, and intervals use Student's t.
A point of one run tells nothing of its scatter: what rests on it has no interval.
"""

import numpy as np
from scipy import stats

from .converge_data import Estimate, Fit

# Sets drawn, and the seed that draws them.
SETS = 2000
SEED = 1
CONFIDENCE = 0.95
# A line through two points has no residual that could speak against it.
FEWEST_POINTS = 3


def grouped(runs, values):
    """Values of runs by point, the cheapest first."""
    points = sorted({run.point for run in runs})
    return [np.array([value for run, value in zip(runs, values) if run.point == point], float) for point in points]


def log_means(groups):
    """Logarithm of each group's mean, and of the means of drawn sets (set, group); NaN where a mean is not above zero."""
    generator = np.random.default_rng(SEED)
    means = np.array([group.mean() for group in groups])
    drawn = np.empty((SETS, len(groups)))
    for column, group in enumerate(groups):
        stretch = np.sqrt(group.size / max(group.size - 1, 1))
        sets = group[generator.integers(group.size, size=(SETS, group.size))].mean(axis=1)
        drawn[:, column] = means[column] + stretch * (sets - means[column])
    with np.errstate(divide="ignore", invalid="ignore"):
        return (np.log(np.where(values > 0, values, np.nan)) for values in (means, drawn))


def freedom(groups):
    """Degrees of freedom of the scatter within groups."""
    return max(sum(group.size - 1 for group in groups), 1)


def is_repeated(groups):
    """Whether every group has a scatter."""
    return all(group.size > 1 for group in groups)


def half_width(drawn, degrees):
    """Half an interval around a figure whose drawn values these are; infinite where most draws give none."""
    drawn = drawn[np.isfinite(drawn)]
    if drawn.size < CONFIDENCE * SETS:
        return np.inf
    return float(stats.t.ppf((1 + CONFIDENCE) / 2, degrees) * drawn.std(ddof=1))


def slope_of(runs, errors, seconds):
    """Slope of log mean error on log mean seconds over the points, or None below three points above zero.

    Errors and seconds of a run are drawn together.
    """
    if None in seconds:
        return None
    kept = [pair for pair in zip(grouped(runs, errors), grouped(runs, seconds)) if pair[0].mean() > 0 and pair[1].mean() > 0]
    if len(kept) < FEWEST_POINTS:
        return None
    (y, drawn_y), (x, drawn_x) = (log_means(groups) for groups in zip(*kept))
    drawn = line(drawn_x, drawn_y)
    groups = [pair[0] for pair in kept]
    value, half = float(line(x[None], y[None])[0]), half_width(drawn, freedom(groups)) if is_repeated(groups) else np.inf
    return Estimate(value, value - half, value + half)


def line(x, y):
    """Slopes of y on x by least squares along the last axis."""
    x = x - x.mean(axis=-1, keepdims=True)
    return (x * y).sum(axis=-1) / (x**2).sum(axis=-1)


def fit_of(runs, scores):
    """The slopes of a series."""
    cpu_s, render_s = [run.cpu_s for run in runs], [run.render_cpu_s for run in runs]
    if None in render_s:
        # Work after set-up is in proportion to samples, and those are known more often.
        render_s = [run.spp for run in runs]
    columns = {name: [getattr(found, name) for found in scores] for name in ("mse", "relmse", "relmse_trimmed")}
    return Fit(
        mse=slope_of(runs, columns["mse"], cpu_s), relmse=slope_of(runs, columns["relmse"], cpu_s),
        trimmed=slope_of(runs, columns["relmse_trimmed"], cpu_s), relmse_render=slope_of(runs, columns["relmse"], render_s),
    )


def mean_of(efficiencies):
    """The geometric mean of those that are known, or None."""
    known = [value for value in efficiencies if value is not None]
    return float(np.exp(np.mean(np.log(known)))) if known else None


def log_efficiency(report, name):
    """Logarithm of a series' efficiency, its variance by drawn sets, and degrees of freedom."""
    errors = [getattr(found, name) for found in report.scores]
    kept = [pair for pair in zip(grouped(report.runs, errors), grouped(report.runs, [run.cpu_s for run in report.runs])) if pair[0].mean() > 0]
    (y, drawn_y), (x, drawn_x) = (log_means(groups) for groups in zip(*kept))
    drawn = -(drawn_x + drawn_y).mean(axis=1)
    drawn = drawn[np.isfinite(drawn)]
    groups = [pair[0] for pair in kept]
    variance = float(drawn.var(ddof=1)) if drawn.size >= CONFIDENCE * SETS and is_repeated(groups) else np.inf
    return float(-(x + y).mean()), variance, freedom(groups)


def ratio_to(report, best, name):
    """The efficiency of a series over that of the best one, or None where it has none."""
    if (report.efficiency if name == "relmse" else report.efficiency_trimmed) is None:
        return None
    if report is best or report.name == best.name:
        return Estimate(1.0, 1.0, 1.0)
    (value, variance, degrees), (top, top_variance, top_degrees) = (log_efficiency(each, name) for each in (report, best))
    both = variance + top_variance
    if not np.isfinite(both):
        return Estimate(float(np.exp(value - top)), 0.0, np.inf)
    # Welch and Satterthwaite.
    welch = both**2 / (variance**2 / degrees + top_variance**2 / top_degrees) if both > 0 else 1.0
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, welch) * np.sqrt(both))
    return Estimate(*(float(np.exp(value - top + step)) for step in (0, -half, half)))
