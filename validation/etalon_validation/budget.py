"""One uncertainty budget: every known cause drawn, every fit made anew, one interval for each figure.

JCGM 101 rather than a sum of squares: a lamp level that is known to 20 % matters
at L0 and not at all at L1, and only a fit that is repeated for every draw shows
that. The table lists what each cause alone leaves at each level; the intervals
come from all of them together.
"""

import zlib
from dataclasses import dataclass

import numpy as np

from .calibration import PATTERNS
from .difference import chromaticity, delta_e_2000, delta_e_itp, duv
from .ladder import predict
from .regions import CORRELATED_PIXELS

# Draws behind each interval, and their seed: intervals are reproducible.
DRAWS = 1000
SEED = 20070711
# Central share of the draws that an interval holds, as percentiles.
TAILS = (2.5, 97.5)
# A t distribution of fewer has no variance.
LEAST_FREEDOM = 3.0


@dataclass(frozen=True)
class Cause:
    """One cause of uncertainty. `disturb(generator, render, photo)` changes draws (d, n, 3) of both sides."""

    name: str
    kind: str
    declared_u: float | None
    degrees_of_freedom: float | None
    source: str
    disturb: object
    pattern: str | None = None

    @property
    def removed_by(self):
        """The first level of the ladder that takes the cause up; None where none does."""
        return PATTERNS[self.pattern] if self.pattern else None


def noise(generator, shape, freedom=None):
    """Standard normal numbers; Student's t where the deviation is itself an estimate (JCGM 101, 6.4.9)."""
    return generator.standard_normal(shape) if freedom is None else generator.standard_t(np.maximum(freedom, LEAST_FREEDOM), shape)


def causes(both, surfaces, calibration):
    """Everything that blurs the comparison: what was measured, and what the case declares."""
    return measured(both, calibration) + [declared(component, both, surfaces) for component in calibration.components]


def measured(both, calibration):
    """Noise of both sides, rounding, and where the regions lie."""
    values, vectors = np.linalg.eigh(both.render_covariance)
    root = vectors * np.sqrt(np.maximum(values, 0))[:, None, :]
    readings = np.maximum(both.photo_pixels / CORRELATED_PIXELS - 1, LEAST_FREEDOM)

    def render_noise(generator, render, photo):
        return render + np.einsum("nij,dnj->dni", root, noise(generator, render.shape)), photo

    def photo_noise(generator, render, photo):
        return render, photo + both.photo_error * noise(generator, photo.shape, readings[:, None])

    def rounding(generator, render, photo):
        return render, photo + both.quantisation * np.sqrt(3) * generator.uniform(-1, 1, photo.shape)

    def place(generator, render, photo):
        moved = calibration.place_px * noise(generator, (*photo.shape[:-1], 2), calibration.place_freedom)
        return render, photo + np.einsum("dnk,nkc->dnc", moved, both.shift)

    found = [
        Cause("render noise", "A", None, None, "standard error of the pixels, taken as independent; channels as correlated as neighbouring pixels show", render_noise),
        Cause("photograph noise", "A", None, float(np.round(np.median(readings))), "spread within the region, shot noise and shading included; 3 x 3 pixels count as one", photo_noise),
        Cause("registration", "A" if calibration.place_freedom else "B", None, calibration.place_freedom, f"{calibration.place_px:.2f} px per axis ({calibration.place_source}), one shift per region, along gradients of {both.shift_from}", place),
    ]
    if both.quantisation.any():
        found.insert(2, Cause("quantisation", "B", None, None, "rounding to integer codes, rectangular", rounding))
    return found


def declared(component, both, surfaces):
    """The cause that a calibration component is."""
    names, index = np.unique(surfaces, return_inverse=True)
    typical = both.render.mean(axis=0)

    def factors(generator, shape):
        return np.exp(component.u * noise(generator, shape, component.degrees_of_freedom))

    def disturb(generator, render, photo):
        d, n = render.shape[:2]
        if component.pattern == "level":
            return render * factors(generator, (d, 1, 1)), photo
        if component.pattern == "channels":
            return render * factors(generator, (d, 1, 3)), photo
        if component.pattern == "surfaces":
            return render * factors(generator, (d, len(names), 1))[:, index], photo
        if component.pattern == "regions":
            return render * factors(generator, (d, n, 1)), photo
        if component.pattern == "vignetting":
            return render * factors(generator, (d, 1, 1)) ** both.radius2[:, None], photo
        if component.pattern == "tone":
            return render, np.maximum(photo, 1e-9) ** factors(generator, (d, 1, 1))
        share = component.u * noise(generator, (d, 1, 1), component.degrees_of_freedom)
        if component.pattern == "glare":
            return render + share * (both.mean_picture * render.mean(axis=1, keepdims=True) / typical - render), photo
        mixing = component.u * noise(generator, (d, 3, 3), component.degrees_of_freedom) * (1 - np.eye(3))
        return render + np.einsum("dij,dnj->dni", mixing * typical[:, None] / typical[None, :], render), photo

    return Cause(component.name, component.kind, component.u, component.degrees_of_freedom, component.source, disturb, component.pattern)


