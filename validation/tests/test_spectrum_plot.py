"""Drawings of spectral tables, and the files that cannot be drawn to."""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

from etalon_validation.cli import main
from etalon_validation.spectrum_plot import patch_colour, read_table, refractive_index

SPECTRA = Path(__file__).resolve().parents[2] / "spectra"


def request(kind, name):
    """What the program sends for a built-in table."""
    return json.dumps({"name": name, "kind": kind, "csv": (SPECTRA / kind / f"{name}.csv").read_text(encoding="utf-8"), "description": ["unit       one"]})


def draw(text, file):
    """Exit code and stderr of one drawing."""
    with contextlib.redirect_stderr(io.StringIO()) as err, mock.patch("sys.stdin", io.StringIO(text)):
        return main(["plot-spectrum", str(file)]), err.getvalue()


class SpectrumPlot(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)

    def test_one_table_of_every_kind_is_drawn(self):
        for kind in sorted(path.name for path in SPECTRA.iterdir() if path.is_dir() and any(path.glob("*.csv"))):
            name = min(path.stem for path in (SPECTRA / kind).glob("*.csv"))
            for ending in ("svg", "png"):
                file = self.folder / f"{name}.{ending}"
                self.assertEqual(draw(request(kind, name), file), (0, ""), f"{kind} {name}")
                self.assertGreater(file.stat().st_size, 5000)

    def test_the_same_request_gives_the_same_file(self):
        files = [self.folder / "first.svg", self.folder / "second.svg"]
        for file in files:
            draw(request("illuminant", "d65"), file)
        self.assertEqual(files[0].read_bytes(), files[1].read_bytes())

    def test_files_that_cannot_be_drawn_to_are_one_line(self):
        for file, saying in ((self.folder / "d65.jpg", ".svg or .png"), (self.folder / "d65", ".svg or .png"), (self.folder / "no" / "d65.svg", "no such folder")):
            code, err = draw(request("illuminant", "d65"), file)
            self.assertEqual((code, err.count("\n")), (2, 1), err)
            self.assertIn(saying, err)

    def test_requests_that_are_none_are_one_line(self):
        for text in ("", "[]", "{}", json.dumps({"name": "x", "kind": "glass", "csv": "a,b\n1\n", "description": []})):
            code, err = draw(text, self.folder / "x.svg")
            self.assertEqual((code, err.count("\n")), (2, 1), err)

    def test_bk7_has_its_catalogue_index(self):
        """SCHOTT: n_d = 1.51680."""
        table = read_table((SPECTRA / "glass" / "n-bk7.csv").read_text(encoding="utf-8"), "n-bk7")
        self.assertAlmostEqual(float(np.interp(587.5618, np.arange(360, 831), refractive_index(table))), 1.51680, places=5)

    def test_a_perfect_diffuser_is_white(self):
        nm = np.array([360.0, 830.0])
        np.testing.assert_allclose(patch_colour("reflectance", nm, {"value": np.ones(2)}), 1, atol=2e-3)


if __name__ == "__main__":
    unittest.main()
