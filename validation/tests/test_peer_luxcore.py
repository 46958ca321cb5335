"""What LuxCore is told of a scene: bands of luminance, triangles of round shapes, camera and materials."""

import unittest
from pathlib import Path

import numpy as np

from etalon_validation.peer_command import Order
from etalon_validation.peer_luxcore import INTEGRATORS, REFERENCE, configuration
from etalon_validation.peer_luxcore_bands import CUTS_NM, WEIGHTS, bands_of, luminance
from etalon_validation.peer_luxcore_mesh import doubled, meshes
from etalon_validation.peer_luxcore_scene import describe
from etalon_validation.peer_scene import EFFICACY, Camera, Cylinder, Diffuse, Disk, Faces, Glass, Metal, Scene, Spectra, Sphere, Table, Thing

OBSERVER = Spectra(Path(__file__).parents[2] / "spectra").observer

EVEN = Table((360.0, 830.0), (0.5, 0.5))
# Reflects below, between and above the cuts.
STEPS = Table((360.0, 539.0, 540.0, 599.0, 600.0, 830.0), (0.1, 0.1, 0.4, 0.4, 0.9, 0.9))
LIGHT = Table((400.0, 700.0), (0.01, 0.03), holds=False)
LAMP = Thing("lamp", Sphere((0.0, 2.0, 0.0), 0.25), Diffuse(EVEN, True), LIGHT)
CAMERA = Camera((0.0, 1.0, -4.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 40.0, (32, 16))


def scene(*things):
    """A scene of a lamp and these things."""
    return Scene("test", 1.0, (LAMP, *(Thing(f"thing {index}", *thing) for index, thing in enumerate(things))), CAMERA)


def volume(mesh):
    """Volume inside triangles that face outwards, about the origin."""
    return float(np.einsum("ij,ij->", mesh.points[mesh.triangles[:, 0]], doubled(mesh.points, mesh.triangles))) / 6


class Bands(unittest.TestCase):
    def setUp(self):
        self.bands = bands_of(scene(), OBSERVER)

    def luminance(self, values):
        nm = OBSERVER[:, 0]
        return EFFICACY * np.trapezoid(values * LIGHT.at(nm) * OBSERVER[:, 2], nm)

    def test_luminance_of_a_lamp_is_that_of_the_observer(self):
        self.assertAlmostEqual(luminance(self.bands.radiance(LIGHT)) / self.luminance(1.0), 1.0, places=12)

    def test_light_that_is_reflected_once_has_the_luminance_of_the_spectral_product(self):
        slope = np.linspace(0.05, 0.95, len(OBSERVER))
        reflected = luminance(self.bands.radiance(LIGHT) * self.bands.share(slope))
        self.assertAlmostEqual(reflected / self.luminance(slope), 1.0, places=12)

    def test_a_reflectance_that_is_even_within_bands_is_right_for_light_reflected_often(self):
        values = STEPS.at(OBSERVER[:, 0])
        shares = self.bands.share(values)
        np.testing.assert_allclose(shares, [0.9, 0.4, 0.1], atol=1e-12)
        thrice = luminance(self.bands.radiance(LIGHT) * shares**3)
        self.assertAlmostEqual(thrice / self.luminance(values**3), 1.0, places=12)

    def test_the_longest_waves_are_red(self):
        red = Table((CUTS_NM[1], CUTS_NM[1] + 40), (1.0, 1.0), holds=False)
        channels = self.bands.radiance(red) * WEIGHTS
        self.assertGreater(channels[0], 0)
        np.testing.assert_array_equal(channels[1:], 0)

    def test_a_scene_without_lamps_has_finite_shares(self):
        dark = Scene("dark", 1.0, (Thing("floor", LAMP.shape, Diffuse(EVEN, True)),), CAMERA)
        np.testing.assert_allclose(bands_of(dark, OBSERVER).share(EVEN.at(OBSERVER[:, 0])), 0.5)


class Meshes(unittest.TestCase):
    def test_a_sphere_has_its_area_and_nearly_its_volume_and_faces_outwards(self):
        ball = Sphere((0.0, 0.0, 0.0), 2.0)
        for is_lamp, off in ((True, 0.02), (False, 0.001)):
            (mesh,) = meshes(ball, is_lamp)
            self.assertAlmostEqual(mesh.area / ball.area, 1.0, places=12)
            self.assertLess(abs(volume(mesh) / (4 / 3 * np.pi * 8) - 1), off)
            self.assertEqual(mesh.normals is None, is_lamp)
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1)
        self.assertGreater(np.einsum("ij,ij->i", mesh.normals, mesh.points).min(), 0)

    def test_every_edge_of_a_sphere_has_two_sides(self):
        (mesh,) = meshes(Sphere((1.0, 2.0, 3.0), 0.5), False)
        edges = {tuple(edge) for triangle in mesh.triangles.tolist() for edge in zip(triangle, triangle[1:] + triangle[:1])}
        self.assertEqual(len(edges), 3 * len(mesh.triangles))
        self.assertTrue(all((b, a) in edges for a, b in edges))

    def test_a_cylinder_is_closed_and_faces_outwards(self):
        start, end, radius = np.array([1.0, -2.0, 0.5]), np.array([2.0, 1.0, -1.5]), 0.75
        parts = meshes(Cylinder(tuple(start), tuple(end), radius), False)
        inside = sum(volume(part) for part in parts)
        self.assertAlmostEqual(inside / (np.pi * radius**2 * np.linalg.norm(end - start)), 1.0, places=9)
        corners = [set(map(tuple, part.points.tolist())) for part in parts]
        self.assertEqual(len(corners[0] & corners[1]) + len(corners[0] & corners[2]), len(corners[0]))

    def test_a_disk_has_its_area_and_faces_its_normal(self):
        round_one = Disk((1.0, 2.0, 3.0), (0.0, -0.6, 0.8), 0.3)
        (mesh,) = meshes(round_one, True)
        vector = 0.5 * doubled(mesh.points, mesh.triangles).sum(axis=0)
        np.testing.assert_allclose(vector, round_one.area * np.array(round_one.normal), atol=1e-12)

    def test_flat_faces_keep_their_corners_and_their_front(self):
        (mesh,) = meshes(Faces(((0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0)), ((0, 1, 2, 3),)), False)
        np.testing.assert_allclose(0.5 * doubled(mesh.points, mesh.triangles).sum(axis=0), [0, 0, 6])


