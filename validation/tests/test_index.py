"""The index over many reports, and the photographs that a folder holds."""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from etalon_validation.cli import main

from .case import write_case, write_exr, write_render


def run(words, text=""):
    """Exit code, stdout and stderr of a command with `text` on its standard input."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), mock.patch("sys.stdin", io.StringIO(text)):
        code = main([str(word) for word in words])
    return code, out.getvalue(), err.getvalue()


class Index(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = Path(holder.name)
        self.case = self.folder / "reference"
        self.case.mkdir()
        self.image = write_case(self.case)
        write_render(self.case / "out.exr", self.image / 2**0.7)

    def index(self, *cases):
        """Writes the index of rows (case, status, reason)."""
        rows = [{"case": case, "status": status, "reason": reason} for case, status, reason in cases]
        return run(["index", "-o", self.folder], json.dumps({"version": "0", "command": "etalon <all>", "cases": rows}))

    def test_scores_stand_beside_failures(self):
        words = ["score", "--case", self.case, "--render", self.case / "out.exr", "--photo", self.case / "photo.exr", "-o", self.folder / "patches"]
        self.assertEqual(run(words)[0], 0)
        code, _, err = self.index(("patches", "done", None), ("other", "failed", "no <such> file"), ("third", "skipped", "not at hand"))
        self.assertEqual((code, err), (0, ""))
        index = json.loads((self.folder / "index.json").read_text())
        report = json.loads((self.folder / "patches" / "report.json").read_text())
        row = index["cases"][0]
        for name, level in report["levels"].items():
            for key in ("mean_duv", "rms_stops", "mean_delta_e_2000"):
                self.assertEqual(row["levels"][name][key], level["overall"][key])
        self.assertAlmostEqual(row["exposure_stops"], 0.7, places=3)
        self.assertEqual(index["counts"], {"done": 1, "failed": 1, "skipped": 1})
        page = (self.folder / "index.html").read_text()
        for part in ('href="patches/report.html"', "no &lt;such&gt; file", "etalon &lt;all&gt;", "not at hand", "+0.70"):
            self.assertIn(part, page)
        self.assertEqual(page.count("data:image/png"), 2, "thumbnails of render and photograph")

    def test_a_photograph_of_an_earlier_run_is_not_shown(self):
        words = ["score", "--case", self.case, "--render", self.case / "out.exr", "-o", self.folder / "patches"]
        run([*words, "--photo", self.case / "photo.exr"])
        run(words)
        self.index(("patches", "done", None))
        self.assertEqual((self.folder / "index.html").read_text().count("data:image/png"), 1)

    def test_a_report_that_is_not_there_is_named(self):
        code, _, err = self.index(("patches", "done", None))
        self.assertEqual((code, err.count("\n")), (2, 1))
        self.assertIn("report.json", err)
        self.assertEqual(self.index(("patches", "gone", None))[0], 2)

    def test_photographs_are_known_by_sha256_and_by_name(self):
        photos = self.folder / "photos" / "deep"
        photos.mkdir(parents=True)
        (photos / "anything.exr").write_bytes((self.case / "photo.exr").read_bytes())
        write_exr(photos / "second.exr", 2 * self.image, ["R", "G", "B"])
        second = self.folder / "second"
        second.mkdir()
        write_case(second)
        table = json.loads((second / "regions.json").read_text())
        table["photo"]["sha256"] = "0" * 64
        (second / "regions.json").write_text(json.dumps(table))
        words = ["find-photographs", "--photos", self.folder / "photos", "--case", f"first={self.case}", "--case", f"second={second}"]
        code, out, _ = run(words)
        self.assertEqual((code, json.loads(out)), (0, {"first": str(photos / "anything.exr"), "second": str(photos / "second.exr")}))
        # What is the photograph of one case is not that of another, whatever it is called.
        (photos / "second.exr").write_bytes((self.case / "photo.exr").read_bytes())
        self.assertEqual(list(json.loads(run(words)[1])), ["first"])

    def test_a_folder_without_photographs_is_one_line(self):
        (self.folder / "empty").mkdir()
        for place in ("empty", "nowhere"):
            code, _, err = run(["find-photographs", "--photos", self.folder / place, "--case", f"first={self.case}"])
            self.assertEqual((code, err.count("\n")), (2, 1), err)


if __name__ == "__main__":
    unittest.main()
