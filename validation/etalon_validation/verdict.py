"""What a level's figures say: agreement, difference, or that the data cannot tell.

A region differs where its luminance ratio and chromaticity together lie outside
what the budget allows (Hotelling's T^2 of three numbers). Fifty regions are
fifty chances of a false alarm, and their errors share causes: the
Benjamini-Yekutieli procedure keeps the expected share of false alarms among the
regions called different at `FALSE_ALARMS` or below under any dependence, and with it the
chance of calling any region different when none is. What does not differ agrees
only if a difference that matters would have been seen.
"""

import numpy as np
from scipy.stats import f, false_discovery_control

from .budget import deviation

# Expected share of false alarms among regions called different.
FALSE_ALARMS = 0.05
# Differences that matter to whoever lights or photographs a room: a tenth in luminance, and a chromaticity step of 0.01
# in u'v'. An uncertainty (95 %) above them settles nothing.
LUMINANCE_THAT_MATTERS = 0.10
DUV_THAT_MATTERS = 0.01
# Coverage factor of an expanded uncertainty of 95 %, normal.
COVERAGE = 1.96
# Below this a variance is rounding.
ROUNDING = 1e-18

AGREES, DIFFERS, UNSETTLED = "agrees within uncertainty", "differs", "cannot be settled"


def distances(draws, estimate):
    """Squared Mahalanobis distance of zero from estimates (n, k), by the covariance of draws (d, n, k)."""
    known = np.isfinite(draws).all(axis=-1, keepdims=True)
    count = np.maximum(known.sum(axis=0), 2)
    away = np.where(known, draws - np.where(known, draws, 0).sum(axis=0) / count, 0)
    covariance = np.einsum("dni,dnj->nij", away, away) / (count - 1)[..., None] + ROUNDING * np.eye(draws.shape[-1])
    return np.einsum("ni,ni->n", estimate, np.linalg.solve(covariance, estimate[..., None])[..., 0])


def chances(squared, draws, numbers):
    """p-values of squared distances of `numbers` figures whose covariance is known from draws (Hotelling)."""
    freedom = draws - 1
    return f.sf(squared * (freedom - numbers + 1) / (freedom * numbers), numbers, freedom - numbers + 1)


def judge(level, log_ratio, uv_step, counted):
    """Verdict of each region: list of dicts, None for regions that are not `counted` or have no figures.

    `level` holds the draws; `log_ratio` (n,) and `uv_step` (n, 2) are the estimates.
    """
    draws = len(level.log_ratio)
    estimate = np.concatenate([log_ratio[:, None], uv_step], axis=-1)
    counted = counted & np.isfinite(estimate).all(axis=-1)
    estimate = np.where(counted[:, None], estimate, 0)
    all_draws = np.concatenate([level.log_ratio[..., None], level.uv_step], axis=-1)
    p = chances(distances(all_draws, estimate), draws, 3)
    adjusted = np.ones(len(p))
    if counted.any():
        adjusted[counted] = false_discovery_control(p[counted], method="by")
    brightness = np.sqrt(distances(all_draws[..., :1], estimate[:, :1]))
    colour = np.sqrt(distances(all_draws[..., 1:], estimate[:, 1:]))
    u = deviation(level.log_ratio)
    rows = []
    for index in range(len(p)):
        if not counted[index]:
            rows.append(None)
            continue
        rows.append({
            "luminance_u": float(u[index]), "luminance_multiple_of_u": float(brightness[index]),
            "chromaticity_multiple_of_u": float(colour[index]), "multiple_of_u": float(max(brightness[index], colour[index])),
            "p": float(p[index]), "p_adjusted": float(adjusted[index]),
            "difference_matters": bool(abs(estimate[index, 0]) > np.log1p(LUMINANCE_THAT_MATTERS) or np.hypot(*estimate[index, 1:]) > DUV_THAT_MATTERS),
        })
    return rows


def verdict(row, duv_radius):
    """The verdict of a judged region in one of three phrases; `duv_radius` is the 95 % radius in u'v'."""
    if row["p_adjusted"] <= FALSE_ALARMS:
        return DIFFERS
    wide = COVERAGE * row["luminance_u"] > LUMINANCE_THAT_MATTERS or not duv_radius <= DUV_THAT_MATTERS
    return UNSETTLED if wide else AGREES


def together(rows):
    """The verdict of a level over its judged region rows: a difference anywhere is a difference."""
    judged = [row for row in rows if row.get("verdict")]
    counts = {phrase: sum(row["verdict"] == phrase for row in judged) for phrase in (AGREES, DIFFERS, UNSETTLED)}
    phrase = DIFFERS if counts[DIFFERS] else UNSETTLED if counts[UNSETTLED] or not judged else AGREES
    worst = max((row for row in judged if row["verdict"] == DIFFERS), key=lambda row: row["multiple_of_u"], default=None)
    return {
        "verdict": phrase, "agree": counts[AGREES], "differ": counts[DIFFERS], "unsettled": counts[UNSETTLED],
        "differ_and_matter": sum(row["verdict"] == DIFFERS and row["difference_matters"] for row in judged),
        "largest": worst and {"region": worst["name"], "multiple_of_u": worst["multiple_of_u"]},
        "false_alarms": FALSE_ALARMS, "correction": "Benjamini-Yekutieli",
        "luminance_that_matters": LUMINANCE_THAT_MATTERS, "duv_that_matters": DUV_THAT_MATTERS,
    }
