"""Band by band: planted factors come back, and what is not known of the images is said."""

import contextlib
import io
import json
import tempfile
import unittest
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from etalon_validation.band_regions import find_regions, read_scene
from etalon_validation.bands import read_bands, read_plan
from etalon_validation.camera import turned
from etalon_validation.cli import main
from etalon_validation.photograph import sha256_of
from etalon_validation.polygons import mask

from .band_case import LEVELS, NMS, SIZE, camera_of, picture, write_band_case, write_band_images, write_band_render
from .case import write_exr

# Factors of the seven bands, in stops; those of the bands that do not count are far off.
PLANTED = np.array([5.0, -3.0, 0.3, -0.1, 0.25, -0.45, 6.0])
COMMON = 2.5


class Bands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.holder.cleanup)
        cls.case = Path(cls.holder.name)
        write_band_case(cls.case)
        cls.image = picture(cls.case, camera_of(cls.case))
        write_band_render(cls.case / "out.exr", cls.image)

    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.bands = self.folder / "bands"
        write_band_images(self.bands, self.image, 2 ** (PLANTED + COMMON))

    def score(self, place=None, *more):
        """Exit code, stdout and stderr of one scoring."""
        out, err = io.StringIO(), io.StringIO()
        words = ["bands", "--case", self.case, "--render", self.case / "out.exr", "--bands", place or self.bands, "-o", self.folder / "report", *more]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main([str(word) for word in words])
        return code, out.getvalue(), err.getvalue()

    def report(self):
        """The report written last."""
        return json.loads((self.folder / "report" / "report.json").read_text())

    def refused(self, saying, place=None, *more):
        """Asserts exit code 2 and one line that says what is wrong."""
        code, _, err = self.score(place, *more)
        self.assertEqual((code, err.count("\n")), (2, 1), err)
        self.assertIn(saying, err)

    def test_planted_factors_come_back_and_only_counted_bands_count(self):
        self.assertEqual(self.score()[0], 0)
        levels = self.report()["levels"]
        fitted = [levels["L2"]["fitted"][str(nm)]["log2_factor"] for nm in NMS]
        np.testing.assert_allclose(fitted, PLANTED + COMMON, atol=1e-4)
        common = PLANTED[2:6].mean() + COMMON
        self.assertAlmostEqual(levels["L1"]["fitted"]["log2_factor"], common, places=4)
        self.assertAlmostEqual(levels["L1"]["overall"]["rms_stops"], PLANTED[2:6].std(), places=4)
        self.assertLess(levels["L2"]["overall"]["rms_stops"], 1e-4)
        self.assertGreater(levels["L1"]["overall"]["count"], 20)

    def test_a_face_that_differs_in_one_band_shows_there_alone(self):
        # The left wall; what the mirror shows of it is of another level.
        changed = np.where(self.image == LEVELS["left_wall"], LEVELS["left_wall"] / 2, self.image)
        write_exr(self.bands / "550nm.exr", 2 ** (PLANTED[3] + COMMON) * changed[..., None], ["Y"])
        self.score()
        rows = self.report()["levels"]["L1"]["regions"]
        walls = [row for row in rows if row["surface"] == "left_wall" and not row["name"].startswith("mirror")]
        self.assertTrue(walls)
        self.assertEqual([row["name"] for row in rows if row["bands"]["500"]["ratio"] is None], ["mirror_front_dark"])
        for row in (row for row in rows if row["bands"]["500"]["ratio"]):
            off = np.log2(row["bands"]["500"]["ratio"] / row["bands"]["550"]["ratio"]) - (PLANTED[3] - PLANTED[2])
            self.assertAlmostEqual(off, -1.0 if row in walls else 0.0, places=3, msg=row["name"])

    def test_intervals_hold_the_noise_of_both_sides(self):
        noisy = self.image * (1 + 0.3 * np.random.default_rng(3).standard_normal(self.image.shape))
        write_band_images(self.bands, noisy, 2 ** (PLANTED + COMMON))
        self.score()
        found = [row["bands"]["600"] for row in self.report()["levels"]["L2"]["regions"] if row["bands"]["600"]["ratio"]]
        # Pixels are independent here and counted as a ninth as many: intervals reach almost six standard errors, and one of
        # fifty misses less than once in a million runs.
        self.assertTrue(all(cell["ratio_95"][0] < 1 < cell["ratio_95"][1] for cell in found))
        widths = [cell["ratio_95"][1] / cell["ratio_95"][0] for cell in found]
        self.assertTrue(all(1.001 < width < 1.6 for width in widths), widths)

    def test_an_archive_is_a_folder(self):
        self.score()
        levels = self.report()["levels"]
        archive = self.folder / "box_exr.zip"
        with zipfile.ZipFile(archive, "w") as content:
            for path in self.bands.iterdir():
                content.write(path, f"box/deep/{path.name}")
            content.writestr("../camera.mat", "not the published one")
        code, _, err = self.score(archive)
        self.assertEqual(code, 0)
        self.assertIn("not known to be the published archive", err)
        report = self.report()
        self.assertEqual(report["levels"], levels)
        self.assertEqual(report["reference"]["sha256"], sha256_of(archive))
        self.assertTrue(report["reference"]["response"].startswith("unknown"))
        self.assertFalse((self.folder.parent / "camera.mat").exists())

    def test_a_known_archive_is_known(self):
        archive = self.folder / "box_exr.zip"
        with zipfile.ZipFile(archive, "w") as content:
            for path in self.bands.iterdir():
                content.write(path, path.name)
        plan = read_plan(self.case)
        plan = replace(plan, table=plan.table | {"archive_sha256": sha256_of(archive)})
        self.assertTrue(read_bands(archive, plan).archive.startswith("known"))

    def test_another_camera_is_fitted_and_each_side_measured_through_its_own(self):
        ours = camera_of(self.case)
        look, up = turned(ours.look, ours.up, 0.03, -0.02, 0.01)
        moved = replace(ours, position=ours.position + [25, -20, 30], look=look, up=up)
        write_band_images(self.bands, picture(self.case, moved), 2 ** (PLANTED + COMMON))
        corners = np.array([[x, y, z] for x in (5.0, 545.0) for y in (2.0, 540.0) for z in (0.0, 559.0)])
        rows = [",".join(f"{value:.4f}" for value in (*world, *pixel)) for world, pixel in zip(corners, moved.project(corners))]
        points = self.folder / "points.csv"
        points.write_text("\n".join(["x_mm,y_mm,z_mm,u_px,v_px", *rows]))
        self.score()
        without = self.report()
        self.assertTrue(any("pose" in warning for warning in without["reference"]["warnings"]))
        self.assertEqual(self.score(None, "--points", points)[0], 0)
        fitted = self.report()
        self.assertEqual(fitted["pose"]["kind"], "fitted")
        self.assertLess(fitted["levels"]["L2"]["overall"]["rms_stops"], 1e-3)
        names = [[row["name"] for row in report["levels"]["L2"]["regions"] if row["name"].startswith("mirror")] for report in (without, fitted)]
        self.assertTrue(names[0] and not names[1], "a mirror shows another part of the box to another camera")
        self.assertGreater(without["levels"]["L2"]["overall"]["rms_stops"], 0.02)
        _, err = self.score(None, "--points", points)[1:]
        self.assertNotIn("pose", err)

    def test_the_baffle_hides_what_lies_behind_it(self):
        scene, path = read_scene(self.case)
        sight = find_regions(read_plan(self.case), scene, path, SIZE, SIZE, None)
        black = [pair.name for pair in sight.pairs if pair.name.startswith("ceiling") and (self.image[mask(pair.in_render, SIZE)] == 0).any()]
        self.assertEqual(black, [])
        self.assertGreater(sum(pair.name.startswith("ceiling") for pair in sight.pairs), 0)

    def test_what_is_wrong_is_one_line(self):
        self.refused("no such folder", self.folder / "nowhere")
        (self.folder / "text.zip").write_text("no archive")
        self.refused("text.zip", self.folder / "text.zip")
        (self.bands / "450nm.exr").write_text("no image")
        self.refused("450nm.exr")
        write_exr(self.bands / "450nm.exr", self.image[:10, :, None], ["Y"])
        self.refused("differ in size")
        write_exr(self.bands / "450nm.exr", np.repeat(self.image[..., None], 3, axis=-1), ["R", "G", "B"])
        self.refused("R, G, B")
        write_exr(self.bands / "450nm.exr", np.nan * self.image[..., None], ["Y"])
        self.refused("not finite")
        (self.bands / "450nm.exr").unlink()
        self.refused("450nm.exr")
        write_band_images(self.bands, 0 * self.image, PLANTED)
        self.refused("bright enough")
        write_band_images(self.bands, self.image[:, :200], PLANTED)
        self.refused("one shape")


if __name__ == "__main__":
    unittest.main()