class Described(unittest.TestCase):
    def test_a_lamp_shines_with_the_flux_of_the_round_shape(self):
        tube = Thing("tube", Cylinder((0.0, 0.0, 0.0), (0.0, 1.0, 0.0), 0.05), Diffuse(EVEN, True), LIGHT)
        described = describe(Scene("tube", 1.0, (tube,), CAMERA), OBSERVER)
        area = sum(mesh.area for mesh in described.shapes.values())
        shone = luminance(np.array(described.properties["scene.materials.material_0.emission"])) * area
        nm = OBSERVER[:, 0]
        self.assertAlmostEqual(shone / (tube.shape.area * EFFICACY * np.trapezoid(LIGHT.at(nm) * OBSERVER[:, 2], nm)), 1.0, places=12)

    def test_materials_are_told_by_their_kind(self):
        plate = Faces(((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)), ((0, 1, 2, 3),))
        n, k = Table((360.0, 830.0), (0.2, 0.2)), Table((360.0, 830.0), (3.0, 3.0))
        told = describe(scene((plate, Glass(1.5)), (plate, Metal(n, k, True)), (plate, Diffuse(STEPS, False))), OBSERVER).properties
        self.assertEqual((told["scene.materials.material_1.type"], told["scene.materials.material_1.interiorior"]), ("glass", 1.5))
        np.testing.assert_allclose(told["scene.materials.material_2.kr"], (0.8**2 + 9) / (1.2**2 + 9))
        np.testing.assert_allclose(told["scene.materials.material_3.kd"], [0.9, 0.4, 0.1])
        self.assertEqual(told["scene.objects.object_3_0.material"], "material_3_front")
        self.assertEqual(told["scene.materials.material_3_back.kd"], [0, 0, 0])

    def test_the_window_is_a_row_below_the_middle_with_square_pixels(self):
        left, right, low, high = describe(scene(), OBSERVER).properties["scene.camera.screenwindow"]
        self.assertEqual((left, right, high - low), (-1, 1, 1))
        self.assertEqual((low + high) / 2, -(high - low) / CAMERA.resolution[1])


class Configurations(unittest.TestCase):
    def test_roulette_is_off_where_it_is_wrong_and_seeds_are_never_the_clock_s(self):
        for name in INTEGRATORS:
            told = configuration(Order(scene(), OBSERVER, name, 4, 0, 3))
            self.assertEqual((told["renderengine.seed"], told["native.threads.count"]), (1, 3))
            self.assertEqual(told.get("path.russianroulette.depth") == 1000, name.startswith("bidir"))
            self.assertIn(REFERENCE[name], INTEGRATORS)


if __name__ == "__main__":
    unittest.main()
