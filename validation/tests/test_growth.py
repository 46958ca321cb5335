"""How cost grows: scenes of a size that can be chosen, fits of made-up costs, and one small study."""

import contextlib
import csv
import io
import json
import math
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np

from etalon_validation import growth, growth_runs
from etalon_validation.cli import main
from etalon_validation.errors import InputError
from etalon_validation.growth_data import Axis, Run, Setting
from etalon_validation.growth_fit import exponent, exponents, geometric, point_of
from etalon_validation.growth_plot import draw
from etalon_validation.growth_runs import Study, measure, samples_in, too_much
from etalon_validation.growth_scenes import FLUX_LM, HALL_M, LAMP_SHARE, PLACE_M, hall, lamps, torus, triangles_of, write_hall

PROGRAM = Path("target/release/etalon")
TOKEN = Setting("triangles", "path", 100, 100, "hall.json", (160, 90), 2)


def run(cpu_s=1.0, spp=16, load_s=0.5, peak=1 << 24, relmse=0.01):
    """A run as a report would tell it."""
    return Run(spp, 1, load_s, cpu_s, cpu_s / 2, relmse, load_s + 4 * cpu_s, peak)


class Scenes(unittest.TestCase):
    def test_a_torus_is_closed_and_faces_outward_at_any_count(self):
        for asked in (100, 1000, 20000):
            points, faces = torus(asked)
            self.assertLess(abs(math.log(len(faces) / asked)), 0.15)
            edges = {tuple(edge) for edge in np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])}
            self.assertEqual(len(edges), 3 * len(faces), "no edge is run through twice in one direction")
            self.assertEqual(edges, {(b, a) for a, b in edges}, "each edge has a face on either side")
            a, b, c = (points[faces[:, corner]] - PLACE_M for corner in range(3))
            self.assertGreater((np.cross(a, b) * c).sum(), 0.0)
            self.assertGreater(np.linalg.norm(np.cross(b - a, c - a), axis=1).min(), 0.0)

    def test_a_torus_has_one_shape_however_fine(self):
        volumes = []
        for asked in (40000, 160000):
            points, faces = torus(asked)
            a, b, c = (points[faces[:, corner]] - PLACE_M for corner in range(3))
            volumes.append((np.cross(a, b) * c).sum() / 6)
        self.assertAlmostEqual(volumes[0] / volumes[1], 1.0, places=2)

    def test_a_ply_holds_what_its_header_announces(self):
        with tempfile.TemporaryDirectory() as folder:
            file = write_hall(folder, 1, 400)
            data = (Path(folder) / "torus-400.ply").read_bytes()
            mesh = json.loads(file.read_text())["objects"][8]["shape"]["ply"]["file"]
        self.assertEqual((triangles_of(400), mesh), (400, "torus-400.ply"))
        self.assertEqual(len(data) - data.index(b"end_header\n") - 11, 200 * 12 + 400 * 13)

    def test_what_an_earlier_study_left_is_written_anew(self):
        with tempfile.TemporaryDirectory() as folder:
            made = [write_hall(folder, 2, 100), Path(folder) / "torus-100.ply"]
            fresh = [file.read_bytes() for file in made]
            for file in made:
                file.write_bytes(b"of an earlier program")
            write_hall(folder, 2, 100)
            self.assertEqual([file.read_bytes() for file in made], fresh)

    def test_lamps_share_one_area_and_one_flux(self):
        for count in (1, 10, 1000):
            made = lamps(count)
            areas = [np.linalg.norm(np.cross(*(np.array(lamp["shape"]["quad"]["vertices"])[[1, 3]] - lamp["shape"]["quad"]["vertices"][0]))) for lamp in made]
            self.assertAlmostEqual(sum(areas) / (HALL_M[0] * HALL_M[2]), LAMP_SHARE)
            self.assertAlmostEqual(sum(lamp["emission"]["level"]["flux_lm"] for lamp in made), FLUX_LM)
            corners = np.array([lamp["shape"]["quad"]["vertices"] for lamp in made])
            self.assertTrue((corners >= 0).all() and (corners <= HALL_M).all())
        self.assertEqual(len(hall(7)["objects"]), 8 + 7)


