"""Which peers there are, and what the session asks of each.

A driver is a module `peer_NAME.py` that imports nothing of its renderer before
it renders:

- `NAME` begins the names of its series, `COMMAND` is its subcommand of this harness.
- `INTEGRATORS` are what `--integrator` takes; `REFERENCE` says for each which of them
  makes the converged picture that it is judged against.
- `ready(target, spectra)` makes or finds what a run needs, below the folder `target`, and
  returns `Ready`; an `InputError` says in one line why the peer is left out.
- `refuses(integrator, scene)` says why an integrator cannot render a scene, or `None`.
- `add_command(commands)` adds the subcommand, which renders once:
  `--case --spectra --resolution --integrator --spp --seed --threads -o EXR --times JSON`.
"""

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


def drivers(names=DRIVERS):
    """The modules of peers."""
    return [importlib.import_module(f".peer_{name}", __package__) for name in names]
