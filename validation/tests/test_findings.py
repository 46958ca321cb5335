"""Sentences follow the figures: each case of them is met, and says so."""

import unittest

from etalon_validation.findings import calibration_error, exposure, veil

from .world import calibration

UNDECLARED = calibration()


def level_one(stops, half=0.02):
    """Levels as the report has them, with an exposure."""
    return {"L1": {"fitted": {"exposure_stops": stops, "exposure_stops_95": [stops - half, stops + half], "exposure_factor": 2**stops}}}


def level_four(share, low, high, limit=False):
    """Levels with a glare."""
    return {"L4": {"fitted": {"glare_share": share, "glare_share_95": [low, high], "glare_at_limit": limit}}}


class Findings(unittest.TestCase):
    def test_an_exposure_is_held_against_what_was_known(self):
        for stops, known, settled, words in (
            (0.2, calibration(level=0.2), False, "within"), (0.9, calibration(level=0.2), True, "outside"), (0.9, UNDECLARED, False, "not settled"),
        ):
            found = exposure(level_one(stops), known)
            self.assertEqual(found["settled"], settled)
            self.assertIn(words, found["text"])
            self.assertIn(f"{stops:+.2f} stops", found["text"])

    def test_how_far_outside_counts_the_fit_and_the_declaration(self):
        """0.9 stops against 0.2 / ln 2 = 0.289 stops of the lamp and 0.02 / 1.96 of the fit."""
        self.assertIn("at 3.1 u", exposure(level_one(0.9), calibration(level=0.2))["text"])

    def test_the_calibration_error_says_whether_it_was_to_be_expected(self):
        self.assertTrue(calibration_error(level_one(0.2), calibration(level=0.2))["within_declared"])
        self.assertFalse(calibration_error(level_one(0.9), calibration(level=0.2))["within_declared"])
        self.assertIsNone(calibration_error(level_one(0.9), UNDECLARED)["within_declared"])

    def test_glare_is_named_only_where_it_is_shown_and_never_proven(self):
        for levels, words in (
            (level_four(0.01, -0.01, 0.03), "none is shown"), (level_four(0.05, 0.03, 0.07), "tone curve with less contrast"),
            (level_four(-0.05, -0.07, -0.03), "no glare"), (level_four(0.41, 0.3, 0.5, True), "end of its search"),
        ):
            found = veil(levels)
            self.assertIn(words, found["text"])
            self.assertFalse(found["settled"])


if __name__ == "__main__":
    unittest.main()
