"""What blurs a comparison is measured as it was planted: noise shared by channels, gradients, rounding, place."""

import json
import tempfile
import unittest
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from etalon_validation.calibration import UNKNOWN_PLACE_PX, placement
from etalon_validation.compare import per_pixel_shift, quantisation, shared_noise, shifts
from etalon_validation.photograph import ASSUMED_SRGB, srgb_to_linear
from etalon_validation.polygons import mask

from .world import pixels


class Compare(unittest.TestCase):
    def test_noise_that_channels_share_is_told_from_noise_that_they_do_not(self):
        generator, everywhere = np.random.default_rng(41), [np.ones((60, 60), bool)]
        common = generator.standard_normal((60, 60, 1)) * [1.0, 0.5, 0.2]
        np.testing.assert_allclose(shared_noise(common, everywhere), np.ones((1, 3, 3)), atol=1e-9)
        apart = shared_noise(generator.standard_normal((60, 60, 3)), everywhere)
        np.testing.assert_allclose(apart, np.eye(3)[None], atol=5 / np.sqrt(60 * 59))

    def test_the_luminance_error_of_a_region_is_that_of_its_pixels(self):
        """Through linear sRGB, whose matrix would blow up noise that channels did not share."""
        both = pixels(np.random.default_rng(42), render_noise=0.1)
        luminance = both.render @ both.luminance
        error = np.sqrt(np.einsum("i,nij,j->n", both.luminance, both.render_covariance, both.luminance))
        np.testing.assert_allclose(error / luminance, both.noise, rtol=0.01)
        np.testing.assert_allclose(both.noise, 0.1 / 9, rtol=0.1)

    def test_noise_of_all_channels_together_changes_no_chromaticity(self):
        both = pixels(np.random.default_rng(42), render_noise=0.1)
        relative = both.render_covariance / (both.render[:, :, None] * both.render[:, None, :])
        np.testing.assert_allclose(relative, np.broadcast_to(both.noise[:, None, None] ** 2, relative.shape), rtol=0.05)

    def test_a_ramp_changes_by_its_slope_per_pixel_of_the_photograph(self):
        rows, columns = np.mgrid[:20, :30]
        ramp = (0.3 * columns + 0.1 * rows)[..., None] * np.array([1.0, 2.0, 0.0])
        inside = np.zeros((20, 30), bool)
        inside[5:12, 8:20] = True
        expected = np.array([[[0.3, 0.6, 0.0], [0.1, 0.2, 0.0]]])
        np.testing.assert_allclose(per_pixel_shift(ramp, [inside], (1, 1)), expected, atol=1e-12)
        np.testing.assert_allclose(per_pixel_shift(ramp, [inside], (2, 2)), 2 * expected, atol=1e-12)

    def test_a_shift_is_as_large_from_the_table_as_from_a_photograph_that_looks_alike(self):
        """In linear sRGB a saturated wall has a channel below zero: nothing may be divided by it."""
        u, v = np.meshgrid(np.arange(30.0), np.arange(20.0))
        ramp = np.stack([0.2 + 0.01 * u, 0.05 + 0.002 * v, -0.003 - 0.0001 * u], axis=-1)
        corners = np.array([[4.0, 4.0], [24.0, 4.0], [24.0, 16.0], [4.0, 16.0]])
        region, table = SimpleNamespace(polygon=corners), SimpleNamespace(size=(30, 20))
        inside = mask(corners, table.size)
        photo = 0.25 * ramp[inside].mean(axis=0)[None]
        from_table, _ = shifts(table, [region], [inside], ramp, photo, None)
        from_photo, _ = shifts(table, [region], [inside], ramp, photo, SimpleNamespace(rgb=0.25 * ramp))
        np.testing.assert_allclose(from_table, from_photo, rtol=1e-9)

    def test_rounding_leaves_a_code_over_root_twelve_and_less_where_noise_dithers(self):
        photo, pixels_in = np.array([[srgb_to_linear(100 / 255)] * 3]), np.array([900])
        step = (srgb_to_linear(101 / 255) - srgb_to_linear(100 / 255)) / np.sqrt(12)
        np.testing.assert_allclose(quantisation(photo, np.zeros((1, 3)), pixels_in, ASSUMED_SRGB), step, rtol=1e-9)
        np.testing.assert_allclose(quantisation(photo, np.full((1, 3), 0.1), pixels_in, ASSUMED_SRGB), step / 10, rtol=1e-9)
        self.assertFalse(quantisation(photo, np.zeros((1, 3)), pixels_in, "linear").any())

    def test_place_is_as_uncertain_as_a_fit_of_as_many_points_leaves_it(self):
        """The mean leverage of any least-squares fit is its parameters over its observations."""
        points, names, scatter = 12, ["a", "b", "c", "d", "e", "f", "g"], 1.3
        design = np.random.default_rng(43).standard_normal((2 * points, len(names)))
        leverage = np.diag(design @ np.linalg.pinv(design)).mean()
        freedom = 2 * points - len(names)
        rms = scatter * np.sqrt(freedom / points)
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "pose.json"
            self.assertEqual(placement(path)[0], UNKNOWN_PLACE_PX)
            parameters = {name: {} for name in [*names, "horizontal_fov_deg"]}
            path.write_text(json.dumps({"points": points, "rms_px": rms, "chosen": "centred", "models": {"centred": {"parameters": parameters}}}))
            u, found, _ = placement(path)
        self.assertAlmostEqual(u, scatter * np.sqrt(leverage))
        self.assertEqual(found, freedom)


if __name__ == "__main__":
    unittest.main()
