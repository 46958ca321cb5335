"""The session in turns and the trial of libraries, with small programs in place of the renderers."""

import dataclasses
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.converge_analysis import analyse
from etalon_validation.converge_reference import FileReference
from etalon_validation.errors import InputError
from etalon_validation.peer_llvm import LIBRARY, candidates, usable
from etalon_validation.peer_mitsuba import MOST_LANES, passes
from etalon_validation.peer_runs import Contestant, etalon_stages
from etalon_validation.peer_series import PeerOption, load_peer, settle_peer
from etalon_validation.peer_session import POINTS, REPEATS, Cost, Schedule, cost_of, rounds, schedule, series_of, write_peer
from etalon_validation.peer_study import Judged, compared

from .peer_files import SIZE, noisy, truth, write_exr


class Schedules(unittest.TestCase):
    COSTS = {"path": Cost(0.1, 0.03), "mitsuba scalar": Cost(0.6, 0.05)}

    def test_budgets_double_and_give_all_about_the_same_seconds(self):
        plan = schedule(self.COSTS, 200, 2, None)
        self.assertEqual({len(spp) for spp in plan.spp.values()}, {POINTS})
        for spp in plan.spp.values():
            self.assertEqual({later / earlier for earlier, later in zip(spp, spp[1:])}, {2.0})
        seconds = [plan.spp[name][0] * cost.cpu_s_per_spp for name, cost in self.COSTS.items()]
        self.assertLess(abs(seconds[0] - seconds[1]), max(cost.cpu_s_per_spp for cost in self.COSTS.values()))

    def test_what_is_expected_is_the_sum_over_all_runs_and_within_the_budget(self):
        for budget in (25, 60, 200, 1000):
            plan = schedule(self.COSTS, budget, 2, None)
            by_hand = sum(REPEATS * (cost.load_s + spp * cost.cpu_s_per_spp / 2) for name, cost in self.COSTS.items() for spp in plan.spp[name])
            self.assertAlmostEqual(plan.expected_s, by_hand)
            self.assertLessEqual(plan.expected_s, budget)

    def test_a_slow_series_may_begin_later_and_the_others_keep_their_points(self):
        costs = self.COSTS | {"slow": Cost(0.1, 3.0)}
        with self.assertRaisesRegex(InputError, "has no room"):
            schedule(costs, 100, 2, None)
        plan = schedule(costs, 100, 2, None, slack=8)
        self.assertEqual(plan.spp["slow"][:3], (1, 2, 4))
        seconds = plan.spp["path"][0] * 0.03
        self.assertTrue(3.0 / 8 <= seconds < 3.0, seconds)

    def test_the_reference_bounds_the_last_point(self):
        self.assertLessEqual(schedule(self.COSTS, 1000, 2, 64).spp["path"][-1], 64)

    def test_a_budget_without_room_says_what_would_do(self):
        with self.assertRaises(InputError) as caught:
            schedule(self.COSTS, 5, 2, None)
        self.assertIn("--budget 5: has no room", str(caught.exception))
        least = int(str(caught.exception).split("give at least ")[1].split(" s")[0])
        self.assertEqual(len(schedule(self.COSTS, least, 2, None).spp["path"]), 3)
        with self.assertRaises(InputError) as caught:
            schedule(self.COSTS, 1000, 2, 1)
        self.assertIn("samples per pixel as --spp", str(caught.exception))


