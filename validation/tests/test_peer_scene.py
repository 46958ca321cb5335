"""What peers are told of a scene: shapes, levels and materials, and what is changed or refused."""

import dataclasses
import json
import tempfile
import unittest
from pathlib import Path

import numpy as np

from etalon_validation.errors import InputError
from etalon_validation.peer_mitsuba_scene import spectrum
from etalon_validation.peer_scene import Diffuse, Glass, Metal, read_scene, scene_of
from etalon_validation.peer_shapes import Cylinder, Faces, Sphere, shape_of
from etalon_validation.peer_spectra import FIRST_NM, LAST_NM, Spectra, table
from etalon_validation.peer_variant import variant_of, write_variant

ROOT = Path(__file__).parents[2]
SPECTRA = Spectra(ROOT / "spectra")
BOX = {"box": {"min": [-1, -2, -3], "max": [1, 2, 3]}}
CAMERA = {"position": [0, 0, -10], "direction": [0, 0, 1], "up": [0, 1, 0], "focal_length_mm": 35, "sensor_mm": [24, 24], "resolution": [32, 32]}


def scene(material, shape=None, **more):
    """A scene file with one object."""
    thing = {"name": "thing", "shape": shape or BOX, "material": "stuff"} | more
    return {"name": "made up", "length_unit": "cm", "materials": {"stuff": material}, "objects": [thing], "camera": dict(CAMERA)}


def normals(faces):
    """Normal of each face by its first three corners, counter-clockwise, and its centre."""
    corners = np.array(faces.vertices)[np.array(faces.faces)]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), corners.mean(axis=1)


class Shapes(unittest.TestCase):
    def test_faces_of_a_box_look_outwards_whatever_moves_it(self):
        turned = [{"scale": [2, 1, 1]}, {"rotate": {"axis": [1, 2, 3], "degrees": 70}}]
        mirrored = [{"scale": [-1, 1, 1]}]
        for transforms, area in (([], 88.0), (turned, 2 * (16 + 24 + 24)), (mirrored, 88.0)):
            shape = shape_of(BOX, transforms, "box")
            normal, center = normals(shape)
            self.assertTrue(((normal * center).sum(axis=1) > 0).all(), transforms)
            self.assertAlmostEqual(shape.area, area)

    def test_transforms_apply_in_order(self):
        transforms = [{"rotate": {"axis": [0, 1, 0], "degrees": 90}}, {"translate": [10, 0, 0]}, {"matrix": [[0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 5]]}]
        # x turns to -z, is shifted along x, x and y change places, z gets 5.
        moved = shape_of({"sphere": {"center": [1, 0, 0], "radius": 2}}, transforms, "ball")
        np.testing.assert_allclose(moved.center, [0, 10, 4], atol=1e-12)
        self.assertAlmostEqual(moved.radius, 2)

    def test_round_shapes_stay_round(self):
        cylinder = shape_of({"cylinder": {"from": [0, 0, 0], "to": [0, 3, 0], "radius": 1}}, [{"scale": [2, 2, 2]}], "pipe")
        self.assertIsInstance(cylinder, Cylinder)
        np.testing.assert_allclose([*cylinder.start, *cylinder.end, cylinder.radius], [0, 0, 0, 0, 6, 0, 2], atol=1e-12)
        self.assertAlmostEqual(cylinder.area, 2 * np.pi * 2 * 8)
        with self.assertRaisesRegex(InputError, "ball: is round"):
            shape_of({"sphere": {"center": [0, 0, 0], "radius": 1}}, [{"scale": [1, 2, 1]}], "ball")
        with self.assertRaisesRegex(InputError, '"cylinder" is not understood'):
            shape_of({"cylinder": {"from": [0, 0, 0], "to": [0, 3, 0], "radius": 1, "capped": False}}, [], "pipe")


class Levels(unittest.TestCase):
    def test_a_lamp_gives_off_the_flux_that_it_is_said_to(self):
        lamp = {"spectrum": {"blackbody": {"temperature_k": 4000}}, "level": {"flux_lm": 1700}}
        for shape, area_m2 in (({"sphere": {"center": [0, 0, 0], "radius": 3}}, 4 * np.pi * 9e-4), (BOX, 88e-4)):
            made = scene_of(scene({"lambertian": {"reflectance": 0}}, shape, emission=lamp), SPECTRA, "here")
            self.assertAlmostEqual(SPECTRA.luminance(made.things[0].radiance) * np.pi * area_m2, 1700, places=6)

    def test_electrical_power_times_efficacy_is_flux(self):
        radiance = [
            SPECTRA.radiance({"spectrum": "d65", "level": level}, 1.0, "here")
            for level in ({"flux_lm": 1600}, {"electrical_power": {"power_w": 20, "efficacy_lm_per_w": 80}})
        ]
        self.assertEqual(*radiance)

    def test_a_black_body_has_wiens_ratio(self):
        body = SPECTRA.table({"blackbody": {"temperature_k": 3000}}, "here")
        # exp(h c / k T (1/700 nm - 1/400 nm)) (700/400)^5, Planck's one in the denominator is below 1e-2 %.
        expected = np.exp(1.438777e7 / 3000 * (1 / 700 - 1 / 400)) * (700 / 400) ** 5
        self.assertAlmostEqual(float(body.at(400) / body.at(700)) / expected, 1, delta=2e-3)

    def test_what_is_not_understood_is_refused(self):
        with self.assertRaisesRegex(InputError, "two-sided lamps"):
            SPECTRA.radiance({"spectrum": 1, "level": {"flux_lm": 1}, "two_sided": True}, 1.0, "here")
        with self.assertRaisesRegex(InputError, "spectrum 'sodium-low-pressure' is not understood"):
            SPECTRA.table("sodium-low-pressure", "here")


