"""Whether two renderers show the same picture: known differences, and how often chance makes one.

Seeds are fixed. Where chances are counted, more than the count that chance alone exceeds once in a thousand fails.
"""

import unittest
from unittest import mock

import numpy as np
from scipy import stats

from etalon_validation import peer_agreement
from etalon_validation.peer_agreement import AGREES, BLOCK, BLOCK_MARGIN, DIFFERS, FALSE_ALARM, MEAN_MARGIN, UNDECIDED, agreement, block_means

SIZE, RUNS = (64, 64), 16
ALPHA = 1e-3


def stack(generator, noise, scale=1.0, runs=RUNS):
    """Runs around one truth with a relative deviation of each pixel."""
    truth = np.exp(np.random.default_rng(3).normal(0, 0.5, SIZE))
    return scale * truth * (1 + noise * generator.standard_normal((runs, *SIZE)))


class Agreements(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(17)

    def judge(self, scale=1.0, noise=0.1, share=0.5):
        """`share`: our noise over theirs."""
        return agreement(stack(self.generator, noise, scale), stack(self.generator, share * noise))

    def test_pictures_that_differ_by_noise_agree_and_the_interval_holds_one(self):
        found = self.judge()
        self.assertEqual((found.verdict, found.blocks, found.blocks_beyond), (AGREES, (SIZE[0] // BLOCK) ** 2, 0))
        self.assertLess(abs(found.mean_ratio.value - 1), MEAN_MARGIN)

    def test_a_level_beyond_the_margin_is_found_and_one_within_is_not(self):
        self.assertEqual(self.judge(1 + 2 * MEAN_MARGIN).verdict, DIFFERS)
        self.assertEqual(self.judge(1 / (1 + 2 * MEAN_MARGIN)).verdict, DIFFERS)
        self.assertEqual(self.judge(1 + 0.5 * MEAN_MARGIN).verdict, AGREES)

    def test_one_wrong_block_is_found(self):
        scale = np.ones(SIZE)
        scale[BLOCK : 2 * BLOCK, :BLOCK] = 1 + 3 * BLOCK_MARGIN
        found = self.judge(scale)
        self.assertEqual((found.verdict, found.blocks_beyond), (DIFFERS, 1))

    def test_a_picture_turned_around_differs(self):
        theirs = stack(self.generator, 0.1) * np.linspace(0.8, 1.2, SIZE[1])
        self.assertEqual(agreement(theirs[:, :, ::-1], theirs).verdict, DIFFERS)

    def test_noise_larger_than_the_margin_is_undecided_and_never_agreement(self):
        self.assertEqual(self.judge(noise=20.0).verdict, UNDECIDED)
        self.assertEqual(self.judge(1.05, noise=20.0).verdict, UNDECIDED)

    def test_chance_alone_makes_a_difference_no_more_often_than_is_said(self):
        studies = 150
        with mock.patch.object(peer_agreement, "MEAN_MARGIN", 0.0), mock.patch.object(peer_agreement, "BLOCK_MARGIN", 0.0):
            for share in (0.3, 1.0, 3.0):
                alarms = sum(self.judge(share=share).verdict == DIFFERS for _ in range(studies))
                self.assertLessEqual(alarms, stats.binom.isf(ALPHA, studies, FALSE_ALARM), share)

    def test_small_and_dark_pictures_have_blocks_too(self):
        self.assertEqual(block_means(np.ones((2, 9, 12))).shape, (2, 1, 1))
        dark = stack(self.generator, 0.1)
        dark[:, :, : SIZE[1] // 2] = 0.0
        self.assertEqual(agreement(dark, dark[::-1]).blocks, (SIZE[0] // BLOCK) ** 2 // 2)


if __name__ == "__main__":
    unittest.main()
