"""Made-up studies with known answers: pictures of a known variance and bias at doubling budgets."""

import numpy as np

from etalon_validation.converge_data import Run, Series
from etalon_validation.converge_reference import FileReference

SIZE = (40, 40)
LEAST_SPP = 4


def truth(seed=3):
    """A picture of uneven luminance."""
    return np.exp(np.random.default_rng(seed).normal(size=SIZE))


def series(generator, name, deviation, *, bias=0.0, common=0.0, points=4, repeats=6, setup_s=0.0, **more):
    """Runs around `truth()`: the relative deviation of one sample, a relative bias, a factor of the whole picture as a share of the deviation."""
    runs, images = [], []
    for point in range(points):
        spp = LEAST_SPP * 2**point
        for repeat in range(repeats):
            cpu_s = setup_s + 0.1 * spp * (1 + 0.01 * generator.normal())
            runs.append(Run(name, point, repeat, cpu_s, spp=spp))
            noise = generator.normal(size=SIZE) + common * generator.normal()
            images.append(truth() * (1 + bias + deviation / np.sqrt(spp) * noise))
    return Series(name, tuple(runs), np.array(images), **more)


def reference(generator, deviation=0.01, is_known=True):
    """A reference of a relative deviation, which it tells or not."""
    picture = truth()
    return FileReference(picture * (1 + deviation * generator.normal(size=SIZE)), (deviation * picture) ** 2 if is_known else None, "made up", "none")
