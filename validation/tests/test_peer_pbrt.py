"""What pbrt-r4 is told of a scene: absolute lamps, spectra, fronts of surfaces, the camera; and what its film says."""

import os
import re
import stat
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np

from etalon_validation.errors import InputError
from etalon_validation.peer_command import Order
from etalon_validation.peer_converged import FIRST_SEED as FIRST_OF_CONVERGED, RUNS
from etalon_validation.peer_pbrt import FIRST_SAMPLES, INTEGRATORS, PROGRAM, REFERENCE, integrator_line, read_xyz, render, spp_taken
from etalon_validation.peer_pbrt_scene import FIRST_NM, LAST_NM, faces, lamp, material, scene_text, shape, spectrum
from etalon_validation.peer_scene import EFFICACY, Camera, Cylinder, Diffuse, Disk, Faces, Glass, Metal, Scene, Spectra, Sphere, Table, Thing
from etalon_validation.peer_session import FIRST_SEED, POINTS, REPEATS

from .peer_files import write_exr

OBSERVER = Spectra(Path(__file__).parents[2] / "spectra").observer
LIGHT = Table((400.0, 700.0), (0.01, 0.03), holds=False)
GREY = Diffuse(Table((400.0, 700.0), (0.25, 0.5)), True)
CAMERA = Camera((0.0, 1.0, -4.0), (0.0, 1.0, 0.0), (0.0, 1.0, 0.0), 40.0, (32, 16))
SCENE = Scene("test", 1.0, (Thing("lamp", Sphere((0.0, 2.0, 0.0), 0.25), GREY, LIGHT),), CAMERA)


def order(integrator="path", seed=0):
    """An order of 4 samples."""
    return Order(SCENE, OBSERVER, integrator, 4, seed, 1)


def values(text, name):
    """The numbers of a parameter."""
    return np.array(re.search(rf'"[a-z0-9]+ {name}" \[ ([^\]]*) \]', text).group(1).split(), float)


class Spectral(unittest.TestCase):
    def test_a_lamp_s_scale_is_its_luminance(self):
        (line,) = lamp(LIGHT, OBSERVER)
        nm = OBSERVER[:, 0]
        self.assertAlmostEqual(values(line, "scale")[0] / (EFFICACY * np.trapezoid(LIGHT.at(nm) * OBSERVER[:, 2], nm)), 1.0, places=8)
        np.testing.assert_allclose(values(line, "L"), [400, 0.01, 700, 0.03])
        self.assertEqual(lamp(None, OBSERVER), [])

    def test_a_reflectance_goes_on_beyond_its_table(self):
        pairs = np.array(spectrum(GREY.reflectance).split(), float).reshape(-1, 2)
        np.testing.assert_allclose(pairs, [[FIRST_NM, 0.25], [400, 0.25], [700, 0.5], [LAST_NM, 0.5]])

    def test_a_table_wider_than_what_is_rendered_keeps_its_values_within(self):
        wide = Table((200.0, 500.0, 1000.0), (0.0, 0.6, 0.1))
        pairs = np.array(spectrum(wide).split(), float).reshape(-1, 2)
        np.testing.assert_allclose(np.interp([310, 500, 880], pairs[:, 0], pairs[:, 1]), wide.at(np.array([310, 500, 880])))
        self.assertTrue((np.diff(pairs[:, 0]) > 0).all())

    def test_materials_are_told_by_their_kind(self):
        self.assertIn('"float eta" [ 1.5 ]', material(Glass(1.5)))
        metal = material(Metal(Table((400.0, 700.0), (0.2, 0.3)), Table((400.0, 700.0), (3.0, 4.0)), True))
        np.testing.assert_allclose(values(metal, "k")[2:6], [400, 3, 700, 4])


class Shapes(unittest.TestCase):
    def test_a_patch_has_the_corners_and_the_front_of_its_quadrangle(self):
        quad = Faces(((0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0)), ((0, 1, 2, 3),))
        (line,) = faces(quad)
        corners = values(line, "P").reshape(-1, 3)[values(line, "indices").astype(int)]
        across, along = corners[1] - corners[0], corners[2] - corners[0]
        np.testing.assert_allclose(np.cross(across, along), [0, 0, 6])
        np.testing.assert_allclose(corners[3], corners[0] + across + along)

    def test_other_faces_are_triangles_with_the_same_front(self):
        mixed = Faces(((0, 0, 0), (2, 0, 0), (2, 3, 0), (0, 3, 0), (1, 4, 0)), ((0, 1, 2, 3), (3, 2, 4)))
        patch, triangle = faces(mixed)
        self.assertIn("bilinearmesh", patch)
        np.testing.assert_array_equal(values(triangle, "indices"), [3, 2, 4])

    def test_a_cylinder_has_its_side_along_its_axis_and_ends_that_face_outwards(self):
        start, end = np.array([1.0, -2.0, 0.5]), np.array([2.0, 1.0, -1.5])
        side, low, high = shape(Cylinder(tuple(start), tuple(end), 0.75))
        length = np.linalg.norm(end - start)
        for line, origin, axis in ((side, start, end - start), (low, start, start - end), (high, end, end - start)):
            matrix = np.array(re.search(r"ConcatTransform \[ ([^\]]*) \]", line).group(1).split(), float).reshape(4, 4).T
            np.testing.assert_allclose(matrix @ [0, 0, 0, 1], [*origin, 1], atol=1e-8)
            np.testing.assert_allclose(matrix @ [0, 0, length, 1], [*(origin + axis), 1], atol=1e-8)
            np.testing.assert_allclose(np.linalg.det(matrix), 1)
        self.assertAlmostEqual(values(side, "zmax")[0], length, places=8)

    def test_a_disk_faces_its_normal(self):
        (line,) = shape(Disk((1.0, 2.0, 3.0), (0.0, -0.6, 0.8), 0.3))
        matrix = np.array(re.search(r"ConcatTransform \[ ([^\]]*) \]", line).group(1).split(), float).reshape(4, 4).T
        np.testing.assert_allclose(matrix @ [0, 0, 1, 0], [0, -0.6, 0.8, 0], atol=1e-9)


