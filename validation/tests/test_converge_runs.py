"""Which runs a study makes, and what an earlier program is compared by: a program that is made up, and true processes."""

import contextlib
import dataclasses
import io
import json
import stat
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
from scipy import stats

from etalon_validation import converge_baseline, converge_report, converge_runs, converge_study
from etalon_validation.cli import main
from etalon_validation.converge_baseline import Pairs, judge, measure
from etalon_validation.converge_data import read_runs
from etalon_validation.converge_pool import pooled_reference
from etalon_validation.converge_reference import read_reference
from etalon_validation.converge_runs import Job, Made, budgets, run_process, try_out
from etalon_validation.converge_study import Asked, finish, make_all, order, prepared, series_of
from etalon_validation.errors import InputError

from .convergence import truth
from .peer_files import write_exr

# CPU seconds of a sample per pixel, and before the first.
SECONDS = {"path": (0.01, 0.1), "bdpt": (0.03, 0.1), "mlt": (0.02, 2.0), "slow": (30.0, 0.1)}
ALPHA = 1e-3


class MadeUp:
    """Stands for the program: seconds as above, noise by the seed; remembers what it was asked for."""

    def __init__(self):
        self.asked = []

    def render(self, _program, _job, integrator, spp, seed):
        self.asked.append((integrator, spp, seed))
        each, setup = SECONDS[integrator]
        noise = np.random.default_rng(seed).normal(size=truth().shape)
        facts = {"integrator": integrator, "version": "0", "scene": "scene", "scene_hash": "a1", "times": {"render": {"cpu_s": each * spp, "wall_s": each * spp / 2}, "pilot": None}}
        return Made((truth() * (1 + noise / np.sqrt(spp))).astype(np.float32), setup + each * spp, 1.0, facts)


