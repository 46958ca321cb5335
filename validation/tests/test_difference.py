"""Colour differences against published values."""

import unittest

import numpy as np

from etalon_validation.difference import WHITE_XYZ, above_white, chromaticity, delta_e_2000, delta_e_itp, delta_e_lab, duv


def itp_distance(first, second):
    """dE ITP of two absolute XYZ, from the recommendations' own numbers."""
    to_2020 = np.array([[1.7166512, -0.3556708, -0.2533663], [-0.6666844, 1.6164812, 0.0157685], [0.0176399, -0.0427706, 0.9421031]])
    to_lms = np.array([[1688, 2146, 262], [683, 2951, 462], [99, 309, 3688]]) / 4096
    to_itp = np.array([[2048, 2048, 0], [6610 / 2, -13613 / 2, 7003 / 2], [17933, -17390, -543]]) / 4096

    def itp(xyz):
        power = (to_lms @ to_2020 @ xyz / 10000) ** (2610 / 16384)
        return to_itp @ ((3424 / 4096 + 2413 / 128 * power) / (1 + 2392 / 128 * power)) ** (2523 / 32)

    return 720 * np.linalg.norm(itp(first) - itp(second))


class Difference(unittest.TestCase):
    def test_ciede2000_gives_the_published_pairs(self):
        """Sharma, Wu, Dalal 2005, table 1, pairs 1 and 17."""
        self.assertAlmostEqual(float(delta_e_lab([50, 2.6772, -79.7751], [50, 0, -82.7485])), 2.04246, places=5)
        self.assertAlmostEqual(float(delta_e_lab([50, 2.5, 0], [73, 25, -18])), 27.1492, places=4)

    def test_delta_e_itp_of_greys_is_720_steps_of_the_pq_curve(self):
        """ITU-R BT.2408: reference white of 203 cd/m2 stands at 58 % of the PQ signal, 1000 cd/m2 at 75 %, 10000 at 100 %."""
        for times, signal in ((1000 / 203, 0.75), (10000 / 203, 1.0)):
            self.assertAlmostEqual(float(delta_e_itp(WHITE_XYZ, times * WHITE_XYZ)) / 720, signal - 0.58, delta=0.01)

    def test_delta_e_itp_follows_its_definition(self):
        """ITU-R BT.2100 and BT.2124 written out: XYZ to BT.2020 to LMS to PQ to ITP, for a red and a blue."""
        first, second = np.array([0.35, 0.2, 0.05]), np.array([0.15, 0.1, 0.6])
        self.assertAlmostEqual(float(delta_e_itp(first, second)), itp_distance(203 * first, 203 * second), delta=0.02)
        self.assertTrue(np.isnan(delta_e_itp(0 * first, second)))

    def test_d65_lies_where_cie_puts_it(self):
        np.testing.assert_allclose(chromaticity(WHITE_XYZ), [0.1978, 0.4683], atol=1e-4)

    def test_chromaticity_ignores_luminance(self):
        self.assertAlmostEqual(float(duv(WHITE_XYZ, 0.01 * WHITE_XYZ)), 0)

    def test_delta_e_is_marked_above_white_and_undefined_without_light(self):
        self.assertTrue(above_white(1.1 * WHITE_XYZ, WHITE_XYZ))
        self.assertFalse(above_white(WHITE_XYZ, WHITE_XYZ))
        self.assertTrue(np.isnan(delta_e_2000(0 * WHITE_XYZ, WHITE_XYZ)))
        self.assertAlmostEqual(float(delta_e_2000(WHITE_XYZ, WHITE_XYZ)), 0)


if __name__ == "__main__":
    unittest.main()
