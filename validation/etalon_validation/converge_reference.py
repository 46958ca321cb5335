"""What runs are judged against: a picture given by the user, or the other runs of the study.

A reference has noise of its own. What is known of it is a variance per pixel,
so that it can be subtracted: from the standard errors in a file, or from the
scatter of the runs that are pooled. No run is ever part of the reference that
it is judged against.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
from .photograph import sha256_of
from .render import read_channels, read_pixels

# Share of the mean luminance whose square keeps dark pixels from counting without bound.
FLOOR_SHARE = 0.01
# With fewer repeats of a budget nothing scatters once a run is left out.
FEWEST_REPEATS = 3
LUMINANCE = "Y"
STANDARD_ERROR = "stderr.Y"


def divisor_of(luminance):
    """What squared errors are divided by: R^2 + (1 % of the mean of R)^2."""
    return luminance**2 + (FLOOR_SHARE * luminance.mean()) ** 2


@dataclass(frozen=True)
class FileReference:
    """A picture that no run is part of. Variance in (cd/m2)^2; None where the file does not tell it."""

    luminance: np.ndarray
    variance: np.ndarray | None
    file: str
    sha256: str

    # No series is part of it.
    series = None

    def against(self, _name, _index):
        """Luminance and variance that a run of a series is judged against."""
        return self.luminance, self.variance

    def facts(self):
        """What reports say of it."""
        return {"kind": "file", "file": self.file, "sha256": self.sha256, "noise": STANDARD_ERROR if self.variance is not None else None, "relative_variance": self.relative_variance()}

    def relative_variance(self):
        """Its own relative mean squared error; None where it is not known."""
        return None if self.variance is None else float((self.variance / divisor_of(self.luminance)).mean())


def read_reference(path, size=None):
    """The reference in an EXR with luminance Y in cd/m2; `size` is the (width, height) that runs have."""
    _, names, pixels = read_pixels(path)
    luminance = read_channels(path, [LUMINANCE])[0]
    if size is not None and luminance.shape != (size[1], size[0]):
        found, wanted = (f"{width}x{height}" for width, height in (luminance.shape[::-1], size))
        raise InputError(path, f"is {found} pixels, the runs {wanted}", f"give a reference of {wanted}, or leave --resolution out")
    if not luminance.mean() > 0:
        raise InputError(path, "has no light in it", "give a picture of the scene")
    variance = None
    if STANDARD_ERROR in names:
        variance = pixels[..., names.index(STANDARD_ERROR)] ** 2
        if not np.isfinite(variance).all():
            variance = None
    return FileReference(luminance, variance, Path(path).name, sha256_of(Path(path)))


def seed_of(path):
    """The seeds that a picture by this program says it used: one or none."""
    spec, *_ = read_pixels(path)
    text = spec.getattribute("etalon")
    try:
        seed = json.loads(text).get("seed") if isinstance(text, str) else None
    except (json.JSONDecodeError, AttributeError):
        seed = None
    return (seed,) if isinstance(seed, int) else ()


@dataclass(frozen=True)
class PooledReference:
    """The mean of the runs of one series, weighted by their samples; a run of it is left out where it is judged itself."""

    series: str
    images: np.ndarray
    # Index of the budget of each run, and its weight: samples per pixel.
    points: np.ndarray
    weights: np.ndarray

    def against(self, name, index):
        """Luminance and variance that a run of a series is judged against."""
        kept = np.ones(len(self.images), bool)
        if name == self.series:
            kept[index] = False
        return self.mean_of(kept)

    @property
    def luminance(self):
        """The mean of all its runs."""
        return self.mean_of(np.ones(len(self.images), bool))[0]

    @property
    def variance(self):
        """The variance of the mean of all its runs, (cd/m2)^2."""
        return self.mean_of(np.ones(len(self.images), bool))[1]

    def mean_of(self, kept):
        """Weighted mean of some runs and its variance by scatter within each budget; weights do not depend on pictures."""
        shares = np.where(kept, self.weights, 0) / self.weights[kept].sum()
        variance = np.zeros(self.images.shape[1:])
        for point in np.unique(self.points[kept]):
            chosen = kept & (self.points == point)
            variance += (shares[chosen] ** 2).sum() * self.images[chosen].var(axis=0, ddof=1, dtype=float)
        return np.tensordot(shares, self.images, axes=1), variance

    def facts(self):
        """What reports say of it."""
        relative = float((self.variance / divisor_of(self.luminance)).mean())
        return {"kind": "pool", "series": self.series, "runs": len(self.images), "noise": "scatter of its runs", "relative_variance": relative}


def pooled_reference(series_list):
    """All runs of the series that scatters least at its largest budget, of those that can make every path that carries light.

    Foreign series are no part of it. `InputError` where no series can serve.
    """
    able = [series for series in series_list if not series.is_foreign and not series.missing] or [series for series in series_list if not series.is_foreign]
    able = [series for series in able if min(len(series.at(point)) for point in series.points) >= FEWEST_REPEATS]
    if not able:
        raise InputError("--reference", "is missing, and there are no runs to judge others by", f"give a picture with little noise, or at least {FEWEST_REPEATS} repeats by this program")
    largest = [series.images[series.at(series.points[-1])] for series in able]
    plain = np.mean([images.mean(axis=0, dtype=float) for images in largest], axis=0)
    if not plain.mean() > 0:
        raise InputError("the runs", "found no light", "give a larger --budget")
    scatter = [float((images.var(axis=0, ddof=1, dtype=float) / divisor_of(plain)).mean()) for images in largest]
    if not max(scatter) > 0:
        raise InputError("the runs", "all show the same picture", "take a scene that is rendered with noise")
    best = able[int(np.argmin([value if value > 0 else np.inf for value in scatter]))]
    # Weights are what a budget was to take, not what was drawn: they may not follow pictures.
    points = np.array([run.point for run in best.runs])
    weights = np.array([weight_of(best, run) for run in best.runs])
    return PooledReference(best.name, best.images, points, weights)


def weight_of(series, run):
    """A run's samples per pixel, or the mean CPU seconds of its budget where samples are not known."""
    if run.spp is not None:
        return float(run.spp)
    return float(np.mean([series.runs[index].cpu_s for index in series.at(run.point)]))
