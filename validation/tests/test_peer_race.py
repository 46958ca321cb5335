"""The session against all peers with small programs in place of renderers: kept pictures, who is left out, ratios, reports."""

import dataclasses
import json
import re
import tempfile
import types
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from etalon_validation import peer_race
from etalon_validation.converge_data import Run, Series
from etalon_validation.converge_reference import FileReference
from etalon_validation.errors import InputError
from etalon_validation.peer_agreement import AGREES, DIFFERS
from etalon_validation.peer_converged import RUNS, Converged, converged, most_efficient
from etalon_validation.peer_driver import DRIVERS, Ready
from etalon_validation.peer_race import EXPORT, OURS, judge, race, ready_peers
from etalon_validation.peer_race_report import lines, write_all
from etalon_validation.peer_ratios import headline, ratios
from etalon_validation.peer_runs import Contestant
from etalon_validation.peer_session import REPEATS
from etalon_validation.peer_study import rendering_only

from .convergence import SIZE, series, truth
from .peer_files import write_exr

ROOT = Path(__file__).parents[2]
SILENT = {"say": lambda _: None}


class Made(unittest.TestCase):
    """A folder, and contestants that copy pictures of known noise."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.generator = np.random.default_rng(23)

    def contestant(self, name, noise=0.1, is_foreign=False, sample_s=1e-3, fails_at=None, scale=1.0):
        """`noise` is the relative deviation of one sample, `sample_s` the CPU seconds that it tells of one, `fails_at` a seed."""

        def words(spp, seed, output, times):
            source = self.folder / f"{name.replace(' ', '-')}-{seed}.exr"
            picture = scale * truth() * (1 + noise / np.sqrt(spp) * self.generator.standard_normal(SIZE))
            write_exr(source, {"Y": picture}, whiteLuminance=1.0)
            told = json.dumps({"render": {"cpu_s": sample_s * spp, "wall_s": sample_s * spp}})
            end = "echo 'error: out of luck' >&2; exit 2" if seed == fails_at else f"cp '{source}' '{output}'; echo '{told}' > '{times}'"
            return ["sh", "-c", f"echo '{name}' >> '{self.folder}/order'; {end}"]

        return Contestant(name, words, lambda report: report, is_foreign=is_foreign)

    @property
    def started(self):
        """Processes so far."""
        order = self.folder / "order"
        return len(order.read_text(encoding="utf-8").split("\n")) - 1 if order.exists() else 0


class Kept(Made):
    def make(self, key=None, budget_s=0.32):
        before = self.started
        made = converged("other", [self.contestant("other")], self.folder / "references", key or {"scene": "a"}, budget_s, 2, **SILENT)
        return made, self.started - before

    def test_a_picture_is_kept_for_what_made_it_and_for_nothing_else(self):
        made, runs = self.make()
        self.assertEqual(runs, 1 + RUNS)
        # 0.32 s on 2 threads, 16 runs, 1 ms a sample.
        self.assertEqual((made.facts["spp"], made.runs.shape), (40, (RUNS, *SIZE)))
        again, runs = self.make()
        self.assertEqual(runs, 0)
        np.testing.assert_array_equal(again.runs, made.runs)
        self.assertEqual(self.make(budget_s=0.2)[1], 0)
        self.assertEqual(self.make(key={"scene": "b"})[1], 1 + RUNS)
        self.assertEqual(self.make(key={"scene": "b"}, budget_s=0.5)[1], 1 + RUNS)

    def test_files_that_were_touched_are_made_again(self):
        self.make()
        for kind in ("exr", "npz", "json"):
            file = self.folder / "references" / f"other.{kind}"
            file.write_bytes(file.read_bytes()[:-9])
            self.assertEqual(self.make()[1], 1 + RUNS, kind)

    def test_every_module_that_makes_a_peers_order_is_part_of_its_key(self):
        """What a peer's modules import, and what those import, but what finds and starts the renderer."""
        here = Path(peer_race.__file__).parent
        others = {"driver", "environment", "llvm"}
        for name in DRIVERS:
            own = {file.stem.removeprefix("peer_") for file in here.glob(f"peer_{name}*.py")}
            reached, pending = set(), sorted(own)
            while pending:
                part = pending.pop()
                reached.add(part)
                found = re.findall(r"^ *from \.peer_(\w+) import", (here / f"peer_{part}.py").read_text(encoding="utf-8"), re.MULTILINE)
                pending += sorted(set(found) - reached - others - set(pending))
            self.assertGreater(len(reached), len(own), name)
            self.assertLessEqual(reached - own, set(EXPORT), name)

    def test_its_noise_is_the_scatter_of_its_runs(self):
        made, _ = self.make()
        # Each pixel has 16 runs of 40 samples; chi squared of 15 x 1600 degrees, five standard deviations.
        expected, freedom = 0.1**2 / 40 / RUNS, (RUNS - 1) * truth().size
        self.assertLess(abs(np.mean(made.reference.variance / truth() ** 2) / expected - 1), 5 * np.sqrt(2 / freedom))

    def test_the_most_efficient_of_several_makes_it(self):
        quiet, quick = (self.contestant(name) for name in ("quiet", "quick"))
        stacks = [truth() * (1 + noise * self.generator.standard_normal((8, *SIZE))) for noise in (0.1, 0.3)]
        self.assertIs(most_efficient([(quiet, stacks[0], 1.0), (quick, stacks[1], 1.0)]), quiet)
        self.assertIs(most_efficient([(quiet, stacks[0], 1.0), (quick, stacks[1], 0.05)]), quick)


