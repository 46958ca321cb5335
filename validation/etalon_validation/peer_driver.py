"""Which peers there are, and what the session asks of each.

A driver is a module `peer_NAME.py` that imports nothing of its renderer before
it renders:

- `NAME` begins the names of its series, `COMMAND` is its subcommand of this harness.
- `INTEGRATORS` are what `--integrator` takes; `REFERENCE` says for each which of them
  makes the converged picture that it is judged against.
- `SETUP`, if there, are those whose rendering begins with work that does not grow with samples.
- `ready(target, spectra)` makes or finds what a run needs, below the folder `target`, and
  returns `Ready`; an `InputError` says in one line why the peer is left out.
- `refuses(integrator, scene)` says why an integrator cannot render a scene, or `None`.
- `add_command(commands)` adds the subcommand, which renders once:
  `--case --spectra --resolution --integrator --spp --seed --threads -o EXR --times JSON`.
"""

import argparse
import importlib
from dataclasses import dataclass, field
from pathlib import Path

DRIVERS = ("mitsuba", "luxcore", "pbrt")
# What lets another Python run this harness.
HARNESS_ENVIRONMENT = {"PYTHONPATH": str(Path(__file__).parents[1]), "PYTHONDONTWRITEBYTECODE": "1"}


@dataclass(frozen=True)
class Ready:
    """What starts a peer: `words` come before its subcommand, `environment` goes on top of ours.

    `version` names the renderer's version; `notes` are sentences for the report. `unable` holds, by
    integrator, why it cannot run on this machine.
    """

    words: tuple
    environment: dict
    version: str
    notes: tuple = ()
    unable: dict = field(default_factory=dict)


def size(text):
    """WIDTHxHEIGHT as two whole numbers."""
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal() and int(width) and int(height)):
        raise argparse.ArgumentTypeError(f"{text} is no size; give width and height as in 128x128")
    return int(width), int(height)


def add_render_command(commands, command, title, integrators, render):
    """Adds the subcommand of a peer; `render` is called with the chosen arguments."""
    run = commands.add_parser(command, help=f"render a scene once with {title}, in its own environment")
    run.add_argument("--case", type=Path, required=True, help="folder with scene.json")
    run.add_argument("--spectra", type=Path, default=Path("spectra"), help="folder of spectral tables")
    run.add_argument("--integrator", choices=integrators, default=integrators[0])
    run.add_argument("--resolution", type=size, required=True, metavar="WxH")
    run.add_argument("--spp", type=int, required=True, help="samples per pixel")
    run.add_argument("--seed", type=int, default=0)
    run.add_argument("--threads", type=int, help="all processors if left out")
    run.add_argument("-o", "--output", type=Path, required=True, help="EXR to write")
    run.add_argument("--times", type=Path, required=True, help="JSON to write: seconds of rendering")
    run.set_defaults(run=render)


def drivers(names=DRIVERS):
    """The modules of peers."""
    return [importlib.import_module(f".peer_{name}", __package__) for name in names]
