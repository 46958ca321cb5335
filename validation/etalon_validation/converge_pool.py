"""Which series the others are judged by where no reference is given.

The least scatter makes the best reference, but whoever misses light scatters
less for it. So series that differ beyond noise are not taken by their scatter:
light that is found is there, unless an integrator counts it twice, and which of
the two it is no study of the scene alone can tell. Both are flagged.
"""

import numpy as np

from .converge_bias import against_runs
from .converge_reference import PooledReference, divisor_of
from .errors import InputError

# With fewer repeats of a budget nothing scatters once a run is left out.
FEWEST_REPEATS = 3


def pooled_reference(series_list):
    """All runs of one series, of those that can make every path that carries light.

    It is the one that scatters least at its largest budget, unless others differ from it beyond noise: who misses
    light scatters less for it, so of those that differ the one with the most light is taken. Foreign series are no
    part of it. `InputError` where no series can serve.
    """
    able = [series for series in series_list if not series.is_foreign and not series.missing] or [series for series in series_list if not series.is_foreign]
    able = [series for series in able if min(len(series.at(point)) for point in series.points) >= FEWEST_REPEATS]
    if not able:
        raise InputError("--reference", "is missing, and there are no runs to judge others by", f"give a picture with little noise, or at least {FEWEST_REPEATS} repeats by this program")
    largest = [np.asarray(series.images[series.at(series.points[-1])], float) for series in able]
    plain = np.mean([images.mean(axis=0) for images in largest], axis=0)
    if not plain.mean() > 0:
        raise InputError("the runs", "found no light", "give a larger --budget")
    scatter = [float((images.var(axis=0, ddof=1) / divisor_of(plain)).mean()) for images in largest]
    if not max(scatter) > 0:
        raise InputError("the runs", "all show the same picture", "take a scene that is rendered with noise")
    best = int(np.argmin([value if value > 0 else np.inf for value in scatter]))
    apart = [index for index, value in enumerate(scatter) if index != best and value > 0 and against_runs(largest[index], largest[best]).is_significant]
    return pool_of(able[max([best, *apart], key=lambda index: largest[index].mean())])


def pool_of(series):
    """All runs of a series, weighted by what a budget was to take, and not what was drawn: weights may not follow pictures."""
    points, weights = (np.array(column) for column in zip(*((run.point, weight_of(series, run)) for run in series.runs)))
    return PooledReference(series.name, series.images, points, weights)


def weight_of(series, run):
    """A run's samples per pixel, or the mean CPU seconds of its budget where samples are not known."""
    if run.spp is not None:
        return float(run.spp)
    return float(np.mean([series.runs[index].cpu_s for index in series.at(run.point)]))
