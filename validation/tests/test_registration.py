"""Registration by edges: right ones accepted, wrong ones refused, poses refined; and the self-test at a small size."""

import contextlib
import io
import json
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy import ndimage

from etalon_validation.align import Picked, refine
from etalon_validation.cli import main
from etalon_validation.edges import Offsets, grey
from etalon_validation.misfit import LEVEL, judge_photograph, judge_tiles, fit_field
from etalon_validation.layout import REGISTRATION_PX
from etalon_validation.selftest import LIMITS, Bench, displaced, examine
from scipy import stats

from .case import record, write_exr
from .room import CORNERS, SIZE, nominal, scene, seen, write_photo, write_room


class Registration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.holder.name)
        cls.layout, cls.frame = write_room(cls.folder)
        cls.camera = nominal()
        # The photograph is lit otherwise than the render, brighter, and noisy.
        noise = 0.01 * np.random.default_rng(3).standard_normal((SIZE[1], SIZE[0], 3))
        cls.photo = 2.5 * seen(cls.layout, cls.camera, shading=0.5) + noise
        cls.render = seen(cls.layout, cls.camera)

    @classmethod
    def tearDownClass(cls):
        cls.holder.cleanup()

    def verdict(self, photo, layout=None):
        """The verdict on a photograph at a layout's camera."""
        picked = Picked(CORNERS, self.camera.project(CORNERS))
        return judge_photograph(layout or self.layout, grey(photo), grey(self.render), self.camera, picked)

    def test_the_right_photograph_is_accepted_though_its_light_differs(self):
        found = self.verdict(self.photo)
        self.assertEqual(found["verdict"], "accepted", found["reasons"])
        self.assertLess(np.abs(found["displacement_px"]["shift"]).max(), 0.1)

    def test_wrong_registrations_fail_for_the_right_reason(self):
        moved = ndimage.shift(self.photo, (0, 5, 0), order=1, mode="nearest")
        zoomed = self.layout.seen_by(replace(self.camera, focal_px=1.06 * self.camera.focal_px))
        another = np.random.default_rng(5).random((6, 8, 3))
        another = ndimage.zoom(another, (SIZE[1] / 6, SIZE[0] / 8, 1), order=0)
        for photo, layout, reason in (
            (moved, None, "displaced by 5"), (self.photo, zoomed, "displaced"), (self.photo, zoomed, "picked points"),
            (self.photo[:, ::-1], None, "mirror image"), (another, None, "visible edges are found"),
        ):
            found = self.verdict(photo, layout)
            self.assertEqual(found["verdict"], "failed")
            self.assertIn(reason, " ".join(found["reasons"]))

    def test_a_thing_that_stands_elsewhere_fails(self):
        other = scene()
        other["objects"][-1]["transform"][1]["translate"][0] += 0.35
        with tempfile.TemporaryDirectory() as folder:
            layout, _ = write_room(Path(folder))
            (Path(folder) / "scene.json").write_text(json.dumps(other))
            layout = type(layout)(Path(folder) / "layout.json")
            found = self.verdict(2.5 * seen(layout, self.camera))
        self.assertIn("is not there", " ".join(found["reasons"]))

    def test_a_right_registration_fails_as_rarely_as_stated(self):
        # Edges displaced by just the allowed distance plus their own normal deviation; each field is tested once.
        generator, trials, alarms = np.random.default_rng(11), 1000, 0
        edges = np.arange(24)
        for _ in range(trials):
            pixels = generator.random((24, 2)) * SIZE
            angles = generator.random(24) * np.pi
            normals = np.stack([np.cos(angles), np.sin(angles)], axis=1)
            offsets = normals @ [REGISTRATION_PX, 0] + 0.7 * generator.standard_normal(24)
            field, slopes = fit_field(Offsets(np.zeros((24, 3)), pixels, normals, offsets, edges))
            tiles = judge_tiles(field, pixels, slopes @ field.values - offsets, normals, pixels, SIZE)
            critical = stats.t.isf(LEVEL / len(tiles), field.freedom)
            alarms += any(tile.get("z", -np.inf) > critical for tile in tiles)
        # With a rate of LEVEL, more alarms than this happen once in a thousand runs.
        self.assertLessEqual(alarms, stats.binom.isf(1e-3, trials, LEVEL))

    def test_a_displaced_camera_is_found_again(self):
        truth = replace(self.camera, position=self.camera.position + [0.02, -0.015, 0.01])
        photo = 2.5 * seen(self.layout, truth, shading=0.3)
        picked = Picked(CORNERS, truth.project(CORNERS) + 1.5 * np.random.default_rng(2).standard_normal((len(CORNERS), 2)))
        found = refine(self.layout, self.frame, 7, picked, grey(photo), grey(self.render), self.camera, "test")
        before = np.linalg.norm(self.camera.project(CORNERS) - truth.project(CORNERS), axis=1).max()
        after = np.linalg.norm(found.camera.project(CORNERS) - truth.project(CORNERS), axis=1).max()
        self.assertGreater(before, 2)
        self.assertLess(after, 0.3)


