"""The ladder finds what was planted, and the held-out level never sees what it predicts."""

import unittest

import numpy as np

from etalon_validation.difference import SRGB_TO_XYZ
from etalon_validation.ladder import Setting, climb, predict

from .case import COLOURS, SURFACES

LUMINANCE = SRGB_TO_XYZ[1]
BRIGHT = np.array([surface != "black" for surface in SURFACES])


def setting_of(render, photo, surfaces=SURFACES, usable=BRIGHT):
    """The setting of region means; the whole picture is these regions side by side."""
    return Setting.of(render, photo, LUMINANCE, surfaces, usable, render.mean(axis=0))


def levels(render, photo, **changes):
    """The ladder by level name."""
    render, photo = np.asarray(render), np.asarray(photo)
    return {level.name: level for level in climb(render, photo, setting_of(render, photo, **changes))}


def predictions(level, render, photo):
    """What a level predicts for each region, the photograph's luminance giving weights as it is."""
    return predict(level, render, photo, setting_of(render, photo))


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
        for level in ("L3", "L4"):
            before = predictions(level, render, COLOURS)
            for surface in ("red", "white", "green", "blue"):
                own = np.array(SURFACES) == surface
                photo = COLOURS.copy()
                photo[own] *= [3.0, 0.2, 1.7]
                after = predictions(level, render, photo)
                np.testing.assert_array_equal(after[own], before[own], err_msg=f"{level} {surface}")
                self.assertGreater(np.abs(after[~own] - before[~own]).max(), 1e-3, "the others must see the change")

    def test_the_matrix_of_a_surface_never_sees_its_own_render(self):
        before = levels(COLOURS, COLOURS)["L3"].fitted["matrices_without_surface"]
        other = COLOURS.copy()
        other[np.array(SURFACES) == "red"] *= [0.4, 2.0, 1.1]
        after = levels(other, COLOURS)["L3"].fitted["matrices_without_surface"]
        self.assertEqual(after["red"], before["red"])
        self.assertNotEqual(after["green"], before["green"])

    def test_a_planted_glare_is_found_beside_gains(self):
        gains = np.array([1.3, 0.9, 0.5])
        for share in (0.03, 0.0, 0.2):
            photo = gains * ((1 - share) * COLOURS + share * COLOURS.mean(axis=0))
            photo[-1] = 0.009
            found = levels(COLOURS, photo)["L4"]
            self.assertAlmostEqual(found.fitted["glare_share"], share, places=4)
            np.testing.assert_allclose(found.fitted["gains"], gains, rtol=1e-3)
            np.testing.assert_allclose(found.predicted[:-1], photo[:-1], rtol=1e-3)
            np.testing.assert_allclose(found.apply(COLOURS), found.predicted, rtol=1e-3)
            self.assertFalse(found.fitted["glare_at_limit"])

    def test_glare_beyond_the_search_says_so(self):
        self.assertTrue(levels(COLOURS, 0.01 * COLOURS + COLOURS.mean(axis=0))["L4"].fitted["glare_at_limit"])

    def test_every_fit_takes_draws_as_it_takes_one(self):
        generator = np.random.default_rng(8)
        render, photo = (COLOURS * generator.uniform(0.8, 1.2, (5, *COLOURS.shape)) for _ in range(2))
        setting = setting_of(COLOURS, COLOURS)
        for name in ("L0", "L1", "L2", "L3", "L4"):
            together = predict(name, render, photo, setting)
            for index in range(5):
                np.testing.assert_allclose(together[index], predict(name, render[index], photo[index], setting), rtol=1e-9)

    def test_a_colour_that_no_other_surface_shows_keeps_the_gains(self):
        """Grey surfaces and one red one, with noise: nothing told of red, so nothing may be made up."""
        generator = np.random.default_rng(5)
        photo = np.array([[0.5, 0.5, 0.5], [0.3, 0.3, 0.3], [0.4, 0.4, 0.4], [0.2, 0.2, 0.2], [0.5, 0.05, 0.02], [0.3, 0.03, 0.01]])
        surfaces = ["wall", "wall", "floor", "floor", "red", "red"]
        render = photo * generator.uniform(0.8, 1.25, photo.shape)
        found = levels(render, photo, surfaces=surfaces, usable=np.ones(6, bool))["L3"]
        ratio = (found.predicted @ LUMINANCE / (photo @ LUMINANCE))[4:]
        np.testing.assert_allclose(np.log2(ratio), 0, atol=0.6)

    def test_dark_regions_do_not_steer_a_fit(self):
        photo = COLOURS.copy()
        photo[-1] = 0.009
        for name in ("L1", "L2", "L3", "L4"):
            np.testing.assert_array_equal(levels(COLOURS / 2, photo)[name].whole, levels(COLOURS / 2, COLOURS)[name].whole)


if __name__ == "__main__":
    unittest.main()
