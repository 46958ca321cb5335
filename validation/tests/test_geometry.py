"""Camera, pose fit, polygons and layouts."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.layout import Layout
from etalon_validation.errors import InputError
from etalon_validation.polygons import area, erode, mask
from etalon_validation.pose import Frame, fit_pose
from etalon_validation.registration import registration, registration_warning

FRAME = Frame(np.array([0, 0, 1.0]), np.array([0, 1.0, 0]), (640, 480), "mm")
TRUTH = np.array([30.0, -20.0, -900.0, 3.0, -2.0, 1.0, 800.0])
CORNERS = np.array([[x, y, z] for x in (-200, 200) for y in (-150, 150) for z in (0, 300)] + [[50, 20, 100], [-80, 60, 150]], float)


class Geometry(unittest.TestCase):
    def test_pixels_and_rays_are_inverse(self):
        camera = FRAME.camera(TRUTH)
        back = camera.position + 700 * camera.rays(camera.project(CORNERS))
        np.testing.assert_allclose(camera.project(back), camera.project(CORNERS), atol=1e-8)

    def test_the_image_right_is_look_cross_up(self):
        camera = FRAME.camera([0, 0, -1000, 0, 0, 0, 500])
        self.assertLess(camera.project([[100, 0, 0]])[0, 0], 320)
        self.assertLess(camera.project([[0, 100, 0]])[0, 1], 240)

    def test_a_planted_pose_is_found(self):
        result = fit_pose(CORNERS, FRAME.camera(TRUTH).project(CORNERS) + 1e-6 * np.sin(np.arange(20)).reshape(-1, 2), FRAME)
        np.testing.assert_allclose(result["position_mm"], TRUTH[:3], atol=1e-2)
        self.assertEqual(result["chosen"], "centred")
        self.assertLess(result["rms_px"], 1e-3)

    def test_a_shifted_principal_point_is_noticed(self):
        planted = np.append(TRUTH, [40.0, -25.0])
        noise = 0.2 * np.random.default_rng(5).standard_normal((len(CORNERS), 2))
        result = fit_pose(CORNERS, FRAME.camera(planted).project(CORNERS) + noise, FRAME)
        self.assertEqual(result["test"]["better_described_by"], "shifted")

    def test_erosion_takes_a_margin_from_every_side(self):
        square = erode([[0, 0], [10, 0], [10, 10], [0, 10]], 2)
        self.assertAlmostEqual(abs(area(square)), 36)
        self.assertEqual(mask(square, (10, 10)).sum(), 36)
        self.assertEqual(len(erode([[0, 0], [3, 0], [3, 3]], 2)), 0)

    def test_a_mirror_shows_the_face_behind_the_camera(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            layout = Layout(write_mirror_room(folder, "behind"))
            self.assertEqual(layout.polygon(layout.patches[0])[1], 1.0)
            self.assertEqual(layout.polygon(layout.patches[1])[1], 0.0)

    def test_a_scene_seen_by_another_camera_is_noticed(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = Path(folder)
            write_mirror_room(folder, "behind")
            camera = {"position": [0, 0, -1], "direction": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 50 / np.tan(np.radians(30)), "sensor_mm": [100, 100], "resolution": [50, 50]}
            (folder / "scene.json").write_text(json.dumps({"length_unit": "cm", "camera": camera}))
            self.assertLess(registration(folder)["largest_px"], 1e-6)
            self.assertIsNone(registration_warning(registration(folder)))
            (folder / "scene.json").write_text(json.dumps({"length_unit": "cm", "camera": camera | {"position": [0.1, 0, -1]}}))
            self.assertGreater(registration(folder)["largest_px"], 5)
            self.assertIn("pose.json", registration_warning(registration(folder)))

    def test_a_patch_on_an_unknown_face_is_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(InputError, "no face"):
                Layout(write_mirror_room(Path(folder), "nowhere"))


def write_mirror_room(folder, shown):
    """A camera between a mirror in front and a wall behind."""
    pose = {"position_mm": [0, 0, -10], "look": [0, 0, 1], "up": [0, 1, 0], "horizontal_fov_deg": 60, "image_px": [100, 100]}
    (folder / "pose.json").write_text(json.dumps(pose))
    faces = {
        "mirror": {"quad": [[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], "mirror": True},
        "behind": {"quad": [[-20, -20, -15], [20, -20, -15], [20, 20, -15], [-20, 20, -15]]},
    }
    patches = [{"name": "seen", "face": "mirror", "shows": shown}, {"name": "empty", "face": "mirror", "shows": ""}]
    (folder / "layout.json").write_text(json.dumps({"photo": {}, "camera": {"pose": "pose.json"}, "faces": faces, "patches": patches}))
    return folder / "layout.json"


if __name__ == "__main__":
    unittest.main()
