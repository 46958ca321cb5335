"""The subcommand of a peer: the same options and the same files for every one.

It renders once: an EXR in cd/m2, and a JSON with the processor and wall seconds
of the rendering alone, of all threads and child processes. Whatever else the
process takes is loading, as the caller sees from the whole.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_cli import size
from .peer_scene import Scene, Spectra, read_scene


@dataclass(frozen=True)
class Order:
    """What one run is asked for; `observer` holds wavelength in nm and the CIE 1931 functions, (n, 4)."""

    scene: Scene
    observer: np.ndarray
    integrator: str
    spp: int
    seed: int
    threads: int


@dataclass(frozen=True)
class Answer:
    """What one run gives: luminance (height, width) in cd/m2, or XYZ along a third axis, the top row first.

    And what its rendering took, with the samples per pixel as really taken.
    """

    picture: np.ndarray
    cpu_s: float
    wall_s: float
    spp: float


def add_render_command(commands, name, title, integrators, render):
    """Adds the subcommand `name` for a renderer, whose `render` makes an `Answer` of an `Order`."""
    run = commands.add_parser(name, help=f"render a scene once with {title}")
    run.add_argument("--case", type=Path, required=True, help="case folder with scene.json")
    run.add_argument("--spectra", type=Path, default=Path("spectra"), help="folder of spectral tables")
    run.add_argument("--resolution", type=size, metavar="WxH", help="instead of the scene's")
    run.add_argument("--integrator", choices=integrators, required=True)
    run.add_argument("--spp", type=int, required=True, help="samples per pixel")
    run.add_argument("--seed", type=int, default=0)
    run.add_argument("--threads", type=int, required=True)
    run.add_argument("-o", "--output", type=Path, required=True, help="EXR to write")
    run.add_argument("--times", type=Path, required=True, help="JSON to write: seconds of rendering")
    run.set_defaults(run=lambda chosen: fulfil(chosen, render))


def fulfil(chosen, render):
    """One run: the picture and its seconds into their files."""
    from .peer_write import write_luminance, write_xyz

    for option, least in (("spp", 1), ("threads", 1), ("seed", 0)):
        if getattr(chosen, option) < least:
            raise InputError(f"--{option}", f"is {getattr(chosen, option)}", f"give a whole number of at least {least}")
    spectra = Spectra(chosen.spectra)
    scene = read_scene(chosen.case / "scene.json", spectra, chosen.resolution)
    answer = render(Order(scene, spectra.observer, chosen.integrator, chosen.spp, chosen.seed, chosen.threads))
    write = write_luminance if answer.picture.ndim == 2 else write_xyz
    write(chosen.output, finite(answer.picture, chosen.output))
    taken = {"render": {"cpu_s": answer.cpu_s, "wall_s": answer.wall_s}, "spp": answer.spp}
    chosen.times.write_text(json.dumps(taken) + "\n", encoding="utf-8")


def finite(picture, place):
    """The picture, if it is one."""
    lost = picture.size - int(np.isfinite(picture).sum())
    if lost:
        raise InputError(place, f"{lost} values are not finite", "take another seed")
    return picture
