"""The command line from files to reports, and from bad files to exit code 2."""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.cli import main

from .case import COLOURS, patches, write_case, write_exr, write_render


VERDICTS = ("agrees within uncertainty", "differs", "cannot be settled")


class Command(unittest.TestCase):
    def setUp(self):
        self.holder = tempfile.TemporaryDirectory()
        self.addCleanup(self.holder.cleanup)
        self.folder = Path(self.holder.name)
        self.image = write_case(self.folder)
        write_render(self.folder / "out.exr", self.image / 2**0.7)

    def score(self, *more, render="out.exr"):
        """Exit code, stdout and stderr of one scoring."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(["score", "--case", str(self.folder), "--render", str(self.folder / render), "-o", str(self.folder / "report"), *more])
        return code, out.getvalue(), err.getvalue()

    def report(self):
        """The report written last."""
        return json.loads((self.folder / "report" / "report.json").read_text())

    def refused(self, *more, render="out.exr", saying=""):
        """Asserts exit code 2 and one line that says what is wrong."""
        code, _, err = self.score(*more, render=render)
        self.assertEqual(code, 2, err)
        self.assertEqual(err.count("\n"), 1, err)
        self.assertIn(saying, err)

    def test_scoring_recovers_the_planted_exposure(self):
        code, out, err = self.score("--photo", str(self.folder / "photo.exr"))
        self.assertEqual((code, err), (0, ""))
        self.assertEqual([line[:2] for line in out.splitlines() if line.startswith("L")], ["L0", "L1", "L2", "L3", "L4"])
        self.assertIn("exposure fitted at L1): +0.70 stops", out)
        report = self.report()
        self.assertAlmostEqual(report["levels"]["L1"]["fitted"]["exposure_stops"], 0.7, places=3)
        self.assertAlmostEqual(report["levels"]["L0"]["overall"]["rms_stops"], 0.7, places=3)
        self.assertLess(report["levels"]["L1"]["overall"]["mean_duv"], 1e-4)
        self.assertEqual(report["reference"]["kind"], "photograph")

    def test_what_readers_of_the_report_rely_on_is_there(self):
        self.score("--photo", str(self.folder / "photo.exr"))
        report = self.report()
        low, high = report["calibration_error"]["exposure_stops_95"]
        self.assertLess(low, high)
        self.assertAlmostEqual(report["calibration_error"]["exposure_stops"], 0.7, places=3)
        self.assertIsNone(report["calibration_error"]["declared_u_stops"])
        self.assertFalse(report["calibration"]["declared"])
        self.assertIn("glare_share_95", report["levels"]["L4"]["fitted"])
        for level in report["levels"].values():
            self.assertEqual(level["budget"][-1]["component"], "all together")
            self.assertIn(level["verdict"]["verdict"], VERDICTS)
            for row in level["regions"]:
                self.assertIn(row["verdict"], (*VERDICTS, None) if not row["in_overall"] else VERDICTS)
                for key in ("duv", "luminance_ratio", "delta_e_2000", "delta_e_itp"):
                    low, high = row[f"{key}_95"]
                    self.assertLessEqual(low, high)
        self.assertEqual(report["levels"]["L0"]["verdict"]["verdict"], "differs", "0.7 stops and no calibration declared")
        self.assertEqual(set(report["picture"]["levels"]), set(report["levels"]))
        self.assertLess(report["picture"]["levels"]["L1"]["nrmse"], 1e-3)
        self.assertTrue(all(entry["text"] for entry in report["findings"]))

    def test_without_the_photograph_whole_picture_figures_are_absent_and_the_report_says_so(self):
        self.score()
        report = self.report()
        self.assertFalse(report["picture"]["available"])
        self.assertIn("not at hand", report["picture"]["reason"])
        self.assertIn("picture", [entry["topic"] for entry in report["findings"]])

    def test_a_lamp_level_known_to_a_factor_of_two_leaves_the_exposure_open(self):
        (self.folder / "calibration.json").write_text(json.dumps({"components": [
            {"name": "lamp level", "pattern": "level", "relative_standard_uncertainty": 0.7, "source": "assumed"},
        ]}))
        self.assertEqual(self.score()[0], 0)
        report = self.report()
        self.assertTrue(report["calibration_error"]["within_declared"])
        low, high = report["calibration_error"]["exposure_stops_95"]
        self.assertLess(high - low, 0.1, "the lamp's level is what the exposure is held against, it does not blur it")
        self.assertEqual(report["levels"]["L0"]["verdict"]["verdict"], "cannot be settled")
        self.assertEqual(report["levels"]["L1"]["verdict"]["verdict"], "agrees within uncertainty")
        sentence = next(entry for entry in report["findings"] if entry["topic"] == "exposure")
        self.assertFalse(sentence["settled"])
        self.assertIn("lamp level (a factor of 2)", sentence["text"])

    def test_malformed_calibrations_are_refused(self):
        good = {"name": "lamp", "pattern": "level", "relative_standard_uncertainty": 0.1, "source": "assumed"}
        for entries, saying in (
            ([{}], "name"), ([good | {"pattern": "odd"}], "odd"), ([good | {"relative_standard_uncertainty": "much"}], "wrong kind"),
            ([good | {"relative_standard_uncertainty": -1}], "negative"), ([good | {"kind": "C"}], "A or B"), ([good, good], "one name"),
            ([good | {"degrees_of_freedom": 1}], "degrees"), (7, "wrong kind"),
        ):
            (self.folder / "calibration.json").write_text(json.dumps({"components": entries}))
            self.refused(saying=saying)

    def test_dark_regions_are_flagged_and_kept_out(self):
        self.score()
        level = self.report()["levels"]["L1"]
        self.assertEqual(level["overall"]["left_out"], ["patch_8"])
        self.assertEqual(level["overall"]["count"], 8)
        self.assertIsNotNone(level["regions"][8]["flag"])

    def test_every_figure_is_a_number_and_regions_without_light_stand_apart(self):
        self.image[:, -12:] = 0
        write_render(self.folder / "out.exr", self.image / 2**0.7)
        self.score()
        for level in self.report()["levels"].values():
            self.assertEqual([row["name"] for row in level["undefined"]], ["patch_8"])
            self.assertEqual(level["overall"]["left_out"], ["patch_8"])
            for row in level["regions"]:
                for key in ("duv", "luminance_ratio", "delta_e_2000", "delta_e_itp", "render_noise", "photo_noise"):
                    self.assertIsInstance(row[key], float)
                self.assertTrue(row["render_noise_dominates"], "the photograph of this case has no noise")

    def test_a_channel_without_any_light_is_scored_all_the_same(self):
        """A sodium lamp leaves the blue channel empty on both sides."""
        self.image[..., 2] = 0
        write_render(self.folder / "out.exr", self.image / 2**0.7)
        write_exr(self.folder / "yellow.exr", self.image, ["R", "G", "B"])
        code, _, err = self.score("--photo", str(self.folder / "yellow.exr"))
        self.assertEqual(code, 0, err)
        self.assertAlmostEqual(self.report()["calibration_error"]["exposure_stops"], 0.7, places=3)
        self.assertEqual(len(self.report()["levels"]["L4"]["regions"]), 9)

    def test_the_table_stands_in_for_the_photograph(self):
        self.assertEqual(self.score()[0], 0)
        self.assertEqual(self.report()["reference"]["kind"], "region_table")

    def test_the_page_asks_nothing_of_the_network(self):
        self.score("--photo", str(self.folder / "photo.exr"))
        page = (self.folder / "report" / "report.html").read_text()
        for request in ("http://", "https://", "src=\"/", "@import", "url("):
            self.assertNotIn(request, page)

    def test_another_photograph_is_noticed_and_measured_again(self):
        write_exr(self.folder / "other.exr", self.image * 1.5, ["R", "G", "B"])
        code, _, err = self.score("--photo", str(self.folder / "other.exr"))
        self.assertEqual(code, 0)
        self.assertIn("SHA-256", err)
        report = self.report()
        self.assertTrue(report["reference"]["regions_measured_again"])
        self.assertAlmostEqual(report["levels"]["L1"]["fitted"]["exposure_stops"], 0.7 + np.log2(1.5), places=3)

    def test_camera_rgb_is_compared_in_the_sensor(self):
        write_case(self.folder, space="camera_rgb")
        mixed = np.array([[0.7, 0.3, 0.1], [0.2, 0.9, 0.1], [0.1, 0.2, 0.8]])
        write_render(self.folder / "out.exr", self.image @ np.linalg.inv(mixed).T, sensor=self.image * 17)
        self.assertEqual(self.score()[0], 0)
        report = self.report()
        self.assertEqual(report["compared_in"], "camera_rgb")
        self.assertLess(report["levels"]["L1"]["overall"]["max_duv"], 1e-4)

    def test_a_render_at_half_size_is_scored_in_scaled_regions(self):
        write_render(self.folder / "out.exr", patches(COLOURS)[::2, ::2])
        self.assertEqual(self.score("--photo", str(self.folder / "photo.exr"))[0], 0)
        self.assertAlmostEqual(self.report()["levels"]["L0"]["overall"]["rms_stops"], 0, places=5)

    def test_missing_files_are_named(self):
        self.refused(render="nowhere.exr", saying="nowhere.exr")
        self.refused("--photo", str(self.folder / "nowhere.png"), saying="nowhere.png")

    def test_files_that_are_no_images_are_refused(self):
        (self.folder / "text.exr").write_text("not an image")
        self.refused(render="text.exr", saying="text.exr")
        self.refused("--photo", str(self.folder / "text.exr"), saying="text.exr")
        self.refused("--photo", str(self.folder / "regions.json"), saying="unknown kind")

    def test_renders_without_their_channels_or_record_are_refused(self):
        self.refused(render="photo.exr", saying="channel")
        write_render(self.folder / "bare.exr", self.image, attributes=[])
        self.refused(render="bare.exr", saying="etalon")
        write_render(self.folder / "bad.exr", self.image, attributes=[("etalon", "{")])
        self.refused(render="bad.exr", saying="JSON")
        write_render(self.folder / "bad.exr", self.image, attributes=[("etalon", '{"camera": {"saturation_luminance_cd_m2": 0}}')])
        self.refused(render="bad.exr", saying="saturation")
        write_render(self.folder / "bad.exr", self.image * np.nan)
        self.refused(render="bad.exr", saying="finite")

    def test_malformed_tables_are_refused(self):
        good = json.loads((self.folder / "regions.json").read_text())
        for text, saying in (
            ("{", "not JSON"), ("[]", "no JSON object"), ("{}", "photo"),
            (json.dumps(good | {"regions": []}), "no regions"), (json.dumps(good | {"photo_space": "odd"}), "odd"),
            (json.dumps(good | {"regions": [{"name": "half"}]}), "half"),
        ):
            (self.folder / "regions.json").write_text(text)
            self.refused(saying=saying)

    def test_another_aspect_ratio_is_refused(self):
        write_render(self.folder / "wide.exr", self.image[:6])
        self.refused(render="wide.exr", saying="aspect")

    def test_broken_points_are_refused(self):
        (self.folder / "layout.json").write_text(json.dumps({"camera": {"image_px": [10, 10], "level": {"look": [0, 0, 1], "up": [0, 1, 0]}}}))
        for text in ("", "a,b\n1,2\n", "x_mm,y_mm,z_mm,u_px,v_px\n1,2,3,4,none\n", "x_mm,y_mm,z_mm,u_px,v_px\n1,2,3,4,5\n"):
            (self.folder / "points.csv").write_text(text)
            with contextlib.redirect_stderr(io.StringIO()) as err:
                self.assertEqual(main(["fit-pose", "--case", str(self.folder)]), 2)
            self.assertEqual(err.getvalue().count("\n"), 1)


if __name__ == "__main__":
    unittest.main()
