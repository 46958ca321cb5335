"""Many studies on one sheet: what the table says of two made by hand, one of them with figures that could not be had."""

import json
import tempfile
import unittest
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from etalon_validation.converge_analysis import analyse
from etalon_validation.converge_data import Estimate, Flag
from etalon_validation.converge_overview import write_overview
from etalon_validation.converge_report import finite
from etalon_validation.errors import InputError

from .convergence import reference, series

FACTS = {"date": "2026-01-02", "git_hash": "0123456789abcdef", "machine": {"cpu": "a processor", "processors": 2}, "threads": None, "size": [40, 40], "repeats": 6}


def write_study(folder, reports):
    """`converge.json` as a study writes it."""
    folder.mkdir()
    told = FACTS | {"series": {report.name: asdict(report) for report in reports}}
    (folder / "converge.json").write_text(json.dumps(finite(told), allow_nan=False))


class Overview(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))
        generator = np.random.default_rng(61)
        path, bdpt = analyse([series(generator, "path", 0.5), series(generator, "bdpt", 1.0)], reference(generator))
        one = Estimate(1.0, 1.0, 1.0)
        path = replace(path, ratio_to_best=one, ratio_to_best_trimmed=Estimate(0.5, 0.25, 0.75), flags=())
        bdpt = replace(bdpt, ratio_to_best=Estimate(0.123, 0.1, 0.2), ratio_to_best_trimmed=one, flags=(Flag("bias floor", "why"), Flag("flat slope", "why")))
        write_study(self.folder / "box", [bdpt, path])
        # A peer of one run a point has no interval, and an integrator that found no light no efficiency.
        peer = replace(bdpt, name="a peer", ratio_to_best=Estimate(0.4, 0.0, np.inf), ratio_to_best_trimmed=None, flags=())
        write_study(self.folder / "lamp", [path, peer])

    def test_sheet_and_table_are_written(self):
        paths = write_overview(self.folder)
        self.assertEqual([path.name for path in paths], ["overview.svg", "overview.png", "overview.md"])
        self.assertEqual(paths[1].read_bytes()[:4], b"\x89PNG")
        self.assertIn("<svg", paths[0].read_text())
        self.assertEqual(paths[2].read_text().splitlines(), [
            "| scene | path | bdpt | a peer |",
            "|---|---|---|---|",
            "| box | **1** / 0.5 [0.25, 0.75] | 0.12 [0.1, 0.2] / **1** (bias floor) |  |",
            "| lamp | **1** / 0.5 [0.25, 0.75] |  | 0.4 [-] / - |",
        ])

    def test_what_is_no_study_is_named(self):
        for content in ("{", "{}", "[]"):
            (self.folder / "lamp" / "converge.json").write_text(content)
            with self.assertRaisesRegex(InputError, r"lamp/converge.json: is no study"):
                write_overview(self.folder)


if __name__ == "__main__":
    unittest.main()
