"""Error by the scatter of runs: known variances, known ratios, what must be noticed."""

import json
import unittest
from unittest import mock

import numpy as np

from etalon_validation import scatter
from etalon_validation.errors import InputError
from etalon_validation.scatter import BLOCKS_PER_SIDE, Runs, block_means, describe_alone, judge, repeated_renders

LUMINANCE = 2.0
REPEATS = 16


def noisy(generator, deviation, cpu_s=1.0, size=(24, 24)):
    """Runs around an even picture, with a standard deviation relative to its luminance."""
    images = LUMINANCE * (1 + deviation * generator.standard_normal((REPEATS, *size)))
    return Runs(images, np.full(REPEATS, cpu_s))


def report(one, other):
    """The judgement of two integrators."""
    return judge({"path": 8, "bdpt": 8}, {"path": one, "bdpt": other})


class Scatter(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(5)

    def test_the_variance_of_noise_is_its_error(self):
        found = report(noisy(self.generator, 0.2), noisy(self.generator, 0.1))
        for name, truth in (("path", 0.04), ("bdpt", 0.01)):
            self.assertAlmostEqual(found["integrators"][name]["plain"]["relative_mse"] / truth, 1, delta=0.05)
        self.assertTrue(found["agree"])

    def test_half_the_deviation_is_four_times_less_error_and_the_interval_holds_it(self):
        found = report(noisy(self.generator, 0.2), noisy(self.generator, 0.1))["integrators"]["bdpt"]["plain"]
        low, high = found["interval_95"]
        self.assertLess(low, 4)
        self.assertGreater(high, 4)
        self.assertLess(high / low, 1.3)

    def test_twice_the_time_halves_the_gain(self):
        found = report(noisy(self.generator, 0.2), noisy(self.generator, 0.1, cpu_s=2.0))["integrators"]
        self.assertAlmostEqual(found["bdpt"]["plain"]["times_lower_at_equal_time"], 2, delta=0.2)
        self.assertEqual(found["path"]["plain"]["times_lower_at_equal_time"], 1)

    def test_bright_single_pixels_do_not_hide_their_noise(self):
        # One pixel in a hundred holds all the light: a relative variance of 99.
        hits = self.generator.random((REPEATS, 48, 48)) < 0.01
        rare = Runs(np.where(hits, 100 * LUMINANCE, 0.0), np.ones(REPEATS))
        found = report(rare, noisy(self.generator, 0.1, size=(48, 48)))
        self.assertAlmostEqual(found["integrators"]["path"]["plain"]["relative_mse"] / 99, 1, delta=0.2)
        self.assertLess(found["reference_relative_mse"], 0.01)

    def test_a_lamp_in_view_does_not_decide_whose_mean_counts(self):
        hits = self.generator.random((REPEATS, 48, 48)) < 0.01
        rare, fine = Runs(np.where(hits, 100 * LUMINANCE, 0.0), np.ones(REPEATS)), noisy(self.generator, 0.1, size=(48, 48))
        for run in (rare, fine):
            run.images[:, 5, 5] = 1e5 * LUMINANCE * self.generator.random(REPEATS)
        found = report(rare, fine)
        # The floor grows with the mean that the lamp raises.
        floor = (0.01 * 50_000 / 48**2) ** 2
        self.assertAlmostEqual(found["integrators"]["path"]["trimmed"]["relative_mse"] * (1 + floor) / 99, 1, delta=0.3)

    def test_a_reference_that_holds_the_noise_it_judges_is_named(self):
        text = describe_alone(report(noisy(self.generator, 3), noisy(self.generator, 3)))
        self.assertIn("lower bound", text)

    def test_one_pixel_that_scatters_counts_plain_and_not_trimmed(self):
        wild = noisy(self.generator, 0.1)
        wild.images[:, 3, 4] *= 1 + 3 * self.generator.standard_normal(REPEATS)
        found = report(noisy(self.generator, 0.1), wild)["integrators"]["bdpt"]
        self.assertGreater(found["plain"]["relative_mse"], 1.2 * found["trimmed"]["relative_mse"])
        self.assertAlmostEqual(found["trimmed"]["relative_mse"] / 0.01, 1, delta=0.1)

    def test_a_bias_of_the_whole_picture_is_noticed(self):
        biased = noisy(self.generator, 0.1)
        biased.images[:] *= 1.02
        found = report(noisy(self.generator, 0.1), biased)
        self.assertGreater(found["agreement"]["bdpt"]["z_picture"], 5)
        self.assertFalse(found["agree"])
        self.assertIn("the ratios mean nothing", describe_alone(found))

    def test_light_in_the_wrong_place_is_noticed_in_blocks(self):
        moved = noisy(self.generator, 0.1)
        moved.images[:, :6, :6] *= 1.05
        moved.images[:, 6:12, :6] *= 0.95
        found = report(noisy(self.generator, 0.1), moved)
        self.assertLess(abs(found["agreement"]["bdpt"]["z_picture"]), 5)
        self.assertGreater(found["agreement"]["bdpt"]["largest_z_of_blocks"], 5)
        self.assertEqual(found["agreement"]["bdpt"]["blocks"], BLOCKS_PER_SIDE**2)
        self.assertFalse(found["agree"])

    def test_blocks_of_a_picture_that_does_not_divide_cover_it(self):
        images = np.arange(2 * 7 * 9, dtype=float).reshape(2, 7, 9)
        means = block_means(images)
        self.assertEqual(means.shape, (2, 16))
        self.assertAlmostEqual(means[1, 0], images[1, :2, :3].mean())

    def test_runs_alternate_at_equal_time_after_a_first_one_each_and_share_no_seed(self):
        asked = []

        def render(_program, _scene, integrator, spp, seed, _resolution, _folder):
            asked.append((integrator, spp, seed))
            return self.generator.random((4, 4)), spp * (2.0 if integrator == "bdpt" else 1.0)

        with mock.patch.object(scatter, "timed_render", render):
            samples, runs = repeated_renders("etalon", "scene.json", None, ["path", "bdpt"], 64, 8)
        self.assertEqual(samples, {"path": 64, "bdpt": 32})
        self.assertEqual([name for name, *_ in asked], ["path", "bdpt"] * 9)
        self.assertEqual([spp for _, spp, _ in asked[2:4]], [64, 32])
        self.assertEqual(len({seed for *_, seed in asked[2:]} | {asked[0][2]}), 17)
        self.assertEqual(runs["bdpt"].images.shape, (8, 4, 4))
        self.assertEqual(runs["bdpt"].cpu_s.tolist(), [64.0] * 8)

    def test_what_cannot_be_judged_is_refused(self):
        def render(*_):
            return np.zeros((4, 4)), 1.0

        with mock.patch.object(scatter, "timed_render", render):
            for names, repeats, saying in ((["path", "bdpt"], 7, "--repeats"), (["path"], 8, "--integrators"), (["path", "bdpt"], 8, "same picture")):
                with self.assertRaisesRegex(InputError, saying):
                    repeated_renders("etalon", "scene.json", None, names, 8, repeats)

    def test_the_report_is_json(self):
        found = report(noisy(self.generator, 0.2), noisy(self.generator, 0.1))
        self.assertEqual(json.loads(json.dumps(found, allow_nan=False)), found)


if __name__ == "__main__":
    unittest.main()
