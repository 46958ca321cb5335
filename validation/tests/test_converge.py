"""Error against run time: measures by hand, known variances and biases, how often intervals hold, what is flagged.

Seeds are fixed. Counts over made-up studies may be off by so much that chance alone does it less than once in a
thousand (`ALPHA`); single figures are compared at five standard errors that follow from the number of pixels.
"""

import dataclasses
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
from scipy import stats

from etalon_validation.converge_analysis import analyse, point_of
from etalon_validation.converge_bias import FACTOR_ALPHA, Sample, bias_of
from etalon_validation.converge_data import Bias, Estimate, Point, Run, Score, Series, append_row, read_runs, write_rows
from etalon_validation.converge_fit import slope_of
from etalon_validation.converge_pool import pooled_reference
from etalon_validation.converge_reference import FileReference, divisor_of
from etalon_validation.converge_plot import label_of
from etalon_validation.converge_report import describe, finite, interval, verdict_of
from etalon_validation.converge_score import score
from etalon_validation.errors import InputError

from .convergence import LEAST_SPP, SIZE, reference, series, truth

ALPHA = 1e-3
STUDIES = 200
PIXELS = SIZE[0] * SIZE[1]


def flags(report):
    """Names of a report's flags."""
    return [flag.name for flag in report.flags]


class Measures(unittest.TestCase):
    def test_one_wrong_pixel_in_ten_thousand_counts_plain_and_not_trimmed(self):
        level = np.full((100, 100), 2.0)
        image = level.copy()
        image[3, 4] = 202.0
        found = score(image, level)
        self.assertAlmostEqual(found.relmse, 200.0**2 / (4 + 0.02**2) / 1e4)
        self.assertAlmostEqual(found.mse, 200.0**2 / 1e4)
        self.assertEqual((found.relmse_trimmed, found.largest_share), (0, 1))

    def test_the_trimmed_share_is_rounded_up(self):
        level = np.full((35, 35), 2.0)
        image = level.copy()
        image[:1, :2] = 50.0
        # 0.1 % of 1225 pixels are 1.225: two are left out.
        self.assertEqual(score(image, level).relmse_trimmed, 0)

    def test_even_errors_are_the_same_both_ways(self):
        level = np.full((64, 64), 5.0)
        found = score(1.1 * level, level)
        self.assertAlmostEqual(found.relmse, 0.01 / (1 + 1e-4))
        self.assertAlmostEqual(found.relmse_trimmed, found.relmse)

    def test_the_noise_of_the_reference_is_subtracted_with_the_divisor_of_its_pixel(self):
        generator = np.random.default_rng(7)
        picture, wrong = truth(), 0.2
        # As noisy as the picture that is judged: unsubtracted, the error would be twice as large.
        luminance = picture * (1 + wrong * generator.normal(size=SIZE))
        variance = (wrong * picture) ** 2
        found = [score(picture * (1 + wrong * generator.normal(size=SIZE)), luminance, variance) for _ in range(50)]
        terms = (wrong * picture) ** 2 / divisor_of(luminance)
        # (I - R)^2 has a variance of 2 (2 v)^2 at most, R being shared by all fifty.
        error = np.sqrt(8 * (terms**2).mean() / PIXELS)
        self.assertLess(abs(np.mean([each.relmse for each in found]) - terms.mean()), 5 * error)
        self.assertAlmostEqual(found[0].reference_relmse, terms.mean())

    def test_the_error_of_each_point_is_its_variance(self):
        generator = np.random.default_rng(11)
        made = series(generator, "path", 0.5)
        for against in (reference(generator, 0.05), pooled_reference([made])):
            report, = analyse([made], against)
            for point in report.points:
                expected = (0.5**2 / point.spp * truth() ** 2 / divisor_of(against.luminance)).mean()
                # Variance of the mean over six repeats of (x - r)^2 over that of x, r being the same for all.
                share = against.facts()["relative_variance"] / expected
                error = np.sqrt((2 / 6 + 4 / 6 * share + 2 * share**2) / PIXELS)
                self.assertLess(abs(point.relmse_mean / expected - 1), 5 * error, point)

    def test_no_run_is_part_of_what_it_is_judged_against(self):
        made = series(np.random.default_rng(5), "path", 0.5)
        pool = pooled_reference([made])
        changed = dataclasses.replace(made, images=np.array(made.images))
        changed.images[3] *= 100
        again = pooled_reference([changed])
        for found, expected in zip(again.against("path", 3), pool.against("path", 3)):
            np.testing.assert_allclose(found, expected)
        self.assertGreater(again.against("bdpt", 3)[0].mean(), 2 * pool.against("bdpt", 3)[0].mean())


