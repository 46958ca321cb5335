"""How an exposure is judged: planted levels, clipping and black come back, and each condition can fail alone."""

import contextlib
import io
import json
import shutil
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.cli import main
from etalon_validation.exposure import METER_STOPS, judge, metered_luminance, parts
from etalon_validation.exposure_report import anchors
from etalon_validation.page import duration
from etalon_validation.registration import scene_camera
from etalon_validation.render import Render, read_render

from .case import write_exr

CASE = Path(__file__).parents[2] / "reference" / "schoedl-2007"
SIZE = (128, 128)
# Settings of the case, and what the standards make of them: 78 N^2 / (q S t) and 12.5 N^2 / (S t).
CAMERA = {"iso": 200.0, "shutter_s": 1 / 90, "f_stop": 8.0, "exposure_constant_q": 0.65, "anchor": "saturation", "ev100": np.log2(64 * 90 / 2), "white_xyz": None}
SATURATION, METER = 78 * 64 * 90 / (0.65 * 200), 12.5 * 64 * 90 / 200
WHITE = np.array([0.9504559, 1.0, 1.0890578])


def case_parts():
    """The pixels of the case's subject and lamp."""
    scene, plan = (json.loads((CASE / name).read_text()) for name in ("scene.json", "exposure.json"))
    return parts(scene_camera(scene, "cm", SIZE), plan, scene, CASE)


def render_of(luminance, relative_error=0.02):
    """A neutral render of a luminance picture in cd/m2."""
    xyz = luminance[..., None] * WHITE
    camera = CAMERA | {"saturation_luminance_cd_m2": SATURATION, "white_luminance_cd_m2": SATURATION}
    record = {"scene": "schoedl-2007", "camera": camera, "samples_per_pixel": 16, "seconds": 10.0, "cpu_seconds": 20.0, "version": "0", "integrator": "bdpt", "seed": 0, "relative_error": 0.03}
    return Render(xyz, relative_error * xyz, None, record, "out.exr", "0" * 64)


class Judged(unittest.TestCase):
    def setUp(self):
        self.found = case_parts()
        self.luminance = np.full(SIZE[::-1], METER)
        self.luminance[self.found.lamp] = 40 * SATURATION

    def holds(self):
        """Which conditions hold, in their order: meter, clipped, black."""
        return [condition["holds"] for condition in judge(render_of(self.luminance), self.found)["conditions"]]

    def set_share(self, share, value):
        """Gives a share of the subject's pixels a luminance."""
        rows, columns = np.nonzero(self.found.subject)
        count = round(share * len(rows))
        self.luminance[rows[:count], columns[:count]] = value

    def test_what_a_meter_asks_for_is_well_exposed(self):
        figures = judge(render_of(self.luminance), self.found)
        self.assertTrue(figures["well_exposed"])
        self.assertAlmostEqual(figures["meter"]["subject_stops"], 0, places=9)
        self.assertGreater(figures["meter"]["frame_stops"], 0.3, "the lamp belongs to the frame and not to the subject")

    def test_too_bright_and_too_dark_by_more_than_the_bound(self):
        for stops, good in ((0.9, True), (1.1, False), (-0.9, True), (-1.1, False)):
            self.luminance[~self.found.lamp] = METER * 2**stops
            figures = judge(render_of(self.luminance), self.found)
            self.assertAlmostEqual(figures["meter"]["subject_stops"], stops, places=9)
            self.assertEqual(figures["well_exposed"], good, stops)
        self.assertEqual(METER_STOPS, 1.0, "the stops above stand around it")

    def test_clipping_and_black_are_counted_outside_the_lamp(self):
        self.set_share(0.005, 1.01 * SATURATION)
        self.assertEqual(self.holds(), [True, True, True])
        self.set_share(0.02, 1.01 * SATURATION)
        self.assertEqual(self.holds(), [True, False, True])
        figures = judge(render_of(self.luminance), self.found)
        self.assertAlmostEqual(figures["shares"]["subject"]["clipped"], 0.02, places=3)
        self.set_share(0.02, 0.0)
        self.assertEqual(self.holds(), [True, True, False])

    def test_noise_is_that_of_the_subject(self):
        noise = judge(render_of(self.luminance, 0.04), self.found)["noise"]
        for key in ("mean", "rms", "p01", "p50", "p99"):
            self.assertAlmostEqual(noise[key], 0.04, places=9)
        self.assertEqual((noise["below_1_percent"], noise["below_5_percent"]), (0, 1))

    def test_standards_have_their_textbook_values(self):
        sunny = {"iso": 100.0, "shutter_s": 1 / 125, "f_stop": 16.0}
        self.assertAlmostEqual(metered_luminance(sunny), 4000)
        found = anchors(sunny | {"white_luminance_cd_m2": 38400.0}, 0.65)
        self.assertAlmostEqual(found["saturation"]["stops"], 0, places=9)
        self.assertAlmostEqual(0.18 * found["sos"]["white_luminance_cd_m2"], 4923.08, places=2)

    def test_a_lens_focused_near_sees_less(self):
        scene = json.loads((CASE / "scene.json").read_text())
        near = scene_camera(scene, "cm", SIZE)
        far = scene_camera(scene | {"camera": {key: value for key, value in scene["camera"].items() if key != "focus_distance"}}, "cm", SIZE)
        # 35 mm focused at 1050 mm: the picture is 1050 / (1050 - 35) times as far behind the lens.
        self.assertAlmostEqual(near.focal_px / far.focal_px, 1050 / 1015, places=9)

    def test_times_read_as_people_write_them(self):
        self.assertEqual([duration(seconds) for seconds in (21680, 1321, 195, 4.24, None)], ["6 h 01 min 20 s", "22 min 01 s", "3 min 15 s", "4.2 s", "–"])


