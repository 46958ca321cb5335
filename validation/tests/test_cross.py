"""Cross-prediction: planted unknowns are found on one picture and predict another."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.basis import Lamp, scenes
from etalon_validation.cross import interval, read_plan
from etalon_validation.errors import InputError
from etalon_validation.linearity import noise_exponent
from etalon_validation.unknowns import fit, nrmse

# Noise of a planted photograph, of values about 0.5.
NOISE = 0.002
REGIONS = 36


def basis_values(seed, count=900):
    """Values of three basis pictures of one coloured scene: (3, count, 3)."""
    generator = np.random.default_rng(seed)
    colours = generator.uniform(0.15, 1, (REGIONS, 3))[generator.integers(REGIONS, size=count)]
    light = np.stack([generator.uniform(0.3, 1, count), generator.uniform(0, 0.5, count), generator.uniform(0, 0.3, count)])
    return light[:, :, None] * colours


def means(basis):
    """Means over the picture, (k, 3)."""
    return basis.mean(axis=1)


def planted(basis, weights, matrix=np.eye(3), exponent=1.0, glare=0.0, seed=9):
    """A noisy photograph of basis values under known unknowns."""
    light = np.tensordot(weights, basis, axes=1)
    seen = ((1 - glare) * light + glare * light.mean(axis=0)) @ np.asarray(matrix).T
    return seen**exponent + NOISE * np.random.default_rng(seed).standard_normal(seen.shape)


class Unknowns(unittest.TestCase):
    """Over twelve seeds of the noise the found numbers scatter by 0.0011 at most: tolerances are nine times that or more."""

    def test_a_lamp_profile_gains_glare_and_a_tone_curve_are_found(self):
        basis = basis_values(1)
        photo = planted(basis, (0.7, -0.2, 0.4), np.diag([0.8, 1, 1.2]), 0.6, 0.1)
        model = fit(("gains", "glare", "tone", "lamp"), basis, photo, REGIONS, means(basis))
        np.testing.assert_allclose(model.weights, (0.7, -0.2, 0.4), atol=0.01)
        np.testing.assert_allclose(np.diag(model.matrix), (0.8, 1, 1.2), atol=0.01)
        self.assertAlmostEqual(model.exponent, 0.6, delta=0.01)
        self.assertAlmostEqual(model.glare, 0.1, delta=0.01)

    def test_what_is_fitted_on_one_predicts_the_other_down_to_its_noise(self):
        first, second = basis_values(1), basis_values(2)
        unknown = {"weights": (0.7, -0.2, 0.4), "exponent": 0.6}
        model = fit(("tone", "lamp"), first, planted(first, **unknown), REGIONS, means(first))
        photo = planted(second, **unknown, seed=10)
        self.assertLess(nrmse(model.predict(second, means(second)), photo), 1.1 * NOISE / photo.mean())
        without = fit(("lamp",), first, planted(first, **unknown), REGIONS, means(first))
        self.assertGreater(nrmse(without.predict(second, means(second)), photo), 5 * NOISE / photo.mean())

    def test_colours_that_were_not_seen_keep_the_gains(self):
        grey = basis_values(1).mean(axis=2, keepdims=True) * np.ones(3)
        model = fit(("matrix",), grey[:1], planted(grey[:1], (1.0,), np.diag([0.5, 1, 0.8])), REGIONS, means(grey[:1]))
        mixture = model.matrix / np.diag(model.matrix)[:, None]
        self.assertLess(np.abs(mixture - np.eye(3)).max(), 0.02)

    def test_colours_that_were_seen_overrule_what_is_expected(self):
        basis = basis_values(3)[:1]
        truth = np.array([[0.9, -0.2, 0.1], [-0.1, 1.0, -0.15], [0.05, -0.2, 0.8]])
        model = fit(("matrix",), basis, planted(basis, (1.0,), truth), REGIONS, means(basis))
        np.testing.assert_allclose(model.matrix, truth, atol=0.02)


class Linearity(unittest.TestCase):
    """Shot noise of linear values has exponent 0.5; raised to a power gamma, 1 - 1 / (2 gamma)."""

    def photograph(self, gamma):
        level = np.tile(np.linspace(0.15, 0.85, 400), (300, 1))[..., None] * np.ones(3)
        noisy = level ** (1 / gamma)
        noisy = noisy + 0.003 * np.sqrt(noisy) * np.random.default_rng(4).standard_normal(level.shape)
        return np.maximum(noisy, 0) ** gamma

    def test_the_exponent_tells_linear_from_encoded(self):
        inside = np.ones((300, 400), bool)
        for gamma in (1.0, 0.5):
            found = noise_exponent(self.photograph(gamma), inside)
            self.assertAlmostEqual(found["exponent"], 1 - 1 / (2 * gamma), delta=0.05)
            self.assertAlmostEqual(found["tone_exponent"], gamma, delta=0.06)

    def test_a_flat_photograph_says_nothing(self):
        flat = 0.5 + 0.01 * np.random.default_rng(4).standard_normal((100, 100, 3))
        self.assertIsNone(noise_exponent(flat, np.ones((100, 100), bool)))


class Plan(unittest.TestCase):
    def write(self, **changes):
        folder = Path(tempfile.mkdtemp())
        for name in ("cross", "a", "b"):
            (folder / name).mkdir()
        table = {"fit": "a", "predict": "b", "unknowns": [[], ["gains"]], "headline": []} | changes
        (folder / "cross" / "cross.json").write_text(json.dumps(table))
        return folder / "cross" / "cross.json"

    def test_plans_that_mean_nothing_are_refused(self):
        read_plan(self.write())
        for changes in ({"fit": "nowhere"}, {"fit": "b"}, {"unknowns": [["gain"]]}, {"headline": ["tone"]}, {"lamp": {"object": "lamp"}}, {"unknowns": 3}):
            with self.assertRaises(InputError, msg=changes):
                read_plan(self.write(**changes))

    def test_a_lamp_becomes_one_point_light_for_each_order(self):
        lamp = Lamp("lamp", (0, 0, -1), (0, 2))
        scene = {"objects": [{"name": "lamp", "shape": {"sphere": {"center": [1, 2, 3], "radius": 0.1}}, "emission": {"spectrum": "d65", "level": {"flux_lm": 1}}}, {"name": "wall"}]}
        made = scenes(scene, lamp)
        self.assertEqual([[entry["name"] for entry in variant["objects"]] for variant in made], [["wall"], ["wall"]])
        profile = made[1]["lights"][0]["point"]["distribution"]["profile"]
        self.assertEqual((profile["relative_intensity"][0], profile["relative_intensity"][-1]), (0.0, 1.0))
        with self.assertRaises(KeyError):
            scenes(scene, Lamp("bulb", (0, 0, -1), (0,)))


class Interval(unittest.TestCase):
    def test_it_holds_the_error_as_often_as_it_says(self):
        """Of 200 pictures of 100 tiles 95 % hold the truth; fewer than 88 % has a chance below 1 in 1e4 (binomial)."""
        generator = np.random.default_rng(8)
        tile = np.repeat(np.arange(100), 5)
        held = 0
        for _ in range(200):
            photo = np.ones((500, 3))
            miss = np.repeat(0.1 * generator.standard_normal(100), 5)[:, None] * np.ones(3)
            low, high = interval(photo + miss, photo, tile)
            held += low <= 0.1 <= high
        self.assertGreaterEqual(held, 176)


if __name__ == "__main__":
    unittest.main()
