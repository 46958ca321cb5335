"""Subcommands around other renderers: one run of Mitsuba, and the convergence session against it."""

import argparse
from pathlib import Path

from .errors import InputError

# Wall seconds of the session, references apart.
BUDGET_S = 180.0
INTEGRATORS = "path,bdpt,mlt"


def add_peer_commands(commands):
    """Adds them to the subcommands of the program."""
    run = commands.add_parser("mitsuba-render", help="render a scene once with Mitsuba 3, in its own environment")
    run.add_argument("--case", type=Path, required=True, help="case folder with scene.json")
    run.add_argument("--spectra", type=Path, default=Path("spectra"), help="folder of spectral tables")
    run.add_argument("--integrator", default="scalar-path", choices=("scalar-path", "llvm-path", "llvm-ptracer"))
    run.add_argument("--resolution", type=size, required=True, metavar="WxH")
    run.add_argument("--spp", type=int, required=True)
    run.add_argument("--seed", type=int, default=0)
    run.add_argument("--threads", type=int, help="all processors if left out")
    run.add_argument("-o", "--output", type=Path, required=True, help="EXR to write")
    run.add_argument("--times", type=Path, required=True, help="JSON to write: seconds of rendering")
    run.set_defaults(run=run_mitsuba)

    study = commands.add_parser("peers-converge", help="error against run time beside Mitsuba 3, in one paired session")
    study.add_argument("--case", type=Path, required=True, help="case folder with scene.json")
    study.add_argument("--folder", type=Path, required=True, help="folder of validate peers, with both references")
    study.add_argument("--program", type=Path, default=Path("target/release/etalon"), help="the program etalon")
    study.add_argument("--peer-python", type=Path, required=True, help="Python with Mitsuba")
    study.add_argument("--spectra", type=Path, default=Path("spectra"))
    study.add_argument("--integrators", default=INTEGRATORS)
    study.add_argument("--threads", type=int, required=True, help="of every run on both sides")
    study.add_argument("--budget", type=float, default=BUDGET_S, help=f"wall seconds of all runs together; default {BUDGET_S:g}")
    study.set_defaults(run=run_study)


def size(text):
    """WIDTHxHEIGHT as two whole numbers."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise argparse.ArgumentTypeError(f"{text} is no size; give width and height as in 128x128")
    return int(width), int(height)


def run_mitsuba(chosen):
    """One picture and its seconds."""
    from .peer_mitsuba import render_to_file

    render_to_file(chosen.case, chosen.spectra, chosen.resolution, chosen.integrator, chosen.spp, chosen.seed, chosen.threads, chosen.output, chosen.times)


def run_study(chosen):
    """Tables, plot and report.html into the folder, and what they say."""
    from .peer_study import study

    if not chosen.budget > 0:
        raise InputError("--budget", f"is {chosen.budget:g}", "give wall seconds above zero")
    for line in study(chosen):
        print(line)
