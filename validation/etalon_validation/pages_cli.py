"""Subcommands that write pages: exposure, bands, index, and the photographs of a folder."""

import json
import sys
from pathlib import Path

from .errors import InputError


def add_commands(commands):
    """Adds them to the subcommands of the program."""
    exposure = commands.add_parser("exposure", help="judge how a render is exposed, with nothing fitted")
    exposure.add_argument("--case", type=Path, required=True, help="case folder with scene.json and exposure.json")
    exposure.add_argument("--render", type=Path, required=True)
    exposure.add_argument("--threads", type=int, help="threads that the render ran on, for the report")
    exposure.add_argument("-o", "--output", type=Path, required=True)
    exposure.set_defaults(run=run_exposure)

    bands = commands.add_parser("bands", help="score a render band by band against narrow-band images")
    bands.add_argument("--case", type=Path, required=True, help="case folder with scene.json and bands.json")
    bands.add_argument("--render", type=Path, required=True, help="EXR with a sensor channel per band")
    bands.add_argument("--bands", type=Path, required=True, help="folder of 400nm.exr to 700nm.exr, or the archive")
    bands.add_argument("--points", type=Path, help="vertices picked in the band images, which their camera is fitted to")
    bands.add_argument("-o", "--output", type=Path, required=True)
    bands.set_defaults(run=run_bands)

    index = commands.add_parser("index", help="write the index page over the reports of many cases")
    index.add_argument("-o", "--output", type=Path, required=True, help="folder with a folder per case")
    index.set_defaults(run=run_index)

    photographs = commands.add_parser("find-photographs", help="say which files of a folder are the photographs of which cases")
    photographs.add_argument("--photos", type=Path, required=True)
    photographs.add_argument("--case", action="append", default=[], metavar="NAME=FOLDER", help="a case and its folder with regions.json")
    photographs.set_defaults(run=run_find)


def run_exposure(chosen):
    """report.json, report.html and the verdict."""
    from .exposure_report import exposure_report
    from .index import headline
    from .render import read_render

    print(headline(exposure_report(chosen.case, read_render(chosen.render), chosen.output, chosen.threads)))


def run_bands(chosen):
    """report.json, report.html and a line per band."""
    from .band_report import band_report, describe

    report = band_report(chosen.case, chosen.render, chosen.bands, chosen.points, chosen.output)
    for warning in report["reference"]["warnings"]:
        print(f"warning: {warning}", file=sys.stderr)
    print(describe(report))


def run_index(chosen):
    """index.json and index.html from the rows on standard input."""
    from .index import write_index

    write_index(chosen.output, sys.stdin.read())


def run_find(chosen):
    """A JSON object on standard output: file by case."""
    from .index import find_photographs

    pairs = [text.partition("=") for text in chosen.case]
    for name, sign, _ in pairs:
        if not (name and sign):
            raise InputError("--case", f'"{name}" names no folder', "write NAME=FOLDER")
    print(json.dumps(find_photographs(chosen.photos, {name: folder for name, _, folder in pairs})))
