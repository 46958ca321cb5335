"""Whether a peer renders the same picture: its converged picture against Etalon's, level included.

Compared are the mean of the picture and the means of square blocks. Noise of
both sides is what their independent runs scatter by. A difference counts where
it goes beyond noise by more than a margin that was fixed beforehand; agreement
is claimed only where the noise is smaller than that margin, so that a noisy
picture cannot pass for a correct one.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from .converge_data import Estimate

BLOCK = 16
# Relative difference of the mean, and of a block, that renderers may have beyond noise: the observer
# of one has 5 nm steps, spheres of another are rounded in single precision, and no more.
MEAN_MARGIN, BLOCK_MARGIN = 0.01, 0.03
# Chance that the same picture is called another.
FALSE_ALARM = 0.01
# Blocks darker than this share of the mean are empty surroundings.
EMPTY = 1e-3
AGREES, DIFFERS, UNDECIDED = "agrees", "differs", "undecided"


@dataclass(frozen=True)
class Agreement:
    """The verdict, the mean over Etalon's with 95 % interval, and what the blocks say (relative differences)."""

    verdict: str
    mean_ratio: Estimate
    blocks: int
    blocks_beyond: int
    largest_block_difference: float
    typical_block_noise: float

    @property
    def words(self):
        """For tables."""
        ratio = self.mean_ratio
        return f"{self.verdict}: mean {ratio.value:.4f} [{ratio.low:.4f}, {ratio.high:.4f}], {self.blocks_beyond} of {self.blocks} blocks beyond, largest {self.largest_block_difference:.1%}, typical noise {self.typical_block_noise:.1%}"


def block_means(images):
    """Means (run, row, column) over blocks of 16 x 16 pixels; smaller where a picture has none. Partial ones are left out."""
    runs, height, width = images.shape
    side = min(BLOCK, height, width)
    rows, columns = height // side, width // side
    return images[:, : rows * side, : columns * side].reshape(runs, rows, side, columns, side).mean(axis=(2, 4), dtype=float)


def agreement(theirs, ours):
    """The `Agreement` of two stacks of runs (run, row, column) in cd/m2."""
    whole, freedom, noise = ratio_of(theirs.mean(axis=(1, 2), dtype=float), ours.mean(axis=(1, 2), dtype=float))
    blocks_of_ours = block_means(ours)
    lit = blocks_of_ours.mean(axis=0) > EMPTY * blocks_of_ours.mean()
    ratio, block_freedom, block_noise = (found[lit] for found in ratio_of(block_means(theirs), blocks_of_ours))
    tests = 1 + int(lit.sum())
    chance = (1 - (1 - FALSE_ALARM) ** (1 / tests)) / 2
    mean_beyond = abs(whole - 1) - stats.t.isf(chance, freedom) * noise > MEAN_MARGIN
    beyond = np.abs(ratio - 1) - stats.t.isf(chance, block_freedom) * block_noise > BLOCK_MARGIN
    is_quiet = noise < MEAN_MARGIN and np.median(block_noise) < BLOCK_MARGIN
    verdict = DIFFERS if mean_beyond or beyond.any() else AGREES if is_quiet else UNDECIDED
    half = float(stats.t.isf(0.025, freedom) * noise)
    return Agreement(verdict, Estimate(float(whole), float(whole - half), float(whole + half)), int(lit.sum()), int(beyond.sum()), float(np.abs(ratio - 1).max()), float(np.median(block_noise)))


def ratio_of(theirs, ours):
    """Mean of theirs over that of ours along the runs, Welch's degrees of freedom, and the standard error."""
    (a, b), (counts_a, counts_b) = (theirs.mean(axis=0), ours.mean(axis=0)), (len(theirs), len(ours))
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = a / b
        # Of the ratio, to first order.
        first, second = theirs.var(axis=0, ddof=1) / counts_a / b**2, ratio**2 * ours.var(axis=0, ddof=1) / counts_b / b**2
        both = first + second
        freedom = np.where(both > 0, both**2 / (first**2 / (counts_a - 1) + second**2 / (counts_b - 1)), counts_a + counts_b - 2)
    return ratio, freedom, np.sqrt(both)