def result(generator, peers, name="made up"):
    """A `SceneResult` of made-up series: for each peer its deviation, the scale of its picture and more for `series`."""

    def picture(scale=1.0):
        runs = scale * truth() * (1 + 0.01 * generator.standard_normal((RUNS, *SIZE)))
        reference = FileReference(runs.mean(axis=0), runs.var(axis=0, ddof=1) / RUNS, "own", "")
        return Converged(runs, reference, {"integrator": "any", "spp": 1, "runs": RUNS, "cpu_s": 1.0})

    def timed(made):
        return dataclasses.replace(made, runs=tuple(dataclasses.replace(run, cpu_s=run.cpu_s + 0.5, render_cpu_s=run.cpu_s) for run in made.runs))

    every = [timed(series(generator, "etalon path", 0.5))]
    pictures, against = {OURS: picture()}, {"etalon path": OURS}
    for peer, (deviation, scale, more) in peers.items():
        made = series(generator, peer, deviation, is_foreign=True, **more)
        every.append(timed(dataclasses.replace(made, images=scale * made.images)))
        pictures[peer], against[peer] = picture(scale), peer
    return judge(name, ("nothing",), SIZE, every, against, pictures, ["a note"])


class Ratios(unittest.TestCase):
    def setUp(self):
        self.generator = np.random.default_rng(29)

    def test_twice_the_noise_is_a_ratio_of_four_in_rendering_and_whole_processes_differ(self):
        (row,) = ratios(result(self.generator, {"other path": (1.0, 1.0, {})}))
        self.assertEqual((row.verdict, row.is_trimmed), (AGREES, False))
        # 95 % interval at a fixed seed; 1600 pixels and 24 runs make it narrow.
        self.assertTrue(row.counts.low < 4 < row.counts.high, row.counts)
        self.assertLess(row.counts.high / row.counts.low, 1.2)
        self.assertEqual(row.counts, row.rendering)
        self.assertAlmostEqual(row.process.value, row.rendering.value, delta=0.05)

    def test_pilot_and_bootstrap_are_rendering_and_loading_is_not(self):
        run = Run("etalon auto", 0, 0, 9.0, render_cpu_s=4.0, pilot_cpu_s=2.0, bootstrap_cpu_s=1.0, load_cpu_s=2.0)
        made = rendering_only(Series("etalon auto", (run,), np.ones((1, *SIZE))))
        self.assertEqual(made.runs[0].cpu_s, 7.0)

    def test_a_peers_own_level_does_not_count_as_error_and_is_told(self):
        (row,) = ratios(result(self.generator, {"other path": (1.0, 1.3, {})}))
        self.assertEqual(row.verdict, DIFFERS)
        self.assertTrue(row.counts.low < 4 < row.counts.high, row.counts)

    def test_errors_of_a_few_pixels_are_trimmed_and_said(self):
        made = result(self.generator, {"other path": (1.0, 1.0, {})})
        heavy = dataclasses.replace(made.rendering[1], flags=(types.SimpleNamespace(name="heavy tail", text=""),))
        made = dataclasses.replace(made, rendering=(made.rendering[0], heavy))
        (row,) = ratios(made)
        self.assertTrue(row.is_trimmed)
        self.assertEqual(row.counts, row.rendering_trimmed)

    def test_the_headline_takes_a_peers_best_that_shows_the_same_picture(self):
        peers = {"other slow": (2.0, 1.0, {}), "other good": (1.0, 1.0, {}), "other wrong": (0.2, 1.3, {}), "third wrong": (1.0, 0.7, {})}
        rows = headline(result(self.generator, peers))
        self.assertEqual([(row.peer, row.verdict) for row in rows], [("other good", AGREES), ("third wrong", DIFFERS)])

    def test_a_series_without_a_value_by_the_measure_that_counts_is_not_picked(self):
        made = result(self.generator, {"other blank": (1.0, 1.0, {}), "other heavy": (2.0, 1.0, {})})
        blank = dataclasses.replace(made.rendering[1], efficiency_trimmed=None)
        heavy = dataclasses.replace(made.rendering[2], flags=(types.SimpleNamespace(name="heavy tail", text=""),))
        (row,) = headline(dataclasses.replace(made, rendering=(made.rendering[0], blank, heavy)))
        self.assertEqual((row.peer, row.is_trimmed), ("other heavy", True))
        self.assertGreater(row.counts.value, 1)


