"""Whether the mean of repeats differs from the reference by more than the noise of both.

The squared length of the difference of two means is estimated without bias by
the products of different runs (U-statistic), and its variance from the traces
of squared covariances, as Chen and Qin do (2010, A two-sample test for
high-dimensional data, Ann. Statist. 38, 808-835). Pixels may err together: no
independence is assumed within a run, only between runs. Of a reference file the
standard errors alone are known, and those are taken as independent, but for its
mean where it says that its pixels err together. Where such a file is too noisy
or of too few blocks to be held to its own errors, no bias is called.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from .converge_data import Bias, Estimate
from .converge_reference import divisor_of

# Smallest z that is called a bias: where the errors of far pixels are independent z is nearly normal, and this is
# one false alarm in several thousand, its deviation being estimated.
LEAST_SIGMAS = 5.0
# Where one factor moves the whole picture (a normalisation), z grows with the square of Student's t of few repeats:
# false alarms that are allowed then.
FACTOR_ALPHA = 0.01
CONFIDENCE = 0.95
# Blocks of a reference file below which its standard errors scatter too much to be subtracted: 16 give a variance to 37 %.
FEWEST_BLOCKS = 16


@dataclass(frozen=True)
class Sample:
    """Independent runs as vectors (run, pixel), scaled so that squared lengths are relative mean squared differences."""

    vectors: np.ndarray

    @property
    def count(self):
        """Runs."""
        return len(self.vectors)

    @property
    def mean(self):
        """The mean run."""
        return self.vectors.mean(axis=0)

    @property
    def residuals(self):
        """Runs less their mean."""
        return self.vectors - self.mean

    def square(self):
        """Squared length of the expectation, unbiased: products of different runs."""
        total = self.vectors.sum(axis=0)
        return float((total @ total - (self.vectors**2).sum()) / (self.count * (self.count - 1)))

    def trace_of_square(self):
        """Trace of the squared covariance: of the products of two runs, each less the mean of the others."""
        gram = self.residuals @ self.residuals.T
        # Columns of residuals' products add up to nothing, which gives the mean over all others but j and k.
        less = gram + (gram + np.diag(gram)) / (self.count - 2)
        products = (less * less.T)[~np.eye(self.count, dtype=bool)]
        # Cauchy and Schwarz: it is no less than that of as many independent pixels.
        trace = (self.residuals**2).sum() / (self.count - 1)
        return max(float(products.mean()), float(trace**2 / self.vectors.shape[1]))


def sigmas(repeats):
    """z above which a difference is called a bias: that which one factor of the whole picture passes once in 1 / FACTOR_ALPHA."""
    square = float(stats.t.ppf(1 - FACTOR_ALPHA / 2, repeats - 1)) ** 2
    return max(LEAST_SIGMAS, (square - 1) / float(np.sqrt(2 * repeats / (repeats - 1))))


def bias_of(series, reference):
    """The `Bias` of a series' largest budget, or None below three repeats."""
    chosen = series.at(series.points[-1])
    if len(chosen) < 3:
        return None
    images = np.asarray(series.images[chosen], float)
    if reference.series is None:
        return against_file(images, reference)
    last = reference.points == reference.points.max()
    return against_runs(images, np.asarray(reference.images[last], float))


def doubt_of(bias, points, reference):
    """Why a bias against a file cannot be called, in words, or None; `points` are the series' `Point`s."""
    if bias is None or reference.series is not None:
        return None
    if any("reference floor" in point.flags for point in points):
        return "the reference's own noise is too near"
    if reference.blocks is not None and reference.blocks < FEWEST_BLOCKS:
        return f"the reference's standard errors are from {reference.blocks} blocks"
    return None


