"""The ladder of fits between a render and a photograph.

Every level predicts the photograph's channels from the render's, with more
freedom at each step: L0 none, L1 one exposure factor, L2 one gain per channel,
L3 a 3x3 matrix. L3 predicts each region with a matrix fitted without any
region of the same surface, so its score is a prediction and not a fit.

A box has few colours: without its red wall there may be two left, and three
channels cannot be told apart by two. The matrix is therefore the most probable
one when its entries are expected near the channel gains; colours that were not
seen keep the gains, and colours that were seen overrule them.
"""

from dataclasses import dataclass

import numpy as np

NAMES = {
    "L0": "nothing fitted",
    "L1": "one exposure factor",
    "L2": "three channel gains",
    "L3": "3x3 matrix, each region predicted without its surface",
}
# How far an entry of the matrix is expected from the channel gains, in units of them: neighbouring channels of
# cameras differ by mixtures of about a tenth.
EXPECTED_MIXTURE = 0.1


@dataclass(frozen=True)
class Level:
    """What a level fitted, and what it predicts for each region and for any pixel."""

    name: str
    fitted: dict
    predicted: np.ndarray
    matrices: np.ndarray
    whole: np.ndarray

    def apply(self, channels):
        """The prediction for pixels (..., 3), with the fit on all regions."""
        return channels @ self.whole.T


def exposure(render_luminance, photo_luminance):
    """The factor with the smallest rms luminance ratio in stops: the geometric mean of the ratios."""
    return float(np.exp2(np.mean(np.log2(photo_luminance / render_luminance))))


def gains(render, photo, weights):
    """One factor per channel by weighted least squares."""
    squared = (weights**2)[:, None]
    return (squared * render * photo).sum(axis=0) / (squared * render**2).sum(axis=0)


def matrix(render, photo, weights):
    """The most probable 3x3 matrix from render channels to photo channels.

    Residuals are normal with the standard deviation that least squares leaves;
    entries are normal around the channel gains.
    """
    gain = gains(render, photo, weights)
    known, wanted = render * gain * weights[:, None], photo * weights[:, None]
    free, *_ = np.linalg.lstsq(known, wanted, rcond=None)
    spare = max(len(render) - 3, 1)
    residual = np.sqrt(((known @ free - wanted) ** 2).sum() / (3 * spare))
    rows = np.concatenate([known, residual / EXPECTED_MIXTURE * np.eye(3)])
    mixture, *_ = np.linalg.lstsq(rows, np.concatenate([wanted - known, np.zeros((3, 3))]), rcond=None)
    return (gain[:, None] * (np.eye(3) + mixture)).T


def climb(render, photo, luminance, surfaces, usable):
    """All levels for region means (n, 3); fits use only the `usable` regions.

    `luminance` is the row that turns channels into luminance. Residuals are
    weighted by 1 / photo luminance, so dark and bright regions count alike.
    """
    surfaces = np.asarray(surfaces)
    photo_y, render_y = photo @ luminance, render @ luminance
    weights = 1 / np.maximum(photo_y, 1e-6)
    fit = usable & (photo_y > 0) & (render_y > 0)
    count = len(render)

    def level(name, fitted, matrices, whole):
        return Level(name, fitted, np.einsum("nij,nj->ni", matrices, render), matrices, whole)

    def everywhere(whole):
        return np.broadcast_to(whole, (count, 3, 3))

    factor = exposure(render_y[fit], photo_y[fit])
    channel = gains(render[fit], photo[fit], weights[fit])
    whole = matrix(render[fit], photo[fit], weights[fit])
    held_out = np.array([
        matrix(render[fit & (surfaces != surface)], photo[fit & (surfaces != surface)], weights[fit & (surfaces != surface)])
        for surface in surfaces
    ])
    each = {str(surface): significant(held_out[index]) for index, surface in enumerate(surfaces)}
    return [
        level("L0", {}, everywhere(np.eye(3)), np.eye(3)),
        level("L1", {"exposure_stops": round(float(np.log2(factor)), 4), "exposure_factor": significant(factor)}, everywhere(factor * np.eye(3)), factor * np.eye(3)),
        level("L2", {"gains": significant(channel), "gains_stops": stops(channel)}, everywhere(np.diag(channel)), np.diag(channel)),
        level("L3", {"matrix_all_regions": significant(whole), "matrices_without_surface": each, "expected_mixture": EXPECTED_MIXTURE}, held_out, whole),
    ]


def stops(factors):
    """log2 of each factor; None where a factor is not positive."""
    return [round(float(np.log2(value)), 4) if value > 0 else None for value in factors]


def significant(values, digits=6):
    """Numbers for JSON: nested lists, rounded to significant digits."""
    if np.ndim(values):
        return [significant(value, digits) for value in values]
    return float(f"{float(values):.{digits}g}")
