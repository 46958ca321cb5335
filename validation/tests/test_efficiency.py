"""Error against time: the measures by hand, the ratio at equal time."""

import unittest

import numpy as np

from etalon_validation.efficiency import Run, describe, relative_mse


class Efficiency(unittest.TestCase):
    def test_one_wrong_pixel_in_ten_thousand_counts_plain_and_not_trimmed(self):
        reference = np.full((100, 100), 2.0)
        image = reference.copy()
        image[3, 4] = 202.0
        plain, trimmed = relative_mse(image, reference)
        self.assertAlmostEqual(plain, 200.0**2 / (4 + 0.02**2) / 1e4)
        self.assertEqual(trimmed, 0)

    def test_even_errors_are_the_same_both_ways(self):
        reference = np.full((64, 64), 5.0)
        plain, trimmed = relative_mse(1.1 * reference, reference)
        self.assertAlmostEqual(plain, 0.01 / (1 + 1e-4))
        self.assertAlmostEqual(trimmed, plain)

    def test_half_the_error_in_twice_the_time_is_no_gain(self):
        runs = {"path": [Run(1.0, 0.2, 0.2)], "bdpt": [Run(2.0, 0.1, 0.05)]}
        last = describe({"path": 8, "bdpt": 8}, runs).splitlines()[-1]
        self.assertIn("2.00 times lower at equal time (plain 1.00)", last)


if __name__ == "__main__":
    unittest.main()