class Fits(unittest.TestCase):
    def test_the_exponent_of_a_power_is_found(self):
        x = np.array([1e2, 1e3, 1e4, 1e5])
        found = exponent(x, 3.0 * x**0.7)
        self.assertAlmostEqual(found.value, 0.7)
        self.assertAlmostEqual(found.high - found.low, 0.0, places=6)
        self.assertIsNone(exponent(x[:2], x[:2]), "a line through two points has no interval")

    def test_intervals_of_exponents_hold_the_truth(self):
        """Of 2000 noisy lines 95 % hold it, within 5 standard deviations of the count: one false alarm in a million."""
        generator, x, held = np.random.default_rng(3), np.array([1e1, 1e2, 1e3, 1e4, 1e5]), 0
        for _ in range(2000):
            found = exponent(x, x**0.5 * np.exp(generator.normal(0, 0.2, x.size)))
            held += found.low <= 0.5 <= found.high
        self.assertLess(abs(held - 1900), 5 * math.sqrt(2000 * 0.95 * 0.05))

    def test_means_are_geometric_and_single_runs_have_no_interval(self):
        found = geometric([1.0, 4.0])
        self.assertAlmostEqual(found.value, 2.0)
        self.assertAlmostEqual(found.low * found.high, 4.0)
        self.assertEqual((geometric([3.0]).low, geometric([3.0]).high), (None, None))

    def test_a_point_is_per_sample_of_a_pixel(self):
        point = point_of(TOKEN, [run(2.0), run(2.0)])
        self.assertAlmostEqual(point.cpu_s_per_sample.value, 2.0 / (16 * 160 * 90))
        self.assertAlmostEqual(point.relmse_per_sample.value, 0.16)
        self.assertIsNone(point_of(TOKEN, [run(peak=None)]).peak_bytes)

    def test_what_is_not_known_has_no_exponent(self):
        points = [point_of(replace(TOKEN, counted=count), [run(peak=None)]) for count in (1, 10, 100)]
        self.assertIsNone(exponents(points)["peak_bytes"])


class Passes(unittest.TestCase):
    def study(self, axes, budget_s=100.0, full=False, repeats=3):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        return Study(PROGRAM, Path(self.folder.name), budget_s, 2, full, repeats, axes)

    def test_points_that_cannot_fit_are_left_out_and_named(self):
        axes = (Axis("triangles", "triangles", (100, 10000, 1000000), ("path",)),)
        study = self.study(axes)
        at = lambda count: replace(TOKEN, value=count, counted=count)  # noqa: E731
        # Nothing but what is there from the start, and then 0.1 s for each ten thousand triangles.
        taken = [(at(100), [run(load_s=0.5)])]
        self.assertIsNone(too_much(study, at(10000), taken, 1e12))
        taken.append((at(10000), [run(load_s=0.6)]))
        self.assertIn("--full", too_much(study, at(1000000), taken, 1e12))
        self.assertIsNone(too_much(self.study(axes, full=True), at(1000000), taken, 1e12))
        self.assertIsNone(too_much(study, at(20000), taken, 1e12))
        for each in (study, self.study(axes, full=True)):
            self.assertIn("memory", too_much(each, at(20000), taken, 1.0))

    def failing(self, fails):
        """Runs that fail where `fails(setting, seed)` says so; how many were tried is `self.tried`."""
        self.tried = 0

        def fake(program, setting, spp, seed):
            self.tried += 1
            if fails(setting, seed):
                raise InputError(setting.scene, "out of luck", "try again")
            return run(cpu_s=1e-6 * spp * setting.pixels, spp=spp)

        return mock.patch.object(growth_runs, "render", fake)

    def test_a_point_that_fails_is_named_and_costs_no_other_its_runs(self):
        axes = (Axis("depth", "bounces", (1, 2, 4, 8), ("path",)), Axis("channels", "layers", (1, 4), ("path",)))
        kept = []

        def keep(found):
            kept.append({key: sum(len(runs) for _, runs in settings) for key, settings in found.items()})

        # Two bounces never, four the first time only.
        with self.failing(lambda setting, seed: setting.axis == "depth" and (setting.value == 2 or setting.value == 4 and seed > 1)):
            found, left_out = measure(self.study(axes), lambda line: None, keep)
        self.assertEqual([(setting.value, len(runs)) for setting, runs in found["depth", "path"]], [(1, 3), (4, 1), (8, 3)])
        self.assertEqual([len(runs) for _, runs in found["channels", "path"]], [3, 3])
        self.assertEqual(list(left_out["depth", "path"]), [2, 4])
        self.assertTrue(all("out of luck" in reason and "\n" not in reason for reason in left_out["depth", "path"].values()))
        self.assertEqual(self.tried, 6 + 2 * 4 + 1, "what failed is not tried again")
        # After each first pass, and after each run of the later ones.
        self.assertEqual(kept[:2], [{("depth", "path"): 3}, {("depth", "path"): 3, ("channels", "path"): 2}])
        self.assertEqual([sum(counts.values()) for counts in kept[2:]], list(range(6, 14)))

    def test_an_integrator_without_a_point_is_drawn_and_told(self):
        axes = (Axis("depth", "bounces", (1, 2, 4), ("path", "bdpt")),)
        with self.failing(lambda setting, seed: setting.integrator == "bdpt"):
            series = growth.series_of(axes, *measure(self.study(axes), lambda line: None))
        self.assertEqual([len(one.points) for one in series], [3, 0])
        draw(series, "caption")
        self.assertEqual(sum("out of luck" in line for line in growth.describe(series)), 3)

    def test_a_study_without_a_point_is_an_error(self):
        axes = (Axis("depth", "bounces", (1, 2), ("path",)),)
        with self.failing(lambda setting, seed: True), self.assertRaisesRegex(InputError, "out of luck"):
            measure(self.study(axes), lambda line: None)

    def test_runs_so_far_are_in_the_file_when_the_study_is_stopped(self):
        def stopped(setting, seed):
            if seed == 2:
                raise KeyboardInterrupt
            return False

        study = replace(self.study((Axis("depth", "bounces", (1, 2, 4), ("path",)),)), program=Path(__file__))
        with self.failing(stopped), self.assertRaises(KeyboardInterrupt):
            growth.run(study, lambda line: None)
        with (study.folder / "growth.csv").open() as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), self.tried - 1)
        self.assertGreaterEqual(len(rows), 3)

    def test_numbers_of_threads_above_those_of_the_study_are_named(self):
        axes = (Axis("threads", "threads", (1, 2, 4, 8), ("path",)),)
        with self.failing(lambda setting, seed: False):
            found, left_out = measure(self.study(axes), lambda line: None)
        self.assertEqual([setting.threads for setting, _ in found["threads", "path"]], [1, 2])
        self.assertEqual(list(left_out["threads", "path"]), [4, 8])
        self.assertIn("--threads", left_out["threads", "path"][4])

    def test_a_run_that_is_killed_says_by_what(self):
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "etalon"
            program.write_text("#!/bin/sh\nkill -9 $$\n")
            program.chmod(0o755)
            with self.assertRaisesRegex(InputError, "signal 9"):
                growth_runs.render(program, TOKEN, 4, 1)

    def test_every_point_is_taken_as_often_with_other_seeds_and_the_same_samples(self):
        axes = (Axis("depth", "bounces", (1, 2, 4), ("path", "bdpt")),)
        asked = []

        def fake(program, setting, spp, seed):
            asked.append((setting.integrator, setting.value, spp, seed))
            return run(cpu_s=1e-6 * spp * setting.pixels * setting.value, spp=spp)

        with mock.patch.object(growth_runs, "render", fake):
            found, left_out = measure(self.study(axes), lambda line: None)
        self.assertEqual(len(asked), 3 * 6)
        self.assertEqual(len(set(asked)), 3 * 6)
        self.assertEqual(len({entry[:3] for entry in asked}), 6, "one number of samples at each point")
        self.assertTrue(all(len(runs) == 3 for series in found.values() for _, runs in series))
        self.assertFalse(any(left_out.values()))

    def test_samples_fit_into_the_seconds(self):
        self.assertEqual(samples_in(10.0, TOKEN, 1e-6), 512)
        self.assertEqual(samples_in(1e-9, TOKEN, 1e-6), growth_runs.LEAST_SPP)

    def test_costs_that_were_made_up_come_back_as_exponents_and_are_drawn(self):
        """Set-up as the count, samples as its root: what the study must find of them."""
        axes = (Axis("triangles", "triangles", (100, 10000, 1000000), ("path",)),)

        def fake(program, setting, spp, seed):
            return run(cpu_s=1e-8 * spp * setting.pixels * math.sqrt(setting.counted), spp=spp, load_s=1e-6 * setting.counted, peak=100 * setting.counted)

        with mock.patch.object(growth_runs, "render", fake):
            series = growth.series_of(axes, *measure(self.study(axes, full=True), lambda line: None))
        self.assertAlmostEqual(series[0].exponents["cpu_s_per_sample"].value, 0.5, places=3)
        self.assertAlmostEqual(series[0].exponents["peak_bytes"].value, 1.0, places=3)
        figure = draw(series, "caption")
        legends = [axes.get_legend() for axes in figure.axes]
        self.assertTrue(any("path 0.50" in text.get_text() for legend in legends if legend for text in legend.get_texts()))


