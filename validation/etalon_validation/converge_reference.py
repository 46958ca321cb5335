"""What runs are judged against: a picture given by the user, or the other runs of the study.

A reference has noise of its own. What is known of it is a variance per pixel,
so that it can be subtracted: from the standard errors in a file, or from the
scatter of the runs that are pooled. No run is ever part of the reference that
it is judged against.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_picture import STANDARD_ERROR, read_picture
from .photograph import sha256_of

# Share of the mean luminance whose square keeps dark pixels from counting without bound.
FLOOR_SHARE = 0.01


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
    # What its unit is known from.
    unit: str = "cd/m2"
    # What a render by Etalon tells besides; None where nothing is told: its scene and seed,
    # the blocks that its standard errors are from, whether its pixels err together, and the
    # standard error of its mean by those blocks, cd/m2.
    scene_hash: str | None = None
    seed: int | None = None
    blocks: int | None = None
    is_correlated: bool | None = None
    mean_stderr: float | None = None

    # No series is part of it.
    series = None

    def against(self, _name, _index):
        """Luminance and variance that a run of a series is judged against."""
        return self.luminance, self.variance

    def facts(self):
        """What reports say of it."""
        return {"kind": "file", "file": self.file, "sha256": self.sha256, "unit": self.unit, "blocks": self.blocks, "is_correlated": self.is_correlated, "noise": STANDARD_ERROR if self.variance is not None else None, "relative_variance": self.relative_variance()}

    def relative_variance(self):
        """Its own relative mean squared error; None where it is not known."""
        return None if self.variance is None else float((self.variance / divisor_of(self.luminance)).mean())


    @property
    def seeds(self):
        """Seeds that it was made of, as far as it tells: none or one."""
        return () if self.seed is None else (self.seed,)

    @property
    def mean_variance(self):
        """Variance of its mean, (cd/m2)^2; pixels count as independent where nothing is told."""
        if self.mean_stderr is not None:
            return self.mean_stderr**2
        return 0.0 if self.variance is None else float(self.variance.sum() / self.variance.size**2)

    def check_scene(self, facts):
        """Refuses to judge runs of another scene, by the facts of one of them; a picture that does not tell its scene is not asked."""
        wanted = facts.get("scene_hash")
        if None not in (self.scene_hash, wanted) and self.scene_hash != wanted:
            raise InputError(f"--reference {self.file}", f"shows another scene ({self.scene_hash}) than the runs ({wanted})", "render it again from the file of the scene that is studied")


def read_reference(path, size=None):
    """The reference in an EXR whose unit is known, luminance Y or of R, G, B; `size` is the (width, height) that runs have."""
    picture = read_picture(path, f"--reference {path}")
    if picture.factor is None:
        raise InputError(path, "does not say its unit, and luminance must be in cd/m2", "set the attribute whiteLuminance, cd/m2 of Y = 1 or of R = G = B = 1, or give a render by etalon")
    if size is not None and picture.size != tuple(size):
        found, wanted = (f"{width}x{height}" for width, height in (picture.size, size))
        raise InputError(path, f"is {found} pixels, the runs {wanted}", f"give a reference of {wanted}, or leave --resolution out")
    return file_reference(picture, picture.factor, path)


def file_reference(picture, factor, place):
    """A picture of `factor` cd/m2 per unit as a reference, with what its facts tell of its errors."""
    luminance, variance = picture.scaled(factor)
    if not luminance.mean() > 0:
        raise InputError(place, f"{picture.file} has no light in it", "give a picture of the scene")
    facts, error = picture.facts, picture.facts.get("error")
    error = error if isinstance(error, dict) else {}
    is_correlated = known(error.get("correlated"), bool)
    # Pixels that err independently tell more of the mean than a few blocks do.
    mean_stderr = whole_stderr(facts.get("luminance_cells")) if is_correlated and variance is not None else None
    return FileReference(
        luminance, variance, picture.file.name, sha256_of(picture.file), picture.unit,
        known(facts.get("scene_hash"), str), known(facts.get("seed"), int), known(error.get("blocks"), int),
        is_correlated, None if mean_stderr is None else factor * mean_stderr,
    )


def known(value, kind):
    """A value of facts, or None where it is of another kind."""
    return value if isinstance(value, kind) else None


def whole_stderr(cells):
    """Standard error of the mean of a picture: the one cell of the last of `luminance_cells`; None where that is not told."""
    try:
        (found,) = cells["levels"][-1]["stderr"]
    except (KeyError, TypeError, ValueError, IndexError):
        return None
    return float(found) if isinstance(found, (int, float)) and np.isfinite(found) else None


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
