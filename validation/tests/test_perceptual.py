"""Whole-picture figures on pictures with known answers."""

import unittest

import numpy as np

from etalon_validation.perceptual import flip, nrmse, ssim, valid_pixels, whole_picture
from etalon_validation.photograph import ASSUMED_SRGB, Photograph, linear_to_srgb, srgb_to_linear

GENERATOR = np.random.default_rng(31)
PHOTO = GENERATOR.uniform(0.1, 0.8, (24, 32, 3))


class Perceptual(unittest.TestCase):
    def test_nrmse_is_the_planted_error_over_the_mean(self):
        error = 0.05 * np.where(GENERATOR.random(PHOTO.shape) < 0.5, -1, 1)
        everywhere = np.ones(PHOTO.shape[:2], bool)
        self.assertAlmostEqual(nrmse(PHOTO + error, PHOTO, everywhere), 0.05 / PHOTO.mean(), places=12)
        self.assertIsNone(nrmse(PHOTO, PHOTO, ~everywhere))

    def test_black_clipped_infinite_and_outer_pixels_are_not_valid(self):
        photo = PHOTO.copy()
        photo[0, 0], photo[0, 1], predicted = 0.001, [0.2, 1.0, 0.2], PHOTO.copy()
        predicted[0, 2] = np.inf
        inside = np.ones(PHOTO.shape[:2], bool)
        inside[0, 3] = False
        coded = Photograph(srgb_to_linear(np.round(255 * linear_to_srgb(photo)) / 255), "photo.png", "0", ASSUMED_SRGB)
        expected = np.ones(PHOTO.shape[:2], bool)
        expected[0, :4] = False
        np.testing.assert_array_equal(valid_pixels(coded, predicted, inside), expected)

    def test_the_saturation_that_a_photograph_declares_is_believed(self):
        saturated = np.zeros(PHOTO.shape[:2], bool)
        saturated[5, 6] = True
        photograph = Photograph(PHOTO, "photo.dng", "0", "linear", saturated=saturated)
        valid = valid_pixels(photograph, PHOTO)
        self.assertEqual((valid.sum(), valid[5, 6]), (valid.size - 1, False))

    def test_equal_pictures_look_equal_and_others_less_so(self):
        other = PHOTO[::-1]
        self.assertAlmostEqual(ssim(PHOTO, PHOTO), 1)
        self.assertLess(ssim(other, PHOTO), 0.5)
        for kind in ("LDR", "HDR"):
            self.assertAlmostEqual(flip(PHOTO, PHOTO, kind), 0, places=6)
            self.assertGreater(flip(other, PHOTO, kind), 0.05)

    def test_flip_takes_the_photograph_as_reference_over_fixed_exposures(self):
        """With exposures chosen from the pictures a common factor would change nothing."""
        brighter, same = flip(2 * PHOTO, 2 * 0.9 * PHOTO, "HDR"), flip(PHOTO, 0.9 * PHOTO, "HDR")
        self.assertNotAlmostEqual(brighter, same, places=3)

    def test_without_a_photograph_there_are_none(self):
        self.assertEqual(set(whole_picture(None, None, [])), {"available", "reason"})


if __name__ == "__main__":
    unittest.main()
