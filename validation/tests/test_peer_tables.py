"""Tables of peers: what is understood, and that each fault is told with its line and column."""

import tempfile
import unittest
from pathlib import Path

from etalon_validation.errors import InputError
from etalon_validation.peer_series import peer_options
from etalon_validation.peer_table import read_table, write_table

HEAD = "cpu_seconds,file"


class Tables(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        (self.folder / "sub").mkdir()
        for name in ("a.exr", "b.exr", "c.exr", "d.exr", "e, f.exr", "sub/g.exr"):
            (self.folder / name).write_bytes(b"")

    def read(self, *lines):
        table = self.folder / "peer.csv"
        table.write_text("\n".join(lines) + "\n", encoding="utf-8")
        return read_table("other", table)

    def refused(self, *lines, at, saying):
        with self.assertRaises(InputError) as caught:
            self.read(*lines)
        place = f"{self.folder / 'peer.csv'}{at}: "
        self.assertTrue(str(caught.exception).startswith(place), f"{caught.exception}\nnot at {place}")
        self.assertIn(saying, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_seconds_and_files_relative_to_the_table_are_read(self):
        table = self.read("\ufeff# by hand", " cpu_seconds , file,wall_seconds", "", '4.5,"e, f.exr",3', "1,sub/g.exr,", "reference,a.exr,")
        self.assertEqual([[row.cpu_s for row in point] for point in table.points], [[1.0], [4.5]])
        self.assertEqual([row.wall_s for row in table.rows], [None, 3.0])
        self.assertEqual(table.rows[1].file, self.folder / "e, f.exr")
        self.assertEqual(table.reference, self.folder / "a.exr")

    def test_near_equal_seconds_are_repeats_and_doubled_ones_are_not(self):
        table = self.read(HEAD, "2.1,c.exr", "1.1,b.exr", "1.0,a.exr", "1.9,d.exr")
        self.assertEqual([[row.cpu_s for row in point] for point in table.points], [[1.0, 1.1], [1.9, 2.1]])

    def test_samples_per_pixel_say_what_repeats_are_where_seconds_do_not(self):
        lines = ["1.0,a.exr", "1.2,b.exr", "1.4,c.exr", "1.7,d.exr"]
        self.refused(HEAD, *lines, at=":5:1", saying='"spp"')
        table = self.read(HEAD + ",spp", *(f"{line},{spp}" for line, spp in zip(lines, (8, 16, 8, 16))))
        self.assertEqual([[(row.spp, row.cpu_s) for row in point] for point in table.points], [[(8, 1.0), (8, 1.4)], [(16, 1.2), (16, 1.7)]])

    def test_loading_is_told_apart(self):
        row = self.read(HEAD + ",load_cpu_seconds", "3,a.exr,1.25").rows[0]
        self.assertEqual((row.cpu_s, row.load_cpu_s), (3, 1.25))
        self.refused(HEAD + ",load_cpu_seconds", "3,a.exr,3", at=":2:9", saying="hold the loading too")

    def test_a_table_that_was_written_is_read_again(self):
        write_table(self.folder / "peer.csv", [{"cpu_seconds": 1.5, "file": "e, f.exr", "spp": 4}, {"cpu_seconds": "reference", "file": "a.exr"}])
        table = read_table("other", self.folder / "peer.csv")
        self.assertEqual((table.rows[0].file.name, table.rows[0].spp, table.reference.name), ("e, f.exr", 4, "a.exr"))

    def test_faults_are_told_where_they_stand(self):
        self.refused("", at="", saying="is empty")
        self.refused(HEAD, at="", saying="lists no picture")
        self.refused(HEAD, "reference,a.exr", at="", saying="lists no picture")
        self.refused("cpu_second,file", at=":1:1", saying='did you mean "cpu_seconds"?')
        self.refused("file,seconds", at=":1:6", saying='unknown column "seconds"')
        self.refused("file", at=":1:1", saying='column "cpu_seconds" is missing')
        self.refused("file,cpu_seconds,file", at=":1:18", saying="is there twice")
        self.refused("# c", HEAD, "1,a.exr", "1.5 s,b.exr", at=":4:1", saying='"1.5 s" is no number')
        self.refused(HEAD, '"1,5",a.exr', at=":2:1", saying='"1,5" is no number')
        for seconds in ("0", "-1", "nan", "inf"):
            self.refused(HEAD, f"  {seconds},a.exr", at=":2:3", saying=f"cpu_seconds is {seconds}")
        self.refused(HEAD, ",a.exr", at=":2:1", saying="no processor seconds")
        self.refused(HEAD, "1,z.exr", at=":2:3", saying="there is no file")
        self.refused(HEAD, "1,", at=":2:3", saying="names no file")
        self.refused(HEAD, "1", at=":2:1", saying="has 1 cells, the header 2")
        self.refused(HEAD, "1,a.exr,2", at=":2:9", saying="has 3 cells, the header 2")
        self.refused(HEAD, "1,a.exr", "2,sub/../a.exr", at=":3:1", saying="again")
        self.refused(HEAD, "1,a.exr", "reference,b.exr", "reference,c.exr", at=":4:11", saying="second reference")
        self.refused(HEAD + ",spp", "1,a.exr,1.5", at=":2:9", saying="spp is 1.5")
        self.refused(HEAD + ",spp", "1,a.exr,2", "2,b.exr,", at=":3:1", saying="has no spp")
        self.refused(HEAD + ",scale", "1,a.exr,0", at=":2:9", saying="scale is 0")

    def test_files_that_are_no_tables_are_refused(self):
        with self.assertRaisesRegex(InputError, "no such file"):
            read_table("other", self.folder / "none.csv")
        (self.folder / "peer.csv").write_bytes(b"\xff\xfe\x00")
        with self.assertRaisesRegex(InputError, "cannot be read"):
            read_table("other", self.folder / "peer.csv")


class Options(unittest.TestCase):
    def test_options_meet_by_name(self):
        (found,) = peer_options(["lux=a=b.csv"], ["lux=2.5"], ["lux=r.exr"])
        self.assertEqual((found.name, found.file, found.scale, found.reference), ("lux", Path("a=b.csv"), 2.5, Path("r.exr")))

    def test_wrong_options_are_named(self):
        for words, saying in (
            ((["a.csv"], None, None), "is not NAME=FILE.csv"), ((["=a.csv"], None, None), "is not NAME=FILE.csv"), ((["x=a.csv", "x=b.csv"], None, None), "given twice"),
            ((["x=a.csv"], ["y=2"], None), 'no peer "y"'), ((["x=a.csv"], ["x=-2"], None), "no positive number"), ((["x=a.csv"], ["x=inf"], None), "no positive number"),
            ((["x=a.csv"], ["x=two"], None), "no positive number"), ((None, None, ["x=r.exr"]), 'no peer "x"'),
        ):
            with self.subTest(words), self.assertRaises(InputError) as caught:
                peer_options(*words)
            self.assertIn(saying, str(caught.exception))


if __name__ == "__main__":
    unittest.main()