class Scenes(unittest.TestCase):
    def test_every_scene_of_a_session_has_a_variant_that_peers_understand_and_json_holds(self):
        for name in ("cornell", "schoedl-2007", "slit-room", "cornell-photo", "yale-grey", "stanford"):
            with tempfile.TemporaryDirectory() as folder:
                write_variant(ROOT / "reference" / name, ROOT / "spectra", folder)
                made = read_scene(Path(folder) / "scene.json", SPECTRA)
            self.assertEqual(made.is_diffuse, name not in ("schoedl-2007", "cornell-photo"))
            self.assertEqual(sum(thing.radiance is not None for thing in made.things), 1)
            json.dumps(dataclasses.asdict(made))

    def test_glass_and_metal_are_what_they_were(self):
        made = scene_of(scene({"dielectric": {"index": 1.5}}), SPECTRA, "here")
        self.assertEqual(made.things[0].material, Glass(1.5))
        metal = scene_of(scene({"conductor": {"metal": "copper"}}), SPECTRA, "here").things[0].material
        self.assertIsInstance(metal, Metal)
        self.assertGreater(metal.k.at(650), metal.n.at(650))

    def test_what_no_peer_has_is_refused_and_named(self):
        for material in ({"dielectric": {"index": 1.5, "roughness_alpha": 0.3}}, {"dielectric": {"index": 1.5, "absorption_per_m": 1}}):
            with self.assertRaisesRegex(InputError, 'here: material "stuff": is none that every peer has'):
                scene_of(scene(material), SPECTRA, "here")
        with self.assertRaisesRegex(InputError, "do not fill with squares"):
            scene_of(scene({"lambertian": {"reflectance": 0.5}}), SPECTRA, "here", (64, 48))

    def test_a_variant_says_each_change_and_changes_nothing_else(self):
        plain = scene({"lambertian": {"reflectance": 0.5}})
        self.assertEqual(variant_of(plain, SPECTRA, "here"), (plain, ()))
        made, said = variant_of(scene({"dielectric": {"index": "n-bk7"}}), SPECTRA, "here")
        # The catalogue's n_d of N-BK7 is 1.5168 at 587.6 nm.
        self.assertAlmostEqual(made["materials"]["stuff"]["dielectric"]["index"], 1.5168, delta=2e-4)
        self.assertEqual(len(said), 1)
        # Every glass of the folder, whichever way it is kept.
        indices = [SPECTRA.index(file.stem, "here") for file in (ROOT / "spectra" / "glass").glob("*.csv")]
        self.assertTrue(all(1.3 < index < 2.5 for index in indices), indices)
        rough = scene({"conductor": {"metal": "silver", "roughness_alpha": 0.2}})
        rough["camera"]["focus_distance"] = 100
        made, said = variant_of(rough, SPECTRA, "here")
        self.assertEqual(len(said), 2)
        material = scene_of(made, SPECTRA, "here").things[0].material
        self.assertIsInstance(material, Diffuse)
        self.assertTrue(0.9 < material.reflectance.at(600) < 1)
        self.assertIn("focus_distance", rough["camera"])


class MitsubaSpectra(unittest.TestCase):
    def test_a_reflectance_reaches_over_all_wavelengths_and_keeps_its_values(self):
        for nm in ([400, 500, 600, 700], [400, 450, 700]):
            made = spectrum(table(nm, np.linspace(0.2, 0.8, len(nm))))
            values = [float(word) for word in made["values"].split(",")]
            if made["type"] == "regular":
                found = np.linspace(made["wavelength_min"], made["wavelength_max"], len(values))
            else:
                found = np.array([float(word) for word in made["wavelengths"].split(",")])
            self.assertTrue(found[0] <= FIRST_NM and found[-1] >= LAST_NM)
            np.testing.assert_allclose(np.interp(nm, found, values), np.linspace(0.2, 0.8, len(nm)))
            self.assertAlmostEqual(np.interp(FIRST_NM, found, values), 0.2)
            self.assertAlmostEqual(np.interp(LAST_NM, found, values), 0.8)

    def test_light_ends_where_its_table_does_and_black_is_no_table(self):
        made = spectrum(table([400, 500, 600], [1, 2, 3], holds=False))
        self.assertEqual((made["wavelength_min"], made["wavelength_max"]), (400, 600))
        self.assertEqual(spectrum(SPECTRA.table(0, "here")), {"type": "uniform", "value": 0.0})

    def test_a_sphere_and_a_cylinder_are_not_made_of_triangles(self):
        self.assertIsInstance(shape_of({"sphere": {"center": [0, 0, 0], "radius": 1}}, [], "ball"), Sphere)
        self.assertIsInstance(shape_of(BOX, [], "box"), Faces)


if __name__ == "__main__":
    unittest.main()
