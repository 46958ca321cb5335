"""The error of one picture, with the noise of what it is judged against taken out.

The expectation of (I - R)^2 is bias^2 + variance of I + variance of R. The last
is no fault of I: it is subtracted pixel by pixel with the divisor that the
pixel's error has, so that the relative error is right too. What is left may be
negative for a single run; means over runs are unbiased.
"""

import math

import numpy as np

from .converge_data import Score, Series
from .converge_reference import divisor_of

# Share of the pixels, those with the largest terms, that the trimmed error leaves out; rounded up, as etalon compare does.
TRIMMED_SHARE = 0.001


def score(image, luminance, variance=None):
    """The `Score` of a picture against a reference of a variance per pixel (None: not known, nothing subtracted)."""
    variance = np.zeros_like(luminance) if variance is None else variance
    divisor = divisor_of(luminance)
    squares = (image - luminance) ** 2
    terms = squares / divisor
    noise = variance / divisor
    # Which terms are the largest is asked of what is seen, not of what is left.
    order = np.argsort(terms, axis=None)
    cut = terms.size - math.ceil(TRIMMED_SHARE * terms.size)
    kept, total = order[:cut], terms.sum()
    return Score(
        mse=float((squares - variance).mean()),
        relmse=float((terms - noise).mean()),
        relmse_trimmed=float((terms - noise).ravel()[kept].mean()) if cut else 0.0,
        largest_share=float(terms.ravel()[order[cut:]].sum() / total) if total > 0 else 0.0,
        reference_mse=float(variance.mean()),
        reference_relmse=float(noise.mean()),
    )


def score_series(series: Series, reference):
    """The scores of a series' runs, in their order."""
    return tuple(score(image, *reference.against(series.name, index)) for index, image in enumerate(np.asarray(series.images, float)))