class Rounds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def contestant(self, name, noise, is_foreign=False):
        """A program that hands out pictures with known noise, and notes who ran when."""
        generator = np.random.default_rng(len(name))

        def words(spp, seed, output, times):
            source = self.folder / f"{name}-{seed}.exr"
            write_exr(source, {"Y": noisy(generator, noise / np.sqrt(spp))}, whiteLuminance=1.0)
            told = json.dumps({"render": {"cpu_s": 1e-5, "wall_s": 1e-5}})
            return ["sh", "-c", f"echo '{name}' >> '{self.folder}/order'; cp '{source}' '{output}'; echo '{told}' > '{times}'"]

        return Contestant(name, words, lambda report: report, is_foreign=is_foreign)

    def test_series_take_turns_with_seeds_of_their_own_and_the_table_is_read_as_a_peers(self):
        both = [self.contestant("a", 0.2), self.contestant("other", 0.4, is_foreign=True)]
        plan = Schedule({"a": (4, 8, 16), "other": (4, 8, 16)}, 0.0)
        runs = rounds(both, plan, self.folder / "out", taken_seed=1003, say=lambda _: None)
        order = (self.folder / "order").read_text(encoding="utf-8").split()
        self.assertEqual(len(order), 2 * 3 * REPEATS)
        for first, second in zip(order[::2], order[1::2]):
            self.assertEqual({first, second}, {"a", "other"})
        self.assertEqual(set(order[::2]), {"a", "other"})
        self.assertEqual(len({run.seed for run in runs["a"]} - {1003}), 3 * REPEATS)
        self.assertEqual([(run.point, run.repeat) for run in runs["a"]], [(point, repeat) for point in range(3) for repeat in range(REPEATS)])
        for run in runs["a"]:
            self.assertAlmostEqual(run.load_cpu_s + run.render_cpu_s, max(run.cpu_s, run.render_cpu_s))
        self.compare(runs)

    def compare(self, runs):
        # The seconds of a shell are too small to be told; those of a renderer are put in their place.
        runs = {name: tuple(dataclasses.replace(run, cpu_s=2.0 + run.spp, render_cpu_s=float(run.spp), load_cpu_s=2.0, wall_s=3.0, load_wall_s=1.0, render_wall_s=2.0) for run in found) for name, found in runs.items()}
        write_exr(self.folder / "own.exr", {"Y": truth(), "stderr.Y": np.zeros(SIZE)}, whiteLuminance=1.0)
        write_peer(self.folder / "out" / "other.csv", runs["other"], self.folder / "own.exr")
        peer = settle_peer(load_peer(PeerOption("other", self.folder / "out" / "other.csv"), SIZE[::-1]), truth())
        self.assertEqual([dataclasses.replace(run, seed=None, file="") for run in runs["other"]], [dataclasses.replace(run, file="") for run in peer.series.runs])
        reference = FileReference(truth(), np.zeros(SIZE), "truth", "")
        reports = analyse([series_of("a", runs["a"]), peer.series], reference, {"other": peer.own})
        (row,) = compared(Judged(reports, reports, {"other": peer}, {}))
        # Half the noise is a quarter of the error. 95 % intervals at a fixed seed.
        found = row["process"]
        self.assertTrue(found["low"] < 4 < found["high"], found)
        self.assertLess(found["high"] / found["low"], 1.3)

    def told(self, seconds, has_setup):
        """The `Cost` of a program that tells these seconds of rendering for a number of samples."""
        def words(spp, seed, output, times):
            return ["sh", "-c", f"echo '{json.dumps({'render': {'cpu_s': seconds(spp), 'wall_s': 1.0}})}' > '{times}'"]

        return cost_of(Contestant("other", words, lambda report: report, has_setup=has_setup))

    def test_what_does_not_grow_with_samples_is_charged_once_a_run(self):
        found = self.told(lambda spp: 3.3 + 0.02 * spp, True)
        self.assertAlmostEqual(found.load_s, 3.3)
        self.assertAlmostEqual(found.cpu_s_per_spp, 0.02)
        self.assertAlmostEqual(self.told(lambda spp: 3.3 + 0.02 * spp, False).cpu_s_per_spp, 3.62 / 16)

    def test_set_up_that_hides_the_samples_leaves_them_a_bound_above_zero(self):
        found = self.told(lambda spp: 3.3 - 1e-3 * spp, True)
        self.assertTrue(0 < found.cpu_s_per_spp <= 3.3 / 128, found)

    def test_a_report_tells_its_stages_or_rendering_alone(self):
        times = {"load": {"cpu_s": 1.0, "wall_s": 2.0}, "render": {"cpu_s": 3.0, "wall_s": 4.0}}
        self.assertEqual(etalon_stages({"times": times, "cpu_seconds": 9.0}), times)
        self.assertEqual(etalon_stages({"cpu_seconds": 3.0, "seconds": 4.0}), {"render": times["render"]})

    def test_a_run_that_fails_is_told_in_one_line(self):
        broken = Contestant("other", lambda *_: ["sh", "-c", "echo 'error: no such scene' >&2; exit 2"], etalon_stages)
        with self.assertRaisesRegex(InputError, "^other: failed: no such scene; "):
            rounds([broken], Schedule({"other": (1,)}, 0.0), self.folder, say=lambda _: None)


class Libraries(unittest.TestCase):
    def command(self, output, _times):
        script = f'case "${LIBRARY}" in *19*) echo > "{output}";; *15*) kill -6 $$;; *) exit 1;; esac'
        return ["sh", "-c", script]

    def test_the_first_that_renders_is_taken(self):
        library, note = usable(self.command, {}, [Path("libLLVM-15.so"), Path("libLLVM-17.so"), Path("libLLVM-19.so")])
        self.assertEqual(library, Path("libLLVM-19.so"))
        self.assertIn("libLLVM-19.so", note)

    def test_one_that_aborts_and_one_that_is_refused_are_named(self):
        library, note = usable(self.command, {}, [Path("libLLVM-17.so"), Path("libLLVM-15.so")])
        self.assertIsNone(library)
        self.assertIn("libLLVM-17.so is refused; libLLVM-15.so aborts the process (signal 6)", note)

    def test_libraries_are_found_newest_first_and_old_ones_are_left_out(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("libLLVM-14.so.1", "libLLVM-15.so.1", "libLLVM.so.19.1", "libLLVMCore.so"):
                (Path(folder) / name).write_bytes(b"")
            (Path(folder) / "libLLVM-19.so").symlink_to("libLLVM.so.19.1")
            self.assertEqual([file.name for file in candidates([folder])], ["libLLVM.so.19.1", "libLLVM-15.so.1"])
        self.assertIn("no LLVM of version", usable(self.command, {}, [])[1])


class Passes(unittest.TestCase):
    def test_passes_hold_no_more_than_fits_and_add_up(self):
        for spp, pixels in ((1, 1), (300, 1 << 14), (256, 1 << 14), (7, MOST_LANES * 2)):
            parts = passes(spp, pixels, True)
            self.assertEqual(sum(parts), spp)
            self.assertTrue(all(part * pixels <= MOST_LANES or part == 1 for part in parts))
        self.assertEqual(passes(300, 1 << 14, False), [300])


if __name__ == "__main__":
    unittest.main()