def against_runs(images, others):
    """The bias of runs against other runs."""
    middle = others.mean(axis=0)
    scale = np.sqrt(divisor_of(middle) * middle.size).ravel()
    one, two = (Sample((part - middle).reshape(len(part), -1) / scale) for part in (images, others))
    # The third product of means is zero: the others' own is the origin, and their square is less their noise.
    square = one.square() + two.square()
    cross = float(((one.residuals @ two.residuals.T) ** 2).sum() / ((one.count - 1) * (two.count - 1)))
    squares = [one.trace_of_square(), two.trace_of_square()]
    null = sum(2 * trace / (part.count * (part.count - 1)) for part, trace in zip((one, two), squares)) + 4 * cross / (one.count * two.count)
    apart = one.mean - two.mean
    # What a difference that is there adds: its products with the noise, less those of the noise with itself.
    linear = 0.0
    for part, other, trace in ((one, two, squares[0]), (two, one, squares[1])):
        along = float((part.residuals @ apart).var(ddof=1)) - trace / part.count - cross / other.count
        linear += 4 * max(along, 0.0) / part.count
    means = [part.mean(axis=(1, 2)) for part in (images, others)]
    noise = [(float(part.var(ddof=1) / part.size), part.size - 1) for part in means]
    return assembled(square, null, linear, images.mean(axis=0) - middle, scatter_of(images) + scatter_of(others), [part.mean() for part in means], noise, sigmas(min(one.count, two.count)))


def against_file(images, reference):
    """The bias of runs against a picture with a variance per pixel."""
    luminance = reference.luminance
    variance = np.zeros_like(luminance) if reference.variance is None else reference.variance
    scale = np.sqrt(divisor_of(luminance) * luminance.size).ravel()
    one, own = Sample((images - luminance).reshape(len(images), -1) / scale), variance.ravel() / scale**2
    square = one.square() - float(own.sum())
    cross = float(one.residuals.var(axis=0) @ own) * one.count / (one.count - 1)
    trace = one.trace_of_square()
    # Cells that err together in a whole count at least as one factor of the picture does.
    factor = reference.mean_variance / luminance.mean() ** 2 * float((luminance**2 / scale.reshape(luminance.shape) ** 2).sum())
    null = 2 * trace / (one.count * (one.count - 1)) + 2 * max(float((own**2).sum()), factor**2) + 4 * cross / one.count
    along = float((one.residuals @ one.mean).var(ddof=1)) - trace / one.count - cross
    linear = 4 * max(along, 0.0) / one.count + 4 * max(float(own @ one.mean**2) - cross / one.count - float((own**2).sum()), 0.0)
    means = images.mean(axis=(1, 2))
    noise = [(float(means.var(ddof=1) / means.size), means.size - 1), (reference.mean_variance, np.inf if reference.mean_stderr is None or not reference.blocks else max(reference.blocks - 1, 1))]
    return assembled(square, null, linear, images.mean(axis=0) - luminance, scatter_of(images) + variance, [means.mean(), luminance.mean()], noise, sigmas(one.count))


def scatter_of(images):
    """Variance of the mean of runs, pixel by pixel."""
    return images.var(axis=0, ddof=1) / len(images)


def assembled(square, null, linear, difference, noise, means, variances, limit):
    """The figures together; `variances` are those of the two whole-picture means, with degrees of freedom."""
    half = float(stats.norm.ppf((1 + CONFIDENCE) / 2) * np.sqrt(null + linear))
    z = float(square / np.sqrt(null)) if null > 0 else float(np.copysign(np.inf, square)) if square else 0.0
    return Bias(
        squared=Estimate(square, square - half, square + half), squared_cd2_m4=float((difference**2 - noise).mean()),
        z=z, mean_ratio=ratio_of(means, variances), limit=limit, is_significant=bool(z > limit),
    )


def ratio_of(means, variances):
    """The ratio of two means with its interval (relative errors added, Student's t after Welch and Satterthwaite)."""
    ratio = float(means[0] / means[1])
    relative = [variance / means[1] ** 2 * factor for (variance, _), factor in zip(variances, (1, ratio**2))]
    both = sum(relative)
    degrees = both**2 / sum(part**2 / count for part, (_, count) in zip(relative, variances)) if both > 0 and relative[0] > 0 else np.inf
    half = float(stats.t.ppf((1 + CONFIDENCE) / 2, degrees) * np.sqrt(both))
    return Estimate(ratio, ratio - half, ratio + half)


def paired_z(differences, luminance):
    """z of the hypothesis that differences of paired runs (run, row, column) have the expectation zero."""
    if not differences.any():
        return 0.0
    sample = Sample(differences.reshape(len(differences), -1) / np.sqrt(divisor_of(luminance) * luminance.size).ravel())
    return sample.square() / float(np.sqrt(2 * sample.trace_of_square() / (sample.count * (sample.count - 1))))
