"""Intervals hold the truth as often as they say, whatever blurs the figures; each coverage test fails by chance once in 1000."""

import unittest
from dataclasses import replace as replaced

import numpy as np

from etalon_validation.budget import causes, distance_intervals, drawn, interval, spread, table
from etalon_validation.fitted import parameter_intervals
from etalon_validation.ladder import climb

from .world import BRIGHT, SURFACES_OF, acceptance, calibration, pixels, region_means, setting_of

DRAWS = 400
EXPOSURE_STOPS = 0.7
NOTHING_DECLARED = calibration()


def drawn_level(both, name, known=NOTHING_DECLARED):
    """The draws of a level."""
    return spread(name, both, setting_of(both), drawn(both, causes(both, SURFACES_OF, known), DRAWS))


def ratios_95(both, name, known=NOTHING_DECLARED):
    """Intervals of the luminance ratio at a level, (n, 2)."""
    return np.exp(interval(drawn_level(both, name, known).log_ratio)).T


class Coverage(unittest.TestCase):
    def covered(self, hits, trials, what):
        """Asserts that `hits` of `trials` intervals is what 95 % leaves to chance."""
        low, high = acceptance(trials)
        self.assertTrue(low <= hits <= high, f"{what}: {hits} of {trials} intervals hold the truth, expected {low:.0f} to {high:.0f}")

    def test_noise_of_either_side_is_covered(self):
        trials, generator = 300, np.random.default_rng(11)
        for noise in ({"render_noise": 0.2}, {"photo_noise": 0.05}):
            ratio, exposure = 0, 0
            for trial in range(trials):
                both, region = pixels(generator, 2**EXPOSURE_STOPS, **noise), trial % len(BRIGHT)
                ends = ratios_95(both, "L1")[region]
                ratio += ends[0] <= 1 <= ends[1]
                low, high = parameter_intervals("L1", both, setting_of(both), causes(both, SURFACES_OF, NOTHING_DECLARED))["exposure_stops_95_budget"]
                exposure += low <= EXPOSURE_STOPS <= high
            self.covered(ratio, trials, f"luminance ratio, {noise}")
            self.covered(exposure, trials, f"exposure, {noise}")

    def test_the_interval_of_a_distance_holds_zero_where_nothing_differs(self):
        trials, generator = 150, np.random.default_rng(15)
        hits = {"duv": 0, "delta_e_2000": 0, "delta_e_itp": 0}
        for trial in range(trials):
            both, region = pixels(generator, photo_noise=0.05), trial % len(BRIGHT)
            found = distance_intervals(drawn_level(both, "L0"), both, both.render @ both.to_xyz.T)
            for key in hits:
                hits[key] += found[key][region, 0] == 0
        for key, count in hits.items():
            self.covered(count, trials, key)

    def test_a_planted_glare_of_three_percent_is_recovered_and_none_is_none(self):
        trials, generator = 150, np.random.default_rng(12)
        for planted in (0.03, 0.0):
            budget, reported, found = 0, 0, []
            for _ in range(trials):
                both = pixels(generator, 1.3, photo_noise=0.03, glare=planted)
                known = causes(both, SURFACES_OF, NOTHING_DECLARED)
                ends = parameter_intervals("L4", both, setting_of(both), known)
                budget += ends["glare_share_95_budget"][0] <= planted <= ends["glare_share_95_budget"][1]
                reported += ends["glare_share_95"][0] <= planted <= ends["glare_share_95"][1]
                found.append(climb(both.render, both.photo, setting_of(both))[-1].fitted["glare_share"])
            self.covered(budget, trials, f"glare of {planted}")
            self.assertGreaterEqual(reported, acceptance(trials)[0], "the wider of two intervals covers no less")
            error = np.std(found) / np.sqrt(trials)
            self.assertLess(error, 0.002, "the estimates scatter too much to show anything")
            self.assertLess(abs(np.mean(found) - planted), 5 * error)

    def test_every_declared_component_is_covered(self):
        """The component acts on the truth in its own words here, and the budget must allow for it: eight tests."""
        trials, u = 200, 0.08
        luminance = BRIGHT @ [0.2126, 0.7152, 0.0722]
        radius2 = np.linspace(0.2, 1, len(BRIGHT))
        for number, (pattern, act) in enumerate(ACTIONS.items()):
            generator, hits = np.random.default_rng([13, number]), 0
            for trial in range(trials):
                render, photo = act(generator, BRIGHT.copy(), u, radius2)
                both, region = region_means(render, photo, radius2), trial % len(luminance)
                low, high = ratios_95(both, "L0", calibration(**{pattern: u}))[region]
                hits += low <= 1 <= high
            self.covered(hits, trials, pattern)

    def test_rounding_and_place_are_covered(self):
        trials, generator = 300, np.random.default_rng(14)
        rounding, place = 0, 0
        gradient = 0.03 * BRIGHT[:, None] * np.array([1.0, 0.5])[None, :, None]
        for trial in range(trials):
            region = trial % len(BRIGHT)
            error = 0.01 * BRIGHT / np.sqrt(12)
            both = region_means(BRIGHT, BRIGHT + error * np.sqrt(12) * generator.uniform(-0.5, 0.5, BRIGHT.shape))
            low, high = ratios_95(replaced(both, quantisation=error), "L0")[region]
            rounding += low <= 1 <= high
            moved = 0.6 * generator.standard_normal((len(BRIGHT), 2))
            both = region_means(BRIGHT, BRIGHT + np.einsum("nk,nkc->nc", moved, gradient))
            low, high = ratios_95(replaced(both, shift=gradient), "L0", replaced(NOTHING_DECLARED, place_px=0.6))[region]
            place += low <= 1 <= high
        self.covered(rounding, trials, "rounding")
        self.covered(place, trials, "place")


