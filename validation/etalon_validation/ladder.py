"""The ladder of fits between a render and a photograph.

Every level predicts the photograph's channels from the render's, with more
freedom at each step: L0 none, L1 one exposure factor, L2 one gain per channel,
L3 a 3x3 matrix, L4 the gains of L2 and veiling glare. L3 and L4 predict each
region with a fit that saw no region of the same surface, so their scores are
predictions and not fits. L4 stands on L2, not on L3: gains leave colour to tell
light that was added from light that was mixed, a matrix would take up both.

Every fit takes leading axes. An interval comes from draws of the data, each
fitted anew, and a fit held fixed would leave its own uncertainty out.

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
    "L4": "gains and veiling glare, each region predicted without its surface",
}
# Levels that predict a region from the other surfaces alone.
HELD_OUT = ("L3", "L4")
# Levels whose freedom a level holds: what they take up is measured by its fit and does not blur it.
HOLDS = {"L0": (), "L1": ("L1",), "L2": ("L1", "L2"), "L3": ("L1", "L2", "L3"), "L4": ("L1", "L2", "L4")}
# How far an entry of the matrix is expected from the channel gains, in units of them: neighbouring channels of
# cameras differ by mixtures of about a tenth.
EXPECTED_MIXTURE = 0.1
# Middle and half width of the search for veiling glare over direct light. It goes below zero, where no glare is,
# so that an estimate near none is not pushed up.
GLARE_MIDDLE, GLARE_REACH = 0.2, 0.5
# Each search looks at so many steps over its reach, the next one around the best of them, down to the last reach.
GLARE_STEPS = np.linspace(-1, 1, 21)
GLARE_ZOOM = 8
GLARE_LAST_REACH = 1e-6
# A relative ridge that keeps a singular matrix solvable; below rounding for all others.
RIDGE = 1e-14
# Draws of dark regions may fall to zero and below, where the logarithm ends.
FAINT = 1e-9


@dataclass(frozen=True)
class Setting:
    """What all fits of one comparison share.

    `luminance` (3,) turns channels into luminance; `fit` (n,) names the regions that may be fitted; `weights`
    (n,) are 1 / photo luminance, so that dark and bright regions count alike; `veil` (3,) is the render's mean over
    the whole picture, which veiling glare spreads, over its mean in the regions that may be fitted.
    """

    luminance: np.ndarray
    surfaces: np.ndarray
    fit: np.ndarray
    weights: np.ndarray
    veil: np.ndarray

    @classmethod
    def of(cls, render, photo, luminance, surfaces, usable, mean_picture):
        """The setting of region means (n, 3); regions without light on one side are not fitted."""
        photo_y, render_y = photo @ luminance, render @ luminance
        fit = usable & (photo_y > 0) & (render_y > 0)
        return cls(luminance, np.asarray(surfaces), fit, 1 / np.maximum(photo_y, 1e-6), mean_picture / np.maximum(render[fit].mean(axis=0), FAINT))


@dataclass(frozen=True)
class Level:
    """What a level fitted, and what it predicts for each region (n, 3) and for any pixel."""

    name: str
    fitted: dict
    predicted: np.ndarray
    whole: np.ndarray
    offset: np.ndarray

    def apply(self, channels):
        """The prediction for pixels (..., 3), with the fit on all regions."""
        return channels @ self.whole.T + self.offset


def nothing(render, photo, setting, chosen):
    """L0: the render as it is."""
    shape = render.shape[:-2]
    return np.broadcast_to(np.eye(3), (*shape, 3, 3)), np.zeros((*shape, 3))


def exposure(render, photo, setting, chosen):
    """L1: the factor with the smallest rms luminance ratio in stops, the geometric mean of the ratios."""
    render_y, photo_y = (np.maximum(side[..., chosen, :] @ setting.luminance, FAINT) for side in (render, photo))
    factor = np.exp2(np.mean(np.log2(photo_y / render_y), axis=-1))
    return factor[..., None, None] * np.eye(3), np.zeros((*factor.shape, 3))


def gain_values(render, photo, weights):
    """One factor per channel by weighted least squares, (..., 3); zero where the render has no light."""
    squared = (weights**2)[:, None]
    return (squared * render * photo).sum(axis=-2) / np.maximum((squared * render**2).sum(axis=-2), FAINT**2)


def gains(render, photo, setting, chosen):
    """L2: one factor per channel."""
    found = gain_values(render[..., chosen, :], photo[..., chosen, :], setting.weights[chosen])
    return found[..., None] * np.eye(3), np.zeros(found.shape)


def matrix(render, photo, setting, chosen):
    """L3: the most probable 3x3 matrix from render channels to photo channels.

    Residuals are normal with the standard deviation that least squares leaves;
    entries are normal around the channel gains.
    """
    render, photo, weights = render[..., chosen, :], photo[..., chosen, :], setting.weights[chosen]
    gain = gain_values(render, photo, weights)
    known, wanted = render * gain[..., None, :] * weights[:, None], photo * weights[:, None]
    across = np.swapaxes(known, -1, -2)
    gram = across @ known
    free = np.linalg.pinv(gram, hermitian=True) @ (across @ wanted)
    spare = max(render.shape[-2] - 3, 1)
    residual = ((known @ free - wanted) ** 2).sum(axis=(-1, -2)) / (3 * spare)
    ridge = residual / EXPECTED_MIXTURE**2 + RIDGE * np.trace(gram, axis1=-2, axis2=-1)
    mixture = np.linalg.solve(gram + ridge[..., None, None] * np.eye(3), across @ (wanted - known))
    return np.swapaxes(gain[..., :, None] * (np.eye(3) + mixture), -1, -2), np.zeros(gain.shape)


def glare_values(render, photo, setting, chosen):
    """Gains a (..., 3), glare over direct light h (...) and mean picture (..., 3): photo = a (render + h mean picture).

    Weighted least squares. For each h the best gains are known in closed form; h is searched on ever finer steps.
    """
    mean = setting.veil * render[..., setting.fit, :].mean(axis=-2)
    render, photo = render[..., chosen, :], photo[..., chosen, :]
    squared = (setting.weights[chosen] ** 2)[:, None]
    both, alone = (squared * render * photo).sum(axis=-2), (squared * photo).sum(axis=-2) * mean
    square, cross, flat = (squared * render**2).sum(axis=-2), (squared * render).sum(axis=-2) * mean, squared.sum() * mean**2

    def explained(share):
        """The part of the photograph's squares that the best gains explain."""
        h = share[..., None]
        one = (both[..., None, :] + h * alone[..., None, :]) ** 2
        return (one / np.maximum(square[..., None, :] + 2 * h * cross[..., None, :] + h**2 * flat[..., None, :], FAINT**2)).sum(axis=-1)

    middle, reach = np.full(render.shape[:-2], GLARE_MIDDLE), GLARE_REACH
    while reach > GLARE_LAST_REACH:
        steps = middle[..., None] + reach * GLARE_STEPS
        middle = np.take_along_axis(steps, explained(steps).argmax(axis=-1)[..., None], axis=-1)[..., 0]
        middle, reach = np.clip(middle, GLARE_MIDDLE - GLARE_REACH, GLARE_MIDDLE + GLARE_REACH), reach / GLARE_ZOOM
    h = middle[..., None]
    return (both + h * alone) / np.maximum(square + 2 * h * cross + h**2 * flat, FAINT**2), middle, mean


