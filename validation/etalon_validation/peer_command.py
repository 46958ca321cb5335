"""What one run of a peer is asked and answers, apart from the renderer: files in, files out.

Out come an EXR in cd/m2, and a JSON with the processor and wall seconds of the
rendering alone, of all threads and child processes. Whatever else the process
takes is loading, as the caller sees from the whole.
"""

import json
import os
from dataclasses import dataclass

import numpy as np

from .errors import InputError
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


def fulfil(chosen, render):
    """One run: the picture and its seconds into the files that the arguments name; `render` makes an `Answer` of an `Order`."""
    from .peer_write import write_luminance, write_xyz

    threads = os.cpu_count() if chosen.threads is None else chosen.threads
    for option, number, least in (("spp", chosen.spp, 1), ("threads", threads, 1), ("seed", chosen.seed, 0)):
        if number < least:
            raise InputError(f"--{option}", f"is {number}", f"give a whole number of at least {least}")
    spectra = Spectra(chosen.spectra)
    scene = read_scene(chosen.case / "scene.json", spectra, chosen.resolution)
    answer = render(Order(scene, spectra.observer, chosen.integrator, chosen.spp, chosen.seed, threads))
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
