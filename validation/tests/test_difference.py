"""Colour differences against published values."""

import unittest

import numpy as np

from etalon_validation.difference import WHITE_XYZ, above_white, chromaticity, delta_e_2000, delta_e_lab, duv


class Difference(unittest.TestCase):
    def test_ciede2000_gives_the_published_pairs(self):
        """Sharma, Wu, Dalal 2005, table 1, pairs 1 and 17."""
        self.assertAlmostEqual(float(delta_e_lab([50, 2.6772, -79.7751], [50, 0, -82.7485])), 2.04246, places=5)
        self.assertAlmostEqual(float(delta_e_lab([50, 2.5, 0], [73, 25, -18])), 27.1492, places=4)

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