def glare(render, photo, setting, chosen):
    """L4: gains and one veil of light over the picture."""
    gain, h, mean = glare_values(render, photo, setting, chosen)
    return gain[..., None] * np.eye(3), gain * h[..., None] * mean


FITS = {"L0": nothing, "L1": exposure, "L2": gains, "L3": matrix, "L4": glare}


def predict(name, render, photo, setting):
    """What a level predicts for every region, (..., n, 3), from region means of render and photograph."""
    if name not in HELD_OUT:
        return through(render, *FITS[name](render, photo, setting, setting.fit))
    predicted = np.empty(np.broadcast_shapes(render.shape, photo.shape))
    for surface in np.unique(setting.surfaces):
        own = setting.surfaces == surface
        predicted[..., own, :] = through(render[..., own, :], *FITS[name](render, photo, setting, setting.fit & ~own))
    return predicted


def through(render, whole, offset):
    """Region means (..., n, 3) through a matrix (..., 3, 3) and an offset (..., 3)."""
    return render @ np.swapaxes(whole, -1, -2) + offset[..., None, :]


def parameters(name, render, photo, setting, chosen):
    """What a level fits on the `chosen` regions: exposure and gains in stops, glare as a share of the light."""
    if name in ("L0", "L3"):
        return {}
    if name == "L4":
        gain, h, _ = glare_values(render, photo, setting, chosen)
        return {"glare_share": h / (1 + h), "gains_stops": stops(gain * (1 + h)[..., None])}
    diagonal = np.diagonal(FITS[name](render, photo, setting, chosen)[0], axis1=-2, axis2=-1)
    return {"exposure_stops": stops(diagonal[..., 0])} if name == "L1" else {"gains_stops": stops(diagonal)}


def stops(factors):
    """log2 of each factor; NaN where a factor is not positive."""
    return np.log2(np.where(factors > 0, factors, np.nan))


def climb(render, photo, setting):
    """All levels for region means (n, 3), lowest first."""
    return [level(name, render, photo, setting) for name in NAMES]


def level(name, render, photo, setting):
    """One level: its fit on all regions, and its predictions."""
    whole, offset = FITS[name](render, photo, setting, setting.fit)
    found = {key: rounded(value) for key, value in parameters(name, render, photo, setting, setting.fit).items()}
    if name == "L1":
        found["exposure_factor"] = significant(whole[0, 0])
    if name == "L2":
        found["gains"] = significant(np.diag(whole))
    if name == "L3":
        found |= {"matrix_all_regions": significant(whole), "expected_mixture": EXPECTED_MIXTURE}
        found["matrices_without_surface"] = {
            str(surface): significant(matrix(render, photo, setting, setting.fit & (setting.surfaces != surface))[0])
            for surface in np.unique(setting.surfaces)
        }
    if name == "L4":
        gain, h, _ = glare_values(render, photo, setting, setting.fit)
        found |= {"gains": significant(gain * (1 + h)), "base": "L2", "glare_at_limit": bool(abs(h - GLARE_MIDDLE) > 0.999 * GLARE_REACH)}
    return Level(name, found, predict(name, render, photo, setting), whole, offset)


def rounded(values, digits=5):
    """Numbers for JSON: a number or a list of them; None where not finite."""
    if np.ndim(values):
        return [rounded(value, digits) for value in values]
    return round(float(values), digits) if np.isfinite(values) else None


def significant(values, digits=6):
    """Numbers for JSON: nested lists, rounded to significant digits."""
    if np.ndim(values):
        return [significant(value, digits) for value in values]
    return float(f"{float(values):.{digits}g}")