def drawn(both, some, draws=DRAWS):
    """Draws of render and photograph means, (d, n, 3) each, with the causes applied one after another.

    Every cause has its own stream of random numbers, so that it does the same alone and among others.
    """
    render, photo = (np.repeat(side[None], draws, axis=0) for side in (both.render, both.photo))
    for cause in some:
        generator = np.random.default_rng([SEED, zlib.crc32(cause.name.encode())])
        render, photo = cause.disturb(generator, render, photo)
    return render, photo


@dataclass(frozen=True)
class Spread:
    """Draws of one level: predicted and photographed XYZ (d, n, 3)."""

    predicted: np.ndarray
    photo: np.ndarray

    @property
    def log_ratio(self):
        """Natural logarithm of the luminance ratio, (d, n); NaN without light."""
        return np.log(positive(self.predicted[..., 1]) / positive(self.photo[..., 1]))

    @property
    def uv_step(self):
        """u'v' of the prediction less that of the photograph, (d, n, 2)."""
        return chromaticity(self.predicted) - chromaticity(self.photo)


def positive(values):
    """The values, NaN where not positive."""
    return np.where(values > 0, values, np.nan)


def spread(name, both, setting, sides):
    """The draws of a level, fitted anew for each."""
    render, photo = sides
    return Spread(predict(name, render, photo, setting) @ both.to_xyz.T, photo @ both.to_xyz.T)


def percentiles(draws, shares):
    """Percentiles of draws along the first axis, undefined draws left out; NaN where none is left."""
    empty = ~np.isfinite(draws).any(axis=0)
    return np.where(empty, np.nan, np.nanpercentile(np.where(empty, 0, draws), shares, axis=0))


def interval(draws):
    """Central 95 % of draws along the first axis, (2, ...), NaN where none is finite."""
    return percentiles(draws, TAILS)


def distance_intervals(level, both, estimate):
    """95 % intervals of distances (du'v', dE2000, dE ITP), {key: (n, 2)}.

    Draws of a distance scatter about too large a value, and an interval of them never holds zero. Instead the
    radius is taken within which 95 % of the draws of the pair stay from the pair as found; the interval is the
    distance plus and minus that radius, no less than zero, and holds the true distance at least as often.
    """
    photo = both.photo @ both.to_xyz.T
    with np.errstate(divide="ignore", invalid="ignore"):
        moved = estimate * (positive(level.predicted) / positive(level.photo)) / (positive(estimate) / positive(photo))
    found = {}
    for key, metric in (("duv", duv), ("delta_e_2000", delta_e_2000), ("delta_e_itp", delta_e_itp)):
        away = metric(np.where(np.isfinite(moved), moved, estimate), np.broadcast_to(estimate, moved.shape))
        radius, middle = percentiles(away, TAILS[1] - TAILS[0]), metric(estimate, photo)
        found[key] = np.stack([np.maximum(middle - radius, 0), middle + radius], axis=-1)
    return found


def table(name, both, setting, all_causes, counted):
    """What each cause alone leaves at a level: standard uncertainties over the `counted` regions."""
    rows = []
    for cause in [*all_causes, None]:
        level = spread(name, both, setting, drawn(both, [cause] if cause else all_causes))
        log_ratio, step = level.log_ratio[:, counted], level.uv_step[:, counted]
        brightness, colour = deviation(log_ratio), np.sqrt((deviation(step) ** 2).sum(axis=-1))
        rows.append({
            "component": cause.name if cause else "all together", "kind": cause.kind if cause else None,
            "declared_relative_u": cause.declared_u if cause else None, "degrees_of_freedom": cause.degrees_of_freedom if cause else None,
            "pattern": cause.pattern if cause else None, "removed_by": cause.removed_by if cause else None, "source": cause.source if cause else "drawn together, fits made anew in each draw",
            "luminance_u": summary(brightness), "luminance_u_largest": summary(brightness, np.max), "duv_u": summary(colour),
        })
    low, high = interval(log_ratio)
    radius = percentiles(np.linalg.norm(step - np.nanmedian(np.where(np.isfinite(step), step, 0), axis=0), axis=-1), TAILS[1] - TAILS[0])
    rows[-1] |= {"luminance_expanded_95": summary((high - low) / 2), "duv_expanded_95": summary(radius)}
    return rows


def deviation(values):
    """Standard deviation over draws (first axis), undefined draws left out; NaN where fewer than two are left."""
    known = np.isfinite(values)
    count = known.sum(axis=0)
    middle = np.where(known, values, 0).sum(axis=0) / np.maximum(count, 1)
    square = np.where(known, (values - middle) ** 2, 0).sum(axis=0)
    return np.where(count > 1, np.sqrt(square / np.maximum(count - 1, 1)), np.nan)


def summary(values, reduce=np.median):
    """A figure over regions, rounded; None where there is none."""
    values = values[np.isfinite(values)]
    return round(float(reduce(values)), 6) if len(values) else None