def level(generator, truth, u, radius2):
    return truth * np.exp(u * generator.standard_normal()), truth


def channels(generator, truth, u, radius2):
    return truth * np.exp(u * generator.standard_normal(3)), truth


def surfaces(generator, truth, u, radius2):
    factor = {name: np.exp(u * generator.standard_normal()) for name in ("white", "red", "green", "blue")}
    return truth * np.array([factor[name] for name in SURFACES_OF])[:, None], truth


def regions(generator, truth, u, radius2):
    return truth * np.exp(u * generator.standard_normal((len(truth), 1))), truth


def vignetting(generator, truth, u, radius2):
    return truth, truth * np.exp(u * generator.standard_normal() * radius2)[:, None]


def tone(generator, truth, u, radius2):
    return truth, truth ** np.exp(u * generator.standard_normal())


def glare(generator, truth, u, radius2):
    share = u * generator.standard_normal()
    return (1 - share) * truth + share * truth.mean(axis=0), truth


def mixture(generator, truth, u, radius2):
    mean, mixed = truth.mean(axis=0), truth.copy()
    for one in range(3):
        for other in set(range(3)) - {one}:
            mixed[:, one] += u * generator.standard_normal() * truth[:, other] * mean[one] / mean[other]
    return mixed, truth


ACTIONS = {"level": level, "channels": channels, "surfaces": surfaces, "regions": regions, "vignetting": vignetting, "tone": tone, "glare": glare, "mixture": mixture}


class Table(unittest.TestCase):
    def rows(self, name, both, known):
        """The budget table of a level by component."""
        found = table(name, both, setting_of(both), causes(both, SURFACES_OF, known), np.ones(len(BRIGHT), bool))
        return {row["component"]: row for row in found}

    def test_a_level_takes_up_what_it_fits_and_no_lower_level_does(self):
        both = pixels(np.random.default_rng(3), 1.2, render_noise=0.05, photo_noise=0.02)
        known = calibration(level=0.2, channels=0.1, glare=0.02, surfaces=0.05)
        by_level = {name: self.rows(name, both, known) for name in ("L0", "L1", "L2", "L4")}
        order = ["L0", "L1", "L2", "L4"]
        for component, first in (("level", "L1"), ("channels", "L2"), ("glare", "L4")):
            for name in order:
                left = by_level[name][component]["luminance_u_largest"]
                if order.index(name) >= order.index(first):
                    self.assertLess(left, 1e-4, f"{component} at {name}")
                else:
                    self.assertGreater(left, 1e-3, f"{component} at {name}")
        for name in order:
            self.assertGreater(by_level[name]["surfaces"]["luminance_u"], 0.02, "no level takes up a surface")

    def test_a_fit_made_anew_leaves_its_own_uncertainty_in_the_budget(self):
        """One noisy region among exact ones drags L1's exposure along: its ratio moves by 7/8 of its noise, theirs by 1/8."""
        both = region_means(BRIGHT, BRIGHT)
        covariance = np.zeros((8, 3, 3))
        covariance[0] = 0.04**2 * np.outer(BRIGHT[0], BRIGHT[0])
        both = replaced(both, render_covariance=covariance)
        setting = setting_of(both)
        level = spread("L1", both, setting, drawn(both, causes(both, SURFACES_OF, NOTHING_DECLARED), 4000))
        u = np.std(level.log_ratio, axis=0)
        np.testing.assert_allclose(u[0], 0.04 * 7 / 8, rtol=0.06)
        np.testing.assert_allclose(u[1:], 0.04 / 8, rtol=0.06)

    def test_components_add_up(self):
        both = pixels(np.random.default_rng(4), render_noise=0.1, photo_noise=0.03)
        rows = self.rows("L0", both, calibration(surfaces=0.03))
        parts = [row["luminance_u"] for name, row in rows.items() if name != "all together"]
        self.assertAlmostEqual(rows["all together"]["luminance_u"], np.hypot.reduce(parts), delta=0.15 * np.hypot.reduce(parts))


if __name__ == "__main__":
    unittest.main()
