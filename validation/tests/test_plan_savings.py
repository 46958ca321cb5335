"""The figures of what plans save."""

import math
import unittest

from etalon_validation.plan_savings import CASES, page_of, ratio_with_interval, small_scene


class Savings(unittest.TestCase):
    def test_ratios_are_geometric_means_with_intervals_around_them(self):
        ratio, low, high = ratio_with_interval([2, 8, 2, 8, 4], [1, 2, 1, 2, 1])
        self.assertAlmostEqual(ratio, 2 ** (8 / 5))
        self.assertAlmostEqual(ratio * ratio, low * high)
        # Logarithms 1, 2, 1, 2, 2 of base two: scatter of the mean sqrt(0.3 / 5), times 2.776.
        self.assertAlmostEqual(math.log2(high / ratio), 2.776 * math.sqrt(0.3 / 5))

    def test_the_page_states_what_the_table_holds(self):
        row = ["lens", "cornell", "path", "200.4", "150.0", "1.25", "1.1", "1.4"]
        lanes = [
            dict(scene="a", integrator="path", lanes=str(n), instructions_per_sample=str(100 * n), relmse_xyz_per_sample="2")
            for n in (4, 8)
        ]
        page = page_of([row, row[:5] + ["", "", ""]], lanes, "Measured.")
        self.assertIn("| lens | cornell | path | 200 | 150 | 25.1 % | 1.250 (1.100 to 1.400) |", page)
        self.assertIn("| lens | cornell | path | 200 | 150 | 25.1 % |  |", page)
        self.assertIn("| a | path | 4 | 400 | 2 | 2.00 |", page)

    def test_every_scene_of_a_case_is_there_or_is_made(self):
        for case in CASES:
            if case.scene in ("point", "chart", "mirrors"):
                self.assertEqual(small_scene(case.scene)["name"], case.scene)


if __name__ == "__main__":
    unittest.main()
