"""Environments of peers: made once, made anew for other pins, and one line where they cannot be made."""

import os
import stat
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from etalon_validation.errors import InputError
from etalon_validation.peer_environment import cargo_program, finish, making

# A cargo that writes down its words and puts a program where --root says.
CARGO = """#!/bin/sh
echo "$@" >> {log}
while [ "$1" != --root ]; do shift; done
mkdir -p "$2/bin" && touch "$2/bin/renderer"
"""


class Environments(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.target = Path(folder.name)

    def cargo(self, script):
        """Puts a script in the place of cargo."""
        file = self.target / "cargo.sh"
        file.write_text(script)
        file.chmod(file.stat().st_mode | stat.S_IXUSR)
        patch = mock.patch.dict(os.environ, {"CARGO": str(file)})
        patch.start()
        self.addCleanup(patch.stop)

    @mock.patch("etalon_validation.peer_environment.say", lambda words: None)
    def test_a_program_is_built_once_and_again_for_another_version(self):
        log = self.target / "log"
        self.cargo(CARGO.format(log=log))
        for version in ("1.0.0", "1.0.0", "1.0.1", "1.0.1"):
            program = cargo_program(self.target, "here", "renderer", version, ("--no-default-features",))
            self.assertEqual(program, self.target / "here" / "bin" / "renderer")
        built = log.read_text().splitlines()
        self.assertEqual([line.split()[3] for line in built], ["1.0.0", "1.0.1"])
        self.assertTrue(all("--no-default-features" in line and "--locked" in line for line in built))

    @mock.patch("etalon_validation.peer_environment.say", lambda words: None)
    def test_a_build_that_fails_is_one_line_and_is_tried_again(self):
        self.cargo("#!/bin/sh\necho warning >&2; echo no network >&2; echo >&2; exit 101\n")
        for _ in range(2):
            with self.assertRaises(InputError) as caught:
                cargo_program(self.target, "here", "renderer", "1.0.0")
            self.assertIn("no network", str(caught.exception))
            self.assertNotIn("\n", str(caught.exception))

    def test_a_missing_tool_is_one_line(self):
        with self.assertRaises(InputError) as caught:
            finish([self.target / "nowhere" / "cargo"], self.target, "install it")
        self.assertIn("cargo", str(caught.exception))

    def test_what_was_not_finished_is_not_taken_for_made(self):
        place = self.target / "place"
        with self.assertRaises(RuntimeError), making(place, "one", "stamp"):
            raise RuntimeError
        for expected in (False, True):
            with making(place, "one", "stamp") as is_made:
                self.assertEqual(is_made, expected)
        with making(place, "two", "stamp") as is_made:
            self.assertFalse(is_made)


if __name__ == "__main__":
    unittest.main()
