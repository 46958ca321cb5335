"""The judgement of two images, without the peer renderer itself."""

import unittest

import numpy as np

from etalon_validation.peers import RUNS, blocks, judge


def pair(noise=1e-4, size=(6, 8)):
    """Our block means, their error, and the peer's runs around the same truth."""
    generator = np.random.default_rng(11)
    truth = 100 * generator.uniform(0.5, 2, (*size, 3))
    ours = truth * (1 + noise * generator.standard_normal(truth.shape))
    peers = truth * (1 + noise * np.sqrt(RUNS) * generator.standard_normal((RUNS, *truth.shape)))
    return ours, noise * truth, peers


class Peers(unittest.TestCase):
    def test_images_that_differ_by_noise_pass(self):
        result = judge(*pair())
        self.assertEqual((result["verdict"], result["resolved_block_px"]), ("pass", 8))
        self.assertLess(abs(result["block_sizes"][8]["mean_square_of_scores"] - 1), 0.5)

    def test_one_wrong_block_fails(self):
        ours, error, peers = pair()
        ours[2, 3, 1] *= 1.008
        self.assertEqual(judge(ours, error, peers)["block_sizes"][8]["failed"], 1)

    def test_a_common_factor_is_not_fitted_away(self):
        ours, error, peers = pair()
        self.assertEqual(judge(ours * 106.8569 / 106.7503 * 1.006, error, peers)["verdict"], "fail")

    def test_too_much_noise_is_undecided_and_not_a_pass(self):
        self.assertEqual(judge(*pair(noise=0.05))["verdict"], "undecided")

    def test_a_difference_hidden_in_small_blocks_is_found_in_large_ones(self):
        ours, error, peers = pair(noise=5e-3, size=(32, 32))
        result = judge(1.01 * ours, error, peers)
        self.assertEqual(result["block_sizes"][8]["failed"], 0)
        self.assertEqual(result["verdict"], "fail")

    def test_a_mirrored_image_is_named(self):
        ours, error, peers = pair()
        self.assertTrue(judge(ours[:, ::-1], error, peers)["mirrored_left_right"])

    def test_blocks_are_means_and_partial_blocks_are_left_out(self):
        image = np.arange(17 * 9, dtype=float).reshape(17, 9, 1)
        self.assertEqual(blocks(image).shape, (2, 1, 1))
        self.assertAlmostEqual(float(blocks(image)[0, 0, 0]), image[:8, :8].mean())


if __name__ == "__main__":
    unittest.main()