class Scoring(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.layout, _ = write_room(self.folder)
        self.pixels = seen(self.layout, nominal())
        write_photo(self.folder / "photo.exr", self.pixels)
        self.write_render(self.pixels)

    def write_render(self, rgb):
        """A render that has the photograph's own values."""
        from etalon_validation.difference import SRGB_TO_XYZ

        xyz = rgb @ SRGB_TO_XYZ.T * record()["camera"]["saturation_luminance_cd_m2"]
        write_exr(self.folder / "out.exr", np.concatenate([xyz, 0.001 * xyz], axis=-1), ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z"], [("etalon", json.dumps(record()))])

    def run_main(self, *words):
        """Exit code, stdout and stderr."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main([*words])
        return code, out.getvalue(), err.getvalue()

    def score(self, photo, *more):
        """One scoring of a photograph of the room."""
        return self.run_main("score", "--case", str(self.folder), "--render", str(self.folder / "out.exr"), "--photo", str(self.folder / photo), "-o", str(self.folder / "report"), *more)

    def test_scoring_refuses_a_displaced_photograph_unless_forced(self):
        self.assertEqual(self.run_main("measure-regions", "--case", str(self.folder), "--photo", str(self.folder / "photo.exr"))[0], 0)
        self.assertEqual(self.score("photo.exr")[0], 0)
        write_photo(self.folder / "moved.exr", ndimage.shift(self.pixels, (0, 5, 0), order=1, mode="nearest"))
        code, _, err = self.score("moved.exr")
        self.assertEqual((code, err.count("\n")), (2, 1), err)
        self.assertIn("registration failed", err)
        code, _, err = self.score("moved.exr", "--force-registration")
        self.assertEqual(code, 0, err)
        report = json.loads((self.folder / "report" / "report.json").read_text())
        for level in report["levels"].values():
            self.assertIn("REGISTRATION FAILED", level["title"])
            self.assertEqual({row["flag"] for row in level["regions"]}, {"registration failed"})

    def test_regions_follow_the_render_own_camera(self):
        # Light falls off across the room, so that a region beside its patch shows another value.
        write_photo(self.folder / "photo.exr", seen(self.layout, nominal(), shading=0.9))
        self.assertEqual(self.run_main("measure-regions", "--case", str(self.folder), "--photo", str(self.folder / "photo.exr"))[0], 0)
        aside = [0.16, 0.8, -1.3]
        (self.folder / "scene.json").write_text(json.dumps(scene(scene()["camera"] | {"position": aside})))
        self.write_render(seen(self.layout, replace(nominal(), position=np.array(aside)), shading=0.9))
        code, _, err = self.score("photo.exr")
        self.assertEqual(code, 0, err)
        followed = json.loads((self.folder / "report" / "report.json").read_text())["levels"]["L0"]["overall"]["nrmse"]
        # Regions 6 px beside their patches are off by a few per cent in this light.
        self.assertLess(followed, 0.01)

    def test_register_writes_verdict_and_refined_pose(self):
        words = ("register", "--case", str(self.folder), "--render", str(self.folder / "out.exr"), "--photo", str(self.folder / "photo.exr"), "-o", str(self.folder / "found.json"))
        code, out, _ = self.run_main(*words)
        found = json.loads((self.folder / "found.json").read_text())
        self.assertEqual((code, found["verdict"], found["refined"]["verdict"]), (0, "accepted", "accepted"))
        self.assertLess(found["refined"]["moved_px"]["largest"], 0.2)
        self.assertIn("registration accepted", out)


class SelfTest(unittest.TestCase):
    def test_a_synthetic_photograph_is_taken_apart_and_faults_show(self):
        with tempfile.TemporaryDirectory() as folder:
            layout, frame = write_room(Path(folder))
        camera = nominal()
        truth = displaced(camera, 2.5)
        generator = np.random.default_rng(1)

        def channels(view):
            clean = 0.8 * seen(layout, view)
            return clean * (1 + 0.02 * generator.standard_normal(clean.shape))

        bench = Bench(layout, frame, CORNERS, truth, camera, channels(truth), channels(camera))
        report = examine(bench, seeds=3)
        self.assertTrue(report["pass"], json.dumps(report["seeds"] + report["planted"], indent=1))
        self.assertEqual({entry["name"] for entry in report["quantities"]}, set(LIMITS))
        self.assertTrue(all(entry["caught"] for entry in report["planted"]))


if __name__ == "__main__":
    unittest.main()