class Pool(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(2)

    def test_the_series_that_scatters_least_is_the_reference(self):
        made = [series(self.generator, "path", 1.0), series(self.generator, "bdpt", 0.5), series(self.generator, "mlt", 2.0)]
        self.assertEqual(pooled_reference(made).series, "bdpt")

    def test_who_cannot_make_all_paths_and_who_is_foreign_is_not(self):
        made = [series(self.generator, "light", 0.1, missing=("LSE",)), series(self.generator, "peer", 0.1, is_foreign=True), series(self.generator, "mlt", 2.0)]
        self.assertEqual(pooled_reference(made).series, "mlt")

    def test_its_variance_is_that_of_its_mean(self):
        found = pooled_reference([series(self.generator, "path", 0.5)])
        samples = sum(6 * LEAST_SPP * 2**point for point in range(4))
        expected = (0.5**2 / samples * truth() ** 2 / divisor_of(found.luminance)).mean()
        # No worse than the scatter of six runs.
        self.assertLess(abs(found.facts()["relative_variance"] / expected - 1), 5 * np.sqrt(2 / (5 * PIXELS)))

    def test_pictures_without_light_or_noise_are_refused(self):
        made = series(self.generator, "path", 0.5)
        for factor, saying in ((0, "found no light"), (None, "same picture")):
            images = np.zeros_like(made.images) if factor == 0 else np.ones_like(made.images)
            with self.assertRaisesRegex(InputError, saying):
                pooled_reference([dataclasses.replace(made, images=images)])
        with self.assertRaisesRegex(InputError, "--reference"):
            pooled_reference([series(self.generator, "path", 0.5, repeats=2)])


class Traces(unittest.TestCase):
    def test_the_closed_form_is_the_mean_over_pairs(self):
        # A few directions hold most of it, so that the bound by independent pixels is not what is returned.
        sample = Sample(np.random.default_rng(59).normal(size=(7, 50)) * np.linspace(0.01, 3, 50) ** 4)
        plain = np.mean([((b - m) @ a) * ((a - m) @ b) for a, b, m in self.pairs(sample.residuals)])
        self.assertAlmostEqual(sample.trace_of_square() / plain, 1, places=9)

    @staticmethod
    def pairs(vectors):
        """Two vectors and the mean of all others."""
        for j in range(len(vectors)):
            for k in range(len(vectors)):
                if j != k:
                    yield vectors[j], vectors[k], np.delete(vectors, [j, k], axis=0).mean(axis=0)


class Intervals(unittest.TestCase):
    def count_is_as_stated(self, hits, trials, chance):
        """Whether a count is one that chance gives more often than once in a thousand."""
        low, high = stats.binom.ppf([ALPHA / 2, 1 - ALPHA / 2], trials, chance)
        self.assertTrue(low <= hits <= high, f"{hits} of {trials}, expected {chance * trials:.0f}, allowed {low:.0f} to {high:.0f}")

    def test_the_slope_of_samples_is_minus_one_and_its_interval_holds_it(self):
        generator = np.random.default_rng(17)
        held = 0
        for _ in range(1000):
            runs = [Run("path", point, repeat, 2.0**point) for point in range(5) for repeat in range(5)]
            # The error of a picture of 50 independent pixels.
            errors = [generator.chisquare(50) / 50 / run.cpu_s for run in runs]
            slope = slope_of(runs, errors, [run.cpu_s for run in runs])
            held += slope.low < -1 < slope.high
        # Drawing five repeats again is not exact: 93 to 97 % is what is stated.
        low, high = stats.binom.ppf(ALPHA / 2, 1000, 0.93), stats.binom.ppf(1 - ALPHA / 2, 1000, 0.97)
        self.assertTrue(low <= held <= high, held)

    def test_an_error_that_stays_is_a_flat_slope(self):
        generator = np.random.default_rng(4)
        runs = [Run("path", point, repeat, 2.0**point) for point in range(5) for repeat in range(5)]
        slope = slope_of(runs, [generator.chisquare(500) / 500 / run.cpu_s + 0.2 for run in runs], [run.cpu_s for run in runs])
        self.assertGreater(slope.low, -0.9)

    def test_ratios_hold_the_truth_and_biases_are_not_seen_where_none_are(self):
        generator = np.random.default_rng(23)
        ratio, mean, alarms, factor_alarms = 0, 0, 0, 0
        for _ in range(STUDIES):
            made = [series(generator, "path", 0.5, points=3), series(generator, "bdpt", 1.0, points=3)]
            found = {report.name: report for report in analyse(made, pooled_reference(made))}["bdpt"]
            ratio += found.ratio_to_best.low < 0.25 < found.ratio_to_best.high
            mean += found.bias.mean_ratio.low < 1 < found.bias.mean_ratio.high
            alarms += found.bias.is_significant
            moved = [series(generator, "path", 0.5, points=1, common=3.0), series(generator, "bdpt", 1.0, points=1, common=3.0)]
            factor_alarms += any(report.bias.is_significant for report in analyse(moved, pooled_reference(moved)) if report.bias)
        self.count_is_as_stated(ratio, STUDIES, 0.95)
        self.count_is_as_stated(mean, STUDIES, 0.95)
        self.assertEqual(alarms, 0)
        self.assertLessEqual(factor_alarms, stats.binom.ppf(1 - ALPHA, STUDIES, FACTOR_ALPHA))


class Flags(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(29)

    def test_clean_series_have_no_flags(self):
        # Each flag's false alarms are far below one in a hundred, so none is expected in twenty studies.
        for _ in range(20):
            for report in analyse([series(self.generator, "path", 0.5), series(self.generator, "bdpt", 1.0)], reference(self.generator)):
                self.assertEqual(flags(report), [])

    def test_light_that_is_missed_in_a_corner_is_a_bias_floor(self):
        made = series(self.generator, "path", 0.2)
        made.images[:, :4, :4] *= 0.5
        for against, flag in ((reference(self.generator), "bias floor"), (pooled_reference([series(self.generator, "bdpt", 0.2)]), "disagreement")):
            report, = analyse([made], against)
            self.assertIn(flag, flags(report))
            expected = (0.25 * truth() ** 2 / divisor_of(truth()))[:4, :4].sum() / PIXELS
            self.assertTrue(report.bias.squared.low < expected < report.bias.squared.high, report.bias)

    def test_who_misses_light_is_no_reference_though_it_scatters_least(self):
        path, bdpt = series(self.generator, "path", 0.3), series(self.generator, "bdpt", 0.5)
        self.assertEqual(pooled_reference([path, bdpt]).series, "path")
        path.images[:, :4, :4] *= 0.5
        against = pooled_reference([path, bdpt])
        self.assertEqual(against.series, "bdpt")
        reports = analyse([path, bdpt], against)
        for report, other in zip(reports, ("bdpt", "path")):
            text = next(flag.text for flag in report.flags if flag.name == "disagreement")
            self.assertTrue(text.startswith(f"differs from `{other}`: one of the two misses light"), text)
        said = "\n".join(describe(reports, against))
        self.assertIn("DIFFERS from bdpt", said)
        self.assertNotIn("BIASED", said)

    def test_another_renderer_that_differs_leaves_the_reference_unflagged(self):
        path, other = series(self.generator, "path", 0.3), series(self.generator, "other", 0.3, bias=0.1, is_foreign=True)
        found = analyse([path, other], pooled_reference([path, other]))
        self.assertEqual([("disagreement" in flags(report)) for report in found], [False, True])

    def test_a_reference_whose_pixels_err_together_is_no_bias(self):
        alarms, unaware, trials = 0, 0, 100
        for _ in range(trials):
            factor = 0.025 * self.generator.normal()
            whole = FileReference(truth() * (1 + factor), (0.025 * truth()) ** 2, "made up", "none", blocks=64, is_correlated=True, mean_stderr=0.025 * truth().mean())
            report, = analyse([series(self.generator, "path", 0.5)], whole)
            self.assertNotIn("reference floor", flags(report))
            alarms += report.bias.is_significant
            unaware += bias_of(series(self.generator, "path", 0.5), dataclasses.replace(whole, mean_stderr=None)).is_significant
        self.assertLessEqual(alarms, stats.binom.ppf(1 - ALPHA, trials, FACTOR_ALPHA))
        # As independent pixels the same factor is an alarm more often than not once it is above a deviation or so.
        self.assertGreater(unaware, stats.binom.ppf(1 - ALPHA, trials, FACTOR_ALPHA))

    def test_a_reference_that_cannot_be_held_to_its_errors_calls_no_bias(self):
        made = series(self.generator, "path", 0.5, bias=0.5)
        clean = reference(self.generator)
        for against, doubt in ((dataclasses.replace(clean, blocks=15), "15 blocks"), (reference(self.generator, 0.5), "too near")):
            report, = analyse([made], against)
            self.assertNotIn("bias floor", flags(report))
            self.assertGreater(report.bias.z, report.bias.limit)
            self.assertRegex("\n".join(describe([report], against)), rf"not decided \(z [0-9.]+, limit [0-9.]+; .*{doubt}\)")
        self.assertIn("bias floor", flags(analyse([made], dataclasses.replace(clean, blocks=16))[0]))

    def test_few_repeats_are_named_and_one_has_no_interval(self):
        made = [series(self.generator, "path", 0.5, repeats=5), series(self.generator, "four", 1.0, repeats=4), series(self.generator, "one", 1.0, repeats=1)]
        whole, four, one = analyse(made, reference(self.generator))
        self.assertEqual([flags(report) for report in (whole, four, one)], [[], ["few repeats"], ["few repeats"]])
        self.assertEqual((interval(one.fit.relmse), interval(one.ratio_to_best), one.bias), ("-", "-", None))
        self.assertIn("slope not known", label_of(one, "relmse"))
        self.assertLess(one.ratio_to_best.value, 1)
        # A single point of one run is enough.
        runs = [run for run in made[0].runs if run.point or not run.repeat]
        self.assertEqual(interval(slope_of(runs, [1 / run.cpu_s for run in runs], [run.cpu_s for run in runs])), "-")
        self.assertNotEqual(interval(four.fit.relmse), "-")

    def test_the_reference_itself_is_not_asked_for_bias(self):
        made = series(self.generator, "path", 0.2)
        self.assertIsNone(analyse([made], pooled_reference([made]))[0].bias)

    def test_a_noisy_reference_is_a_floor_and_one_that_tells_nothing_is_named(self):
        made = series(self.generator, "path", 0.5)
        # 0.05^2 over 0.5^2 / (4, 8, 16, 32) is 0.04, 0.08, 0.16, 0.32.
        report, = analyse([made], reference(self.generator, 0.05))
        self.assertIn("reference floor", flags(report))
        self.assertEqual([("reference floor" in point.flags) for point in report.points], [False, False, True, True])
        self.assertEqual(flags(analyse([made], reference(self.generator, 0.001, is_known=False))[0]), ["reference noise unknown"])

    def test_single_pixels_that_hold_the_error_are_a_heavy_tail(self):
        made = series(self.generator, "path", 0.1)
        for index, image in enumerate(made.images):
            image[index % 7, 11] *= 40
        self.assertIn("heavy tail", flags(analyse([made], reference(self.generator))[0]))

    def test_one_repeat_that_holds_the_error_is_a_heavy_tail(self):
        made = series(self.generator, "path", 0.1)
        made.images[2] *= 2
        self.assertIn("heavy tail", flags(analyse([made], reference(self.generator))[0]))

    def test_set_up_alone_does_not_make_a_slope_steep(self):
        made = series(self.generator, "mlt", 0.5, setup_s=1.0)
        report, = analyse([made], reference(self.generator))
        self.assertLess(report.fit.relmse.high, -1.1)
        self.assertNotIn("steep slope", flags(report))

    def test_errors_below_the_reference_are_left_out_and_named(self):
        scores = [Score(1, value, value, 0, 1, 1) for value in (-1.0, 0.5, -0.2)]
        made = Series("path", tuple(Run("path", 0, repeat, 1.0) for repeat in range(3)), np.zeros((3, 2, 2)))
        point = point_of(made, scores, 0)
        self.assertIsNone(point.efficiency)
        self.assertIn("error not above zero", point.flags)


class Words(unittest.TestCase):
    def test_an_interval_without_zero_is_not_called_unbiased(self):
        none, some = Estimate(0.0, -1.0, 1.0), Estimate(2.0, 1.0, 3.0)
        level, moved = Estimate(1.0, 0.9, 1.1), Estimate(1.2, 1.1, 1.3)
        file = reference(np.random.default_rng(1))
        for squared, ratio, is_significant, words in (
            (none, level, False, "no bias seen"), (some, level, False, "not decided (z 3.0, limit 7.4)"), (none, moved, False, "not decided (z 3.0, limit 7.4)"), (some, moved, True, "BIASED"),
        ):
            self.assertEqual(verdict_of(Bias(squared, 0.0, 3.0, 7.4, ratio, is_significant), file), words)

    def test_a_slope_of_which_nothing_is_known_is_not_a_number(self):
        generator = np.random.default_rng(53)
        made = series(generator, "path", 0.1)
        # A bright pixel in one repeat of the largest budget: drawn sets without it have another slope altogether.
        made.images[-1, 5, 5] *= 1000
        report, = analyse([made], reference(generator))
        self.assertEqual(interval(report.fit.relmse), "-")
        self.assertIn("slope not known", label_of(report, "relmse"))
        self.assertIn("heavy tail", flags(report))
        self.assertIn("slope -", label_of(report, "trimmed"))


class Files(unittest.TestCase):
    def test_runs_come_back_from_their_table(self):
        runs = [Run("path", 0, 1, 0.25, 0.5, 16, 3, "path", load_cpu_s=0.125, file="a.npy"), Run("peer", 2, 0, 1.5)]
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "runs.csv"
            write_rows(file, Run, runs[:1])
            append_row(file, runs[1])
            self.assertEqual(read_runs(file), runs)
            file.write_text(file.read_text().replace("1.5", "long"))
            with self.assertRaisesRegex(InputError, "runs.csv:3"):
                read_runs(file)

    def test_a_report_is_json_and_a_point_a_line(self):
        generator = np.random.default_rng(31)
        report, = analyse([series(generator, "path", 0.5)], reference(generator, 0.001, is_known=False))
        told = finite(dataclasses.asdict(report))
        self.assertEqual(json.loads(json.dumps(told, allow_nan=False)), json.loads(json.dumps(told)))
        with tempfile.TemporaryDirectory() as folder:
            write_rows(Path(folder) / "converge.csv", Point, report.points)
            self.assertEqual(len((Path(folder) / "converge.csv").read_text().splitlines()), 1 + len(report.points))


if __name__ == "__main__":
    unittest.main()
