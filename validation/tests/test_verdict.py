"""Verdicts: no more false alarms than stated, planted differences found, and wide budgets settle nothing."""

import unittest

import numpy as np
from scipy.stats import binom

from etalon_validation.budget import causes, distance_intervals, drawn, spread
from etalon_validation.difference import chromaticity, duv
from etalon_validation.ladder import predict
from etalon_validation.verdict import AGREES, DIFFERS, FALSE_ALARMS, UNSETTLED, judge, together, verdict

from .world import BRIGHT, FALSE_ALARM, SURFACES_OF, calibration, pixels, region_means, setting_of

DRAWS = 400
ALL = np.ones(len(BRIGHT), bool)


def rows(both, name, known):
    """Judged regions of a comparison at a level, each with its verdict."""
    setting = setting_of(both)
    level = spread(name, both, setting, drawn(both, causes(both, SURFACES_OF, known), DRAWS))
    predicted, photo = predict(name, both.render, both.photo, setting) @ both.to_xyz.T, both.photo @ both.to_xyz.T
    judged = judge(level, np.log(predicted[:, 1] / photo[:, 1]), chromaticity(predicted) - chromaticity(photo), ALL)
    radius = distance_intervals(level, both, predicted)["duv"][:, 1] - duv(predicted, photo)
    return [row | {"name": str(index), "verdict": verdict(row, radius[index])} for index, row in enumerate(judged)]


class Verdict(unittest.TestCase):
    def test_a_level_without_differences_is_called_different_no_more_often_than_stated(self):
        """Noise of both sides and one lamp level that all regions share, known as well as it errs."""
        trials, generator, alarms = 200, np.random.default_rng(21), 0
        for _ in range(trials):
            both = pixels(generator, np.exp(0.1 * generator.standard_normal()), render_noise=0.1, photo_noise=0.05)
            alarms += together(rows(both, "L0", calibration(level=0.1)))["verdict"] == DIFFERS
        self.assertLessEqual(alarms, binom.isf(FALSE_ALARM, trials, FALSE_ALARMS))

    def test_a_wall_that_is_a_third_too_bright_differs_and_the_others_do_not(self):
        both = pixels(np.random.default_rng(22), photo_noise=0.02)
        both.render[2] *= 4 / 3
        found = rows(both, "L0", calibration())
        self.assertEqual([row["verdict"] for row in found], [DIFFERS if index == 2 else AGREES for index in range(8)])
        self.assertTrue(found[2]["difference_matters"])
        self.assertGreater(found[2]["multiple_of_u"], 5)
        self.assertEqual(together(found)["largest"]["region"], "2")

    def test_a_shift_of_chromaticity_alone_differs(self):
        both = pixels(np.random.default_rng(23), photo_noise=0.02)
        turned = both.render[0] @ both.to_xyz.T
        turned[[0, 2]] *= [1.1, 0.8]
        both.render[0] = turned @ np.linalg.inv(both.to_xyz).T
        found = rows(both, "L0", calibration())
        self.assertEqual(found[0]["verdict"], DIFFERS)
        self.assertLess(found[0]["luminance_multiple_of_u"], 4)

    def test_a_budget_wider_than_what_matters_settles_nothing(self):
        both = region_means(1.02 * BRIGHT, BRIGHT)
        self.assertEqual({row["verdict"] for row in rows(both, "L0", calibration(regions=0.15))}, {UNSETTLED})
        self.assertEqual({row["verdict"] for row in rows(both, "L0", calibration(regions=0.03))}, {AGREES})
        self.assertEqual({row["verdict"] for row in rows(region_means(2 * BRIGHT, BRIGHT), "L0", calibration(regions=0.15))}, {DIFFERS})

    def test_regions_that_are_kept_out_have_no_verdict_and_cost_no_power(self):
        both = pixels(np.random.default_rng(24), photo_noise=0.02)
        setting = setting_of(both)
        level = spread("L0", both, setting, drawn(both, causes(both, SURFACES_OF, calibration()), DRAWS))
        step = np.full((8, 2), np.nan)
        step[1:] = 0
        self.assertEqual([row is None for row in judge(level, np.zeros(8), step, ALL & (np.arange(8) != 4))], [True, False, False, False, True, False, False, False])


if __name__ == "__main__":
    unittest.main()