class Files(unittest.TestCase):
    def test_the_window_has_square_pixels_and_the_right_hand_is_turned(self):
        text = scene_text(order(), integrator_line(order()), "film.exr")
        np.testing.assert_allclose(values(text, "screenwindow"), [-1, 1, -0.5, 0.5])
        self.assertLess(text.index("Scale -1 1 1"), text.index("LookAt"))
        self.assertEqual(text.count("AttributeBegin"), text.count("AttributeEnd"))

    def test_seeds_give_other_files_for_every_integrator(self):
        for name in INTEGRATORS:
            first, second = (scene_text(order(name, seed), integrator_line(order(name, seed)).replace("\n", ""), "film.exr").splitlines()[:2] for seed in (0, 1))
            self.assertNotEqual(first[0] if name == "mlt" else first[1], second[0] if name == "mlt" else second[1])
            self.assertIn(REFERENCE[name], INTEGRATORS)

    def test_first_samples_of_metropolis_stay_near_those_shipped_and_differ_within_a_session(self):
        def first(seed):
            return int(values(integrator_line(order("mlt", seed)), "bootstrapsamples")[0])

        for seed in (*range(120), *range(990, 1101)):
            self.assertTrue(FIRST_SAMPLES <= first(seed) < 1.1 * FIRST_SAMPLES, seed)
        # A session takes one seed more where one of its own is taken.
        seeds = [*range(FIRST_OF_CONVERGED, FIRST_OF_CONVERGED + RUNS), *range(FIRST_SEED, FIRST_SEED + REPEATS * POINTS + 1)]
        self.assertEqual(len({first(seed) for seed in seeds}), len(seeds))

    def test_samples_that_are_told_are_those_that_are_taken(self):
        taken = {name: [spp_taken(replace(order(name), spp=spp)) for spp in (1, 2, 3, 64, 100, 127)] for name in INTEGRATORS}
        self.assertEqual(taken, {"path": [1, 2, 2, 64, 64, 64], "bdpt": [1, 2, 2, 64, 64, 64], "mlt": [1, 2, 3, 64, 100, 127]})

    def test_luminance_of_the_film_is_the_weighted_sum_of_its_channels(self):
        with tempfile.TemporaryDirectory() as folder:
            pixels = np.random.default_rng(1).random((4, 5, 3)) * 100
            write_exr(Path(folder) / "film.exr", dict(zip("RGB", np.moveaxis(pixels, -1, 0))))
            found = read_xyz(Path(folder) / "film.exr")
        np.testing.assert_allclose(found[..., 1], pixels @ [0.212671, 0.715160, 0.072169], rtol=1e-4)


class Failures(unittest.TestCase):
    def answered(self, script, asked):
        """The answer of `render` by a program that is this shell script."""
        with tempfile.TemporaryDirectory() as folder:
            program = Path(folder) / "pbrt-r4"
            program.write_text(f"#!/bin/sh\n{script}\n")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            before = os.environ.get(PROGRAM)
            os.environ[PROGRAM] = str(program)
            self.addCleanup(lambda: os.environ.pop(PROGRAM) if before is None else os.environ.update({PROGRAM: before}))
            return render(asked)

    def refused(self, script):
        """The error of a run of a program that is this shell script."""
        with self.assertRaises(InputError) as caught:
            self.answered(script, order())
        return str(caught.exception)

    def test_an_answer_tells_the_samples_of_its_sampler(self):
        with tempfile.TemporaryDirectory() as folder:
            film = Path(folder) / "made.exr"
            write_exr(film, {name: np.ones((16, 32)) for name in "RGB"})
            script = f"""for word; do file=$word; done\ncp '{film}' "$(sed -n 's/.*"string filename" . "\\([^"]*\\)".*/\\1/p' "$file")" """
            told = {name: self.answered(script, replace(order(name), spp=100)).spp for name in INTEGRATORS}
        self.assertEqual(told, {"path": 64.0, "bdpt": 64.0, "mlt": 100.0})

    def test_a_program_that_fails_is_told_with_its_last_words(self):
        self.assertIn("no such shape", self.refused("echo first >&2; echo no such shape >&2; exit 1"))

    def test_a_program_that_writes_no_picture_has_failed(self):
        said = self.refused("exit 0")
        self.assertIn("failed", said)
        self.assertNotIn("\n", said)


if __name__ == "__main__":
    unittest.main()