class Reported(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        for name in ("scene.json", "exposure.json"):
            shutil.copy(CASE / name, self.folder / name)
        luminance = np.full(SIZE[::-1], METER * 2**1.5)
        self.render = render_of(luminance)
        data = np.concatenate([self.render.xyz, self.render.stderr], axis=-1)
        write_exr(self.folder / "out.exr", data, ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z"], [("etalon", json.dumps(self.render.record))])

    def run_command(self):
        """Exit code, stdout and stderr."""
        out, err = io.StringIO(), io.StringIO()
        words = ["exposure", "--case", self.folder, "--render", self.folder / "out.exr", "--threads", 2, "-o", self.folder / "report"]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main([str(word) for word in words])
        return code, out.getvalue(), err.getvalue()

    def test_a_picture_that_is_not_well_exposed_says_so_and_by_how_much(self):
        code, out, err = self.run_command()
        self.assertEqual((code, err), (0, ""))
        self.assertIn("not well exposed: +1.50 stops", out)
        page = (self.folder / "report" / "report.html").read_text()
        self.assertIn("not well exposed", page)
        self.assertIn("6 h 01 min 20 s", page)
        report = json.loads((self.folder / "report" / "report.json").read_text())
        self.assertAlmostEqual(report["times"][0]["over_cpu_seconds"], 21680 / 20.0)
        self.assertEqual(report["paths"], 16 * SIZE[0] * SIZE[1])
        self.assertEqual(read_render(self.folder / "out.exr").sha256, report["render"]["sha256"])

    def test_a_wrong_plan_is_one_line(self):
        good = json.loads((self.folder / "exposure.json").read_text())
        for change, saying in (({"lamp": "sun"}, "sun"), ({"subject": {}}, "outline"), ({"subject": good["subject"] | {"outline": [[0, 0, 0]] * 4}}, "subject")):
            (self.folder / "exposure.json").write_text(json.dumps(good | change))
            code, _, err = self.run_command()
            self.assertEqual((code, err.count("\n")), (2, 1), err)
            self.assertIn(saying, err)


if __name__ == "__main__":
    unittest.main()
