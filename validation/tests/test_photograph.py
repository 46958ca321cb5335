"""Photographs as people have them: RAW values to rounding, saturation, warnings, and the lens taken out."""

import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import image as mpl_image

from etalon_validation.errors import InputError
from etalon_validation.lens import corrected, grid
from etalon_validation.photograph import Photograph, encoding_warning, read_photograph
from etalon_validation.regions import measure

from .dng import write_dng
from .room import nominal, write_photo

BLACK, WHITE = 512, 16383
# Counts of the flat field's red, green and blue photosites.
COUNTS = (4200, 9000, 2500)


def mosaic(size=(64, 48)):
    """A flat RGGB mosaic (h, w) of COUNTS."""
    counts = np.empty((size[1], size[0]), int)
    counts[::2, ::2], counts[::2, 1::2], counts[1::2, ::2], counts[1::2, 1::2] = COUNTS[0], COUNTS[1], COUNTS[1], COUNTS[2]
    return counts


class Raw(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def read(self, counts, **more):
        """The photograph of a mosaic."""
        write_dng(self.folder / "photo.dng", counts, BLACK, WHITE, **more)
        return read_photograph(self.folder / "photo.dng")

    def test_values_are_counts_over_black_to_rounding(self):
        photograph = self.read(mosaic())
        self.assertEqual(photograph.size, (64, 48))
        wanted = (np.array(COUNTS) - BLACK) / (WHITE - BLACK)
        # LibRaw scales whole counts to 16 bits: half a step of each.
        np.testing.assert_allclose(photograph.rgb[8:-8, 8:-8], np.broadcast_to(wanted, (32, 48, 3)), atol=1.5 / 65535)
        self.assertFalse(photograph.saturated.any())

    def test_brightness_does_not_depend_on_the_rest_of_the_picture(self):
        dim = mosaic()
        bright = dim.copy()
        bright[:, 40:] = 15000
        np.testing.assert_allclose(self.read(dim).rgb[8:-8, 8:24], self.read(bright).rgb[8:-8, 8:24], atol=1e-9)

    def test_exposure_is_read(self):
        facts = self.read(mosaic()).exposure
        self.assertEqual((facts["iso"], facts["f_stop"], facts["focal_length_mm"]), (400, 5.6, 35))
        # The rational in the file is 167/10000 s.
        self.assertAlmostEqual(facts["shutter_s"], 1 / 60, delta=5e-5)

    def test_saturated_photosites_are_marked_and_left_out_of_means(self):
        counts = mosaic()
        counts[20:24, 20:30] = WHITE
        photograph = self.read(counts)
        self.assertTrue(photograph.saturated[20:24, 20:30].all())
        self.assertFalse(photograph.saturated[30:, :].any())
        square = [[10, 10], [50, 10], [50, 40], [10, 40]]
        region = measure(photograph, "middle", "wall", square)
        self.assertEqual(region.saturated, int(photograph.saturated[10:40, 10:50].sum()))
        self.assertEqual(region.pixels + region.saturated, 40 * 30)
        np.testing.assert_allclose(region.rgb, (np.array(COUNTS) - BLACK) / (WHITE - BLACK), atol=1.5 / 65535)

    def test_a_turned_camera_turns_picture_and_mask_together(self):
        counts = mosaic()
        counts[4:8, 4:8] = WHITE
        photograph = self.read(counts, orientation=6)
        self.assertEqual(photograph.size, (48, 64))
        self.assertEqual(photograph.saturated.shape, (64, 48))
        brightest = np.argwhere(photograph.rgb[..., 0] > 0.9)
        self.assertTrue(len(brightest) and photograph.saturated[tuple(brightest.T)].all())

    def test_a_file_that_is_no_raw_is_refused(self):
        (self.folder / "photo.dng").write_bytes(b"II*\0 nothing")
        with self.assertRaisesRegex(InputError, "photo.dng.*cannot be decoded"):
            read_photograph(self.folder / "photo.dng")


class Coded(unittest.TestCase):
    def test_gamma_coded_pictures_are_warned_of_and_their_full_scale_is_saturated(self):
        with tempfile.TemporaryDirectory() as folder:
            values = np.full((20, 30, 3), 128, np.uint8)
            values[5, 7] = (255, 10, 10)
            for name in ("photo.png", "photo.jpg"):
                mpl_image.imsave(Path(folder) / name, values)
                photograph = read_photograph(Path(folder) / name)
                self.assertIn("chromaticity and structure", encoding_warning(photograph.file, photograph.encoding))
                if name.endswith("png"):
                    self.assertEqual(np.argwhere(photograph.saturated).tolist(), [[5, 7]])
            write_photo(Path(folder) / "photo.exr", np.full((4, 4, 3), 2.0))
            linear = read_photograph(Path(folder) / "photo.exr")
            self.assertIsNone(encoding_warning(linear.file, linear.encoding))
            self.assertIsNone(linear.saturated)


class Lens(unittest.TestCase):
    def setUp(self):
        self.camera = nominal()
        self.even = Photograph(np.full((*self.camera.size[::-1], 3), 0.5), "even", "", "linear")

    def test_cos4_at_a_known_angle(self):
        record = {"camera": {"vignetting": {"model": "cos4"}}}
        divided = corrected(self.even, self.camera, record).rgb[..., 0]
        row, column = 30, 200
        cosine = self.camera.rays([[column + 0.5, row + 0.5]])[0] @ self.camera.look
        self.assertAlmostEqual(divided[row, column], 0.5 / cosine**4, places=12)

    def test_a_radial_table_in_millimetres_and_degrees(self):
        for coordinate, end in (("radius_mm", 50.0), ("angle_deg", 45.0)):
            vignetting = {"model": "radial_table", "coordinate": coordinate, "at": [0, end], "relative_illuminance": [1, 0.5]}
            record = {"camera": {"focal_length_mm": 48.0, "image_distance_mm": 50.0, "vignetting": vignetting}}
            divided = corrected(self.even, self.camera, record).rgb[10, 20, 0]
            plane = np.linalg.norm(self.camera.straightened([[20.5, 10.5]]))
            share = plane if coordinate == "radius_mm" else np.degrees(np.arctan(plane)) / 45
            self.assertAlmostEqual(divided, 0.5 / (1 - 0.5 * share), places=9)

    def test_a_measured_flat_field_is_divided_out(self):
        falling = 1 - 0.5 * (np.linalg.norm(grid(self.camera.size) - np.array(self.camera.size) / 2, axis=1) / 150) ** 2
        falling = falling.reshape(*self.camera.size[::-1], 1)
        with tempfile.TemporaryDirectory() as folder:
            write_photo(Path(folder) / "flat.exr", np.repeat(0.3 * falling, 3, axis=2))
            photograph = corrected(replace(self.even, rgb=self.even.rgb * falling), self.camera, flat_field=Path(folder) / "flat.exr")
        np.testing.assert_allclose(photograph.rgb[10:-10, 10:-10], 0.5, rtol=2e-3)
        self.assertEqual(photograph.corrections, ("divided by flat field flat.exr",))

    def test_no_vignetting_leaves_the_photograph_alone(self):
        self.assertIs(corrected(self.even, self.camera, {"camera": {"vignetting": {"model": "none"}}}), self.even)
        self.assertIs(corrected(self.even, self.camera, {}), self.even)

    def test_an_unknown_model_is_refused(self):
        with self.assertRaisesRegex(InputError, "odd"):
            corrected(self.even, self.camera, {"camera": {"vignetting": {"model": "odd"}}})

    def test_distortion_is_undone(self):
        bent = replace(self.camera, k1=-0.1)
        # A picture whose value is a smooth function of the ray, taken through the distorting lens and through the pinhole.
        scenes = [np.sin(6 * camera.rays(grid(camera.size)))[:, :2].sum(axis=1).reshape(*camera.size[::-1], 1) for camera in (bent, self.camera)]
        photograph = corrected(replace(self.even, rgb=np.repeat(scenes[0], 3, axis=2)), bent)
        np.testing.assert_allclose(photograph.rgb[20:-20, 20:-20, 0], scenes[1][20:-20, 20:-20, 0], atol=2e-3)


if __name__ == "__main__":
    unittest.main()
