"""The ladder finds what was planted, and the held-out level never sees what it predicts."""

import unittest

import numpy as np

from etalon_validation.difference import SRGB_TO_XYZ
from etalon_validation.ladder import climb

from .case import COLOURS, SURFACES

LUMINANCE = SRGB_TO_XYZ[1]


def levels(render, photo, usable=None):
    """The ladder by level name."""
    usable = np.array([surface != "black" for surface in SURFACES]) if usable is None else usable
    return {level.name: level for level in climb(np.asarray(render), np.asarray(photo), LUMINANCE, SURFACES, usable)}


class Ladder(unittest.TestCase):
    def test_nothing_fitted_changes_nothing(self):
        np.testing.assert_array_equal(levels(COLOURS / 3, COLOURS)["L0"].predicted, COLOURS / 3)

    def test_a_planted_exposure_is_found(self):
        found = levels(COLOURS / 2**0.7, COLOURS)["L1"]
        self.assertAlmostEqual(found.fitted["exposure_stops"], 0.7, places=4)
        np.testing.assert_allclose(found.predicted, COLOURS, rtol=1e-9)

    def test_planted_gains_are_found(self):
        planted = np.array([1.3, 0.9, 0.5])
        found = levels(COLOURS / planted, COLOURS)["L2"]
        np.testing.assert_allclose(found.fitted["gains"], planted, rtol=1e-9)
        np.testing.assert_allclose(found.predicted, COLOURS, rtol=1e-9)

    def test_a_planted_matrix_is_found_by_regions_that_never_saw_their_surface(self):
        planted = np.array([[0.9, 0.2, 0.0], [0.1, 0.8, 0.1], [0.0, 0.3, 0.6]])
        np.testing.assert_allclose(levels(COLOURS @ np.linalg.inv(planted).T, COLOURS)["L3"].predicted, COLOURS, atol=1e-9)

    def test_a_held_out_surface_does_not_touch_its_own_matrix(self):
        generator = np.random.default_rng(3)
        render = COLOURS * generator.uniform(0.8, 1.2, COLOURS.shape)
        before = levels(render, COLOURS)["L3"].matrices
        for surface in ("red", "white", "green", "blue"):
            own = np.array(SURFACES) == surface
            photo, other = COLOURS.copy(), render.copy()
            photo[own] *= [3.0, 0.2, 1.7]
            other[own] *= [0.4, 2.0, 1.1]
            after = levels(other, photo)["L3"].matrices
            np.testing.assert_array_equal(after[own], before[own], err_msg=surface)
            self.assertGreater(np.abs(after[~own] - before[~own]).max(), 1e-3, "the others must see the change")

    def test_a_colour_that_no_other_surface_shows_keeps_the_gains(self):
        """Grey surfaces and one red one, with noise: nothing told of red, so nothing may be made up."""
        generator = np.random.default_rng(5)
        photo = np.array([[0.5, 0.5, 0.5], [0.3, 0.3, 0.3], [0.4, 0.4, 0.4], [0.2, 0.2, 0.2], [0.5, 0.05, 0.02], [0.3, 0.03, 0.01]])
        surfaces = ["wall", "wall", "floor", "floor", "red", "red"]
        render = photo * generator.uniform(0.8, 1.25, photo.shape)
        found = {level.name: level for level in climb(render, photo, LUMINANCE, surfaces, np.ones(6, bool))}["L3"]
        ratio = (found.predicted @ LUMINANCE / (photo @ LUMINANCE))[4:]
        np.testing.assert_allclose(np.log2(ratio), 0, atol=0.6)

    def test_dark_regions_do_not_steer_a_fit(self):
        photo = COLOURS.copy()
        photo[-1] = 0.009
        for name in ("L1", "L2", "L3"):
            np.testing.assert_array_equal(levels(COLOURS / 2, photo)[name].whole, levels(COLOURS / 2, COLOURS)[name].whole)


if __name__ == "__main__":
    unittest.main()
