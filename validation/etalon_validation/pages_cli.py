"""Subcommands that write pages: exposure, bands, cross-prediction, index, and the photographs of a folder."""

import json
import sys
from pathlib import Path

from .errors import InputError

# Samples per pixel of each basis picture of a cross-prediction.
CROSS_SPP = 128


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

    cross = commands.add_parser("cross-predict", help="fit what is unknown on one photograph and predict another")
    cross.add_argument("--plan", type=Path, required=True, help="cross.json: the two cases, the lamp, the unknowns")
    cross.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    cross.add_argument("--photo", type=Path, nargs=2, metavar=("FITTED", "PREDICTED"), default=(None, None), help="the photographs; without them the region tables stand in")
    cross.add_argument("--spp", type=int, default=CROSS_SPP, help="samples per pixel of each basis picture")
    cross.add_argument("--threads", type=int, help="threads of each render; all processors if left out")
    cross.add_argument("-o", "--output", type=Path, required=True, help="folder for report.json and report.html")
    cross.set_defaults(run=run_cross)

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


def run_cross(chosen):
    """report.json, report.html and what they say."""
    from .basis import Renderer
    from .cross import run

    report = run(chosen.plan, Renderer(chosen.program, chosen.spp, chosen.threads), chosen.photo, chosen.output)
    for line in report["statements"]:
        print(line)


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