class Sessions(Made):
    def chosen(self, **more):
        words = {
            "folder": self.folder / "out", "spectra": ROOT / "spectra", "program": ROOT / "Cargo.toml", "resolution": SIZE, "threads": 1, "budget": 60.0,
            "integrators": "path", "cases": [ROOT / "reference" / "cornell"], "version": "0", "said": "etalon", "target": self.folder, "peers": None,
        }
        return types.SimpleNamespace(**words | more)

    def driver(self, name="other", integrators=("path", "odd", "lost")):
        """A peer whose `odd` refuses every scene and whose `lost` fails in the middle."""
        return types.SimpleNamespace(
            NAME=name, COMMAND=f"{name}-render", INTEGRATORS=integrators, REFERENCE=dict.fromkeys(integrators, ("none", "path")),
            ready=lambda target, spectra: Ready(("true",), {}, f"{name} 1", ("it is small",)), refuses=lambda integrator, scene: "it is odd" if integrator == "odd" else None,
        )

    def contestants(self):
        """Patches of what makes contestants."""
        def peer(driver, ready, integrator, *_):
            return self.contestant(f"{driver.NAME} {integrator}", 0.2, True, 0.02, fails_at=1000 + 2 if integrator == "lost" else None)

        ours = mock.patch.object(peer_race, "etalon", lambda program, scene, integrator, size, threads, name: self.contestant(name, 0.1, sample_s=0.02))
        return ours, mock.patch.object(peer_race, "peer", peer)

    def test_a_session_leaves_out_what_fails_and_writes_what_it_found(self):
        notes, chosen = [], self.chosen()
        ours, theirs = self.contestants()
        peers = [(self.driver(), self.driver().ready(None, None))]
        with ours, theirs:
            made = race(chosen, chosen.cases[0], peers, **SILENT)
        self.assertEqual([report.name for report in made.rendering], ["etalon path", "other path"])
        self.assertEqual([note.split(":")[0] for note in made.notes], ["other odd is left out", "other lost is left out"])
        self.assertIn("out of luck", made.notes[1])
        self.assertEqual({point.repeats for report in made.rendering for point in report.points}, {REPEATS})
        report = write_all(chosen, [made], peers, notes)
        (line,) = lines(report)
        self.assertIn("etalon path over other path (agrees)", line)
        told = json.loads((chosen.folder / "performance.json").read_text(encoding="utf-8"))
        (head,) = told["headline"]
        # Four by the noise; the interval is that of the report, at a fixed seed.
        self.assertTrue(head["counts"]["low"] < 4 < head["counts"]["high"], head)
        markdown = (chosen.folder / "performance.md").read_text(encoding="utf-8")
        self.assertIn("| cornell | etalon path | other path | **", markdown)
        self.assertIn("- cornell: other lost is left out", markdown)
        self.assertIn("other lost is left out", (chosen.folder / "performance.html").read_text(encoding="utf-8"))
        self.assertEqual(len((chosen.folder / "performance.csv").read_text(encoding="utf-8").splitlines()), 2)
        for kind in ("svg", "png"):
            self.assertTrue((chosen.folder / f"performance-cornell.{kind}").stat().st_size > 1000)

    def test_a_peer_that_is_not_there_is_one_line(self):
        def ready(*_):
            raise InputError("gone", "is not installed", "install it")

        gone, notes = self.driver("gone"), []
        gone.ready = ready
        with mock.patch.object(peer_race, "drivers", lambda *_: [self.driver(), gone]):
            peers = ready_peers(self.chosen(), notes)
        self.assertEqual([driver.NAME for driver, _ in peers], ["other"])
        self.assertEqual(notes, ["other: it is small", "gone is left out: gone: is not installed; install it"])

    def test_a_failure_of_our_own_ends_the_session(self):
        ours = mock.patch.object(peer_race, "etalon", lambda program, scene, integrator, size, threads, name: self.contestant(name, fails_at=999))
        with ours, self.assertRaisesRegex(InputError, "out of luck"):
            race(self.chosen(), self.chosen().cases[0], [], **SILENT)

    def test_a_budget_without_room_is_named_as_it_was_given(self):
        ours, theirs = self.contestants()
        chosen = self.chosen(budget=1e-3)
        with ours, theirs, self.assertRaisesRegex(InputError, r"--budget 0\.001: has no room"):
            race(chosen, chosen.cases[0], [], **SILENT)
        # The trial alone: no converged picture is made for a session that cannot be.
        self.assertEqual(self.started, 1)


if __name__ == "__main__":
    unittest.main()