@unittest.skipUnless(PROGRAM.is_file(), "needs the program: cargo build --release")
class Command(unittest.TestCase):
    def test_a_small_study_leaves_its_files(self):
        axes = (Axis("lights", "lamps", (1, 4, 16), ("path",)), Axis("resolution", "pixels", (32, 64), ("mlt",)))
        with tempfile.TemporaryDirectory() as folder:
            study = Study(PROGRAM, Path(folder), 2.0, 1, True, 2, axes)
            series = growth.run(study, lambda line: None)
            names = {path.name for path in Path(folder).iterdir()}
            with (Path(folder) / "growth.csv").open() as file:
                rows = list(csv.DictReader(file))
            report = json.loads((Path(folder) / "growth.json").read_text())
        self.assertLessEqual({"growth.csv", "growth.json", "growth.svg", "growth.png"}, names)
        self.assertEqual(len(rows), 2 * 5)
        self.assertEqual({row["axis"] for row in rows}, {"lights", "resolution"})
        self.assertTrue(all(float(row["relmse"]) > 0 and float(row["to_error_cpu_s"]) > 0 for row in rows))
        self.assertEqual([len(one["points"]) for one in report["series"]], [3, 2])
        self.assertIsNotNone(series[0].exponents["to_error_cpu_s"])

    def test_a_wrong_budget_is_refused_in_one_line(self):
        said = io.StringIO()
        with contextlib.redirect_stderr(said):
            code = main(["growth", "-o", "nowhere", "--budget", "0"])
        self.assertEqual((code, said.getvalue().count("\n")), (2, 1))
        self.assertIn("--budget", said.getvalue())


if __name__ == "__main__":
    unittest.main()
