"""95 % intervals of what a level fitted: exposure, gains, glare.

Two scatters disagree when a scene is wrong: that of the data (every draw of the
budget fitted anew) and that between surfaces (each surface left out in turn).
The first says how well the fit is known if render and photograph differ by
nothing else, the second includes that they do. The wider one is the interval.
What a level fits is measured by it: the declared uncertainty of the lamp's level
blurs no exposure of L1, it is what that exposure is held against.
"""

import numpy as np
from scipy.stats import t

from .budget import drawn, interval
from .ladder import HOLDS, parameters, rounded

# Share of an interval.
SHARE = 0.95


def parameter_intervals(name, both, setting, all_causes):
    """{parameter_95, parameter_95_budget, parameter_95_surfaces} for each parameter of a level."""
    found = {}
    blurring = [cause for cause in all_causes if cause.removed_by not in HOLDS[name]]
    draws = parameters(name, *drawn(both, blurring), setting, setting.fit)
    best = parameters(name, both.render, both.photo, setting, setting.fit)
    between = half_widths(name, both, setting)
    for key, value in best.items():
        budget = np.moveaxis(interval(draws[key]), 0, -1)
        half = between[key]
        surfaces = np.stack([value - half, value + half], axis=-1)
        wider = np.where((budget[..., 1] - budget[..., 0] >= 2 * half)[..., None], budget, surfaces)
        found |= {f"{key}_95": rounded(wider), f"{key}_95_budget": rounded(budget), f"{key}_95_surfaces": rounded(surfaces)}
    return found


def half_widths(name, both, setting):
    """Half the interval of each parameter by the jackknife over surfaces, Student's t of one less than their number."""
    surfaces = np.unique(setting.surfaces[setting.fit])
    without = [parameters(name, both.render, both.photo, setting, setting.fit & (setting.surfaces != surface)) for surface in surfaces]
    count = len(surfaces)
    found = {}
    for key in without[0]:
        values = np.array([entry[key] for entry in without])
        error = np.sqrt((count - 1) / count * ((values - values.mean(axis=0)) ** 2).sum(axis=0))
        found[key] = t.ppf((1 + SHARE) / 2, count - 1) * error
    return found