class Study(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.scene = self.folder / "scene.json"
        self.scene.write_text("{}")
        self.program = MadeUp()
        for module in (converge_runs, converge_study, converge_baseline):
            self.enterContext(mock.patch.object(module, "render", self.program.render))
        self.job = Job(self.scene)
        self.asked = Asked(self.scene, ("path", "bdpt", "mlt"), 4.0, 4, 5)

    def made(self, taken=()):
        """All runs, from a plan that is there or new."""
        plan = prepared(self.asked, self.job, self.folder, taken)
        return plan, make_all(self.asked, self.job, plan, self.folder, taken, lambda _: None)

    def test_trials_tell_set_up_from_samples(self):
        for name in ("path", "bdpt", "mlt"):
            speed = try_out("etalon", self.job, name, 4.0, 0)
            self.assertAlmostEqual(speed.sample_s, SECONDS[name][0])
            self.assertAlmostEqual(speed.setup_s, SECONDS[name][1])

    def test_budgets_double_up_to_the_largest_and_small_ones_are_left_out(self):
        plan = prepared(self.asked, self.job, self.folder)
        self.assertEqual(list(plan["spp"]["path"]), ["0", "1", "2", "3"])
        for name in ("path", "bdpt", "mlt"):
            spp = [plan["spp"][name][point] for point in ("0", "1", "2", "3")]
            self.assertEqual([after / before for before, after in zip(spp, spp[1:])], [2, 2, 2])
            each, setup = SECONDS[name]
            # Rounding of the smallest is doubled with it.
            self.assertLessEqual(abs(spp[-1] * each + setup - 4.0), 4 * each + 1e-9)
        speed = try_out("etalon", self.job, "slow", 4.0, 0)
        self.assertEqual(budgets(speed, 4.0, 4), {3: 2})

    def test_all_runs_are_there_in_turns_with_seeds_of_their_own(self):
        plan, made = self.made(taken=(7,))
        self.assertEqual(len(made), 3 * 4 * 5)
        self.assertEqual(len({run.seed for run in made}), len(made))
        self.assertNotIn(7, {run.seed for run in made})
        self.assertEqual([run.repeat for run in made], sorted(run.repeat for run in made))
        for repeat in range(5):
            turn = [run.series for run in made if run.repeat == repeat]
            changes = sum(before != after for before, after in zip(turn, turn[1:]))
            self.assertGreater(changes, 4, "an integrator's runs should not follow each other")
        self.assertEqual(order(plan, 5, (7,))[0].seed, made[0].seed)

    def test_stages_are_those_of_the_facts(self):
        _, made = self.made()
        run = next(run for run in made if run.series == "mlt")
        self.assertAlmostEqual(run.render_cpu_s, 0.02 * run.spp)
        self.assertAlmostEqual(run.setup_cpu_s, 2.0)
        self.assertIsNone(run.pilot_cpu_s)

    def test_a_study_that_was_broken_off_goes_on_and_another_one_starts_anew(self):
        self.made()
        file = self.folder / "runs.csv"
        file.write_text("".join(file.read_text().splitlines(keepends=True)[:31]))
        before = len(self.program.asked)
        self.made()
        self.assertEqual(len(self.program.asked) - before, 60 - 30)
        self.assertEqual(len(read_runs(file)), 60)
        self.asked = dataclasses.replace(self.asked, budget_s=3.5)
        before = len(self.program.asked)
        self.made()
        self.assertGreater(len(self.program.asked) - before, 60)

    def test_files_of_the_user_stay_and_a_folder_of_his_is_refused(self):
        (self.folder / "pictures").mkdir()
        mine = self.folder / "pictures" / "mine.npy"
        mine.write_bytes(b"mine")
        plan, made = self.made()
        self.assertEqual(len(list(mine.parent.glob("*.npy"))), 1 + len(made))
        self.asked = dataclasses.replace(self.asked, budget_s=3.5)
        _, made = self.made()
        finish(self.folder, made)
        self.assertEqual([file.name for file in mine.parent.iterdir()], ["mine.npy"])
        self.assertFalse((self.folder / "plan.json").exists())
        # Its own table is a study's.
        prepared(self.asked, self.job, self.folder)
        asked = len(self.program.asked)
        for name, content in (("runs.csv", "cpu_seconds,file\n1,a.exr\n"), ("runs.csv", ""), ("plan.json", "{}"), ("plan.json", "my plan")):
            folder = self.folder / "other"
            folder.mkdir(exist_ok=True)
            (folder / name).write_text(content)
            with self.assertRaisesRegex(InputError, f"{name}: is not the"):
                prepared(self.asked, self.job, folder)
            self.assertEqual((folder / name).read_text(), content)
            (folder / name).unlink()
        self.assertEqual(len(self.program.asked), asked)

    def test_a_list_that_names_other_files_removes_none(self):
        _, made = self.made()
        kept = self.folder / "kept.npy"
        kept.write_bytes(b"kept")
        finish(self.folder, [*made, dataclasses.replace(made[0], file="kept.npy"), dataclasses.replace(made[0], file="pictures/../kept.npy")])
        self.assertTrue(kept.exists())

    def test_what_was_measured_outlives_a_report_that_cannot_be_written(self):
        words = ["converge", str(self.scene), "--program", str(self.scene), "--integrators", "path,bdpt", "--budget", "4", "--points", "3", "--repeats", "5", "-o", str(self.folder / "out")]
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            with mock.patch.object(converge_report, "plot", side_effect=OSError(28, "No space left on device")):
                self.assertNotEqual(main(words), 0)
            asked = len(self.program.asked)
            self.assertEqual(main(words), 0, said.getvalue())
        self.assertEqual(len(self.program.asked), asked)
        self.assertTrue((self.folder / "out" / "converge.png").is_file())
        self.assertFalse((self.folder / "out" / "pictures").exists())

    def test_a_reference_of_another_scene_or_without_unit_is_refused(self):
        file, rgb = self.folder / "reference.exr", {name: truth() for name in "RGB"}
        other = self.folder / "other.json"
        other.write_text("{}")
        words = [str(self.scene), "--program", str(self.scene), "--integrators", "path", "--budget", "4", "--points", "3", "--repeats", "5", "-o", str(self.folder / "out")]

        def said(*more):
            text = io.StringIO()
            with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
                code = main(["converge", *more, *words, "--reference", str(file)])
            return code, text.getvalue()

        self.assertRegex(said()[1], "no such picture; give an EXR by any renderer")
        for channels, attributes, problem in (
            ({"Y": truth()}, {}, "does not say its unit"), (rgb, {}, "does not say its unit"), ({"Z": truth()}, {"whiteLuminance": 1.0}, "has the channels Z"),
            ({"Y": truth()}, {"etalon": json.dumps({"scene_hash": "b2"})}, r"shows another scene \(b2\) than the runs \(a1\)"),
        ):
            write_exr(file, channels, **attributes)
            code, text = said()
            self.assertEqual((code, text.count("\n")), (2, 1), text)
            self.assertRegex(text, problem)
        write_exr(file, {"Y": truth()}, etalon=json.dumps({"scene_hash": "a1", "seed": 3}))
        self.assertRegex(said(str(other))[1], "--reference: is a picture of one scene")
        self.assertEqual(said()[0], 0)
        self.assertNotIn(3, [run.seed for run in read_runs(self.folder / "out" / "runs.csv")])
        # R = G = B = 1 is 2 cd/m2: the same picture as R, G, B of half the values.
        write_exr(file, {name: truth() / 2 for name in "RGB"}, whiteLuminance=2.0)
        np.testing.assert_allclose(read_reference(file).luminance, truth(), rtol=1e-5)

    def test_runs_and_pictures_stay_together(self):
        plan, made = self.made()
        found = series_of(made, plan, self.folder)
        self.assertEqual([series.name for series in found], ["path", "bdpt", "mlt"])
        for run, image in zip(found[1].runs, found[1].images):
            noise = np.random.default_rng(run.seed).normal(size=truth().shape)
            np.testing.assert_allclose(image, truth() * (1 + noise / np.sqrt(run.spp)), rtol=1e-4)
        self.assertEqual(pooled_reference(found).series, "path")

    def test_pairs_turn_round_and_share_their_seed(self):
        seen = []

        def render(program, job, integrator, spp, seed):
            seen.append((program, seed))
            return self.program.render(program, job, integrator, spp, seed)

        with mock.patch.object(converge_baseline, "render", render):
            pairs, spp = measure("old", "new", self.job, "path", 1.0, 6)
        self.assertEqual([name for name, _ in seen], ["old", "new", "new", "old"] * 3)
        self.assertEqual([seed for _, seed in seen], [1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 6, 6])
        self.assertAlmostEqual(spp * 0.01 + 0.1, 1.0)
        found = judge(pairs, 1.1, "scene", "path", spp)
        self.assertTrue(found.is_identical)
        self.assertEqual((found.precision.low, found.precision.value, found.precision.high), (1, 1, 1))
        self.assertEqual(found.verdict, "holds")


class Baseline(unittest.TestCase):
    def pairs(self, generator, time=1.0, noise=1.0, same_noise=False, bias=1.0, count=8):
        """Pairs of runs: the new program's seconds and deviation over the old one's; both share what a pair suffers."""
        mood = np.exp(0.3 * generator.normal(size=count))
        old = generator.normal(size=(count, *truth().shape))
        new = old if same_noise else generator.normal(size=old.shape)
        seconds = [mood * factor * np.exp(0.01 * generator.normal(size=count)) for factor in (1.0, time)]
        return Pairs(truth() * (1 + 0.3 * old), bias * truth() * (1 + 0.3 * noise * new), *seconds)

    def test_ratios_hold_the_truth(self):
        generator = np.random.default_rng(37)
        held, trials = 0, 300
        for _ in range(trials):
            found = judge(self.pairs(generator, time=1.25, noise=0.8), 1.1, "scene", "path", 8).efficiency
            held += found.low < 1 / (1.25 * 0.64) < found.high
        # Eight drawn pairs: 93 to 97 % is what is stated.
        self.assertTrue(stats.binom.ppf(ALPHA / 2, trials, 0.93) <= held <= stats.binom.ppf(1 - ALPHA / 2, trials, 0.97), held)

    def test_verdicts(self):
        generator = np.random.default_rng(41)
        for more, verdict in (({}, "holds"), ({"time": 1.3}, "fell"), ({"time": 0.5}, "holds"), ({"noise": 1.2}, "fell"), ({"time": 1.1, "same_noise": True}, "undecided")):
            self.assertEqual(judge(self.pairs(generator, **more), 1.1, "scene", "path", 8).verdict, verdict, more)

    def test_the_machine_s_moods_cancel(self):
        found = judge(self.pairs(np.random.default_rng(43), same_noise=True), 1.1, "scene", "path", 8)
        # Moods of 30 %, of which 1 % in each run is not shared: Student's t of 8 pairs, at most twice the deviation expected.
        self.assertLess(found.speed.high / found.speed.low - 1, 2 * 2 * 2.37 * 0.01 * np.sqrt(2 / 8))

    def test_another_picture_is_said(self):
        generator = np.random.default_rng(47)
        self.assertTrue(judge(self.pairs(generator, bias=1.1), 1.1, "scene", "path", 8).differs)
        self.assertFalse(any(judge(self.pairs(generator), 1.1, "scene", "path", 8).differs for _ in range(50)))

    def test_what_is_no_program_is_refused_in_one_line(self):
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            (folder / "scene.json").write_text("{}")
            (folder / "converge.json").write_text(json.dumps({}))
            (folder / "plain").write_text("text")
            broken = folder / "broken"
            broken.write_text("#!/bin/sh\nexit 3\n")
            broken.chmod(broken.stat().st_mode | stat.S_IXUSR)
            (folder / "true").symlink_to("/bin/true")
            for name, problem in (("true", "is another program"), ("converge.json", "is a report and no program"), ("plain", "cannot be run"), ("nothing", "no such program"), ("broken", "does not say its version")):
                said = io.StringIO()
                with contextlib.redirect_stderr(said):
                    code = main(["converge", str(folder / "scene.json"), "--baseline", str(folder / name), "-o", str(folder / "out")])
                self.assertEqual((code, said.getvalue().count("\n")), (2, 1), said.getvalue())
                self.assertIn(problem, said.getvalue())


class Commands(unittest.TestCase):
    """`converge --baseline` with programs that are made up: the old one shows the truth, the new one what a test says."""

    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.new, self.seconds, self.wrong = 1.0, {}, None
        for name in ("old", "new", "scene.json"):
            (self.folder / name).write_text("{}")
        for module in (converge_runs, converge_baseline):
            self.enterContext(mock.patch.object(module, "render", self.render))
        self.enterContext(mock.patch.object(converge_baseline, "check_program", lambda _: None))

    def render(self, program, _job, integrator, spp, seed):
        if integrator == self.wrong:
            raise InputError("scene.json", "is wrong", "mend it")
        is_new = Path(program).name == "new"
        noise = np.random.default_rng([seed, is_new]).normal(size=truth().shape)
        picture = truth() * (1 + noise / np.sqrt(spp))
        if is_new:
            picture[:10, :10] *= self.new
        moods = np.random.default_rng([seed, is_new, 7]).normal()
        cpu_s = 0.01 * spp * np.exp(self.seconds.get(integrator, 0.001) * moods)
        return Made(picture.astype(np.float32), cpu_s, cpu_s, {})

    def converge(self, *more, integrators="path"):
        words = [str(self.folder / "scene.json"), "--program", str(self.folder / "new"), "--baseline", str(self.folder / "old"), "--integrators", integrators]
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(["converge", *words, "-o", str(self.folder / "out"), *more])
        return code, err.getvalue()

    def test_light_that_was_lost_is_a_failure_unless_it_is_allowed(self):
        self.assertEqual(self.converge(), (0, ""))
        self.new = 0.3
        code, said = self.converge()
        self.assertEqual((code, said.count("\n")), (1, 1), said)
        self.assertRegex(said, "^error: .*path: the pictures differ")
        self.assertEqual(self.converge("--allow-difference"), (0, ""))

    def test_what_is_undecided_is_named(self):
        self.seconds["bdpt"] = 1.0
        code, said = self.converge(integrators="path,bdpt")
        self.assertEqual((code, said.count("\n")), (0, 1), said)
        self.assertRegex(said, "^warning: .*bdpt: undecided")

    def test_what_was_compared_is_kept_where_the_rest_cannot_be(self):
        self.wrong = "bdpt"
        self.assertEqual(self.converge(integrators="path,bdpt")[0], 2)
        told = json.loads((self.folder / "out" / "baseline.json").read_text())
        self.assertEqual([entry["integrator"] for entry in told["comparisons"]], ["path"])

    def test_no_light_at_all_names_the_program(self):
        pairs = Pairs(np.ones((5, 4, 4)), np.zeros((5, 4, 4)), np.ones(5), np.ones(5))
        with self.assertRaisesRegex(InputError, "no light with path of the new program"):
            judge(pairs, 1.1, "scene", "path", 8)


class Process(unittest.TestCase):
    def test_seconds_are_those_of_the_process_and_what_it_waited_for(self):
        burn = "import time\nwhile time.process_time() < 0.3: pass"
        inner = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {burn!r}])"
        code, cpu_s, wall_s, _ = run_process([sys.executable, "-c", inner])
        self.assertEqual(code, 0)
        self.assertTrue(cpu_s >= 0.3 and wall_s >= 0.3)
        self.assertLess(run_process(["sleep", "0.3"])[1], 0.2)


if __name__ == "__main__":
    unittest.main()
