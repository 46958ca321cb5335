"""pbrt-r4 as a peer, a spectral renderer after pbrt-v4: path tracing, bidirectional, and Metropolis.

It is built from its published source without default features. Its
bidirectional algorithms have no roulette and end paths as `peer_depth.py` says.
Metropolis takes no seed: the number of its first samples, from which the chains
are begun, stands for one. Processor seconds are those of its process, less those
of a run of one pixel and one sample, which reads the same scene.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_command import Answer, fulfil
from .peer_depth import bounces
from .peer_driver import HARNESS_ENVIRONMENT, Ready, add_render_command
from .peer_environment import cargo_program
from .peer_pbrt_scene import scene_text

NAME = "pbrt"
TITLE = "pbrt-r4"
COMMAND = "pbrt-render"
CRATE, VERSION = "pbrt-r4", "4.5.2"
PROGRAM = "ETALON_PBRT"
INTEGRATORS = ("path", "bdpt", "mlt")
REFERENCE = {"path": "path", "bdpt": "bdpt", "mlt": "bdpt"}
# Reflections after which paths end: those of the path tracer long after its roulette has ended them.
MOST_BOUNCES = 64
# What of the integrators takes the same seconds for however few samples.
SETUP = ("mlt",)
# First samples of Metropolis, as shipped, and how many more a seed of one takes. After so many seeds they begin again, so that
# none takes a tenth more; those of a session, from 999, and those of converged pictures, from 1, fall on different numbers.
FIRST_SAMPLES, SEED_STEP, SEEDS = 100_000, 97, 103
# XYZ from the linear RGB of its film: the inverse of the matrix that it writes by.
RGB_FROM_XYZ = np.array([[3.240479, -1.537150, -0.498535], [-0.969256, 1.875991, 0.041556], [0.055648, -0.204043, 1.057311]])
NOTES = (
    "pbrt-r4's `bdpt` and `mlt` lose light that is reflected three times or more, beside its own path tracer at the same depth (2.7 % of the Cornell box, 6 % of its walls); they are judged against a picture of their own.",
    "pbrt-r4's bidirectional algorithms end paths after a number of reflections that leaves out under 0.4 % of the picture.",
    "pbrt-r4's seconds are those of its process less those of a run of one pixel.",
)


def ready(target, spectra):
    """Its program, built if need be; this Python drives it. It asks nothing of the spectra."""
    del spectra
    program = cargo_program(target, "pbrt-r4", CRATE, VERSION, ("--no-default-features",))
    return Ready((sys.executable, "-m", "etalon_validation"), HARNESS_ENVIRONMENT | {PROGRAM: str(program)}, f"{CRATE} {VERSION}", NOTES)


def refuses(integrator, scene):
    """Nothing is refused."""
    del integrator, scene


def add_command(commands):
    """Adds the subcommand that renders once."""
    add_render_command(commands, COMMAND, TITLE, INTEGRATORS, lambda chosen: fulfil(chosen, render))


def integrator_line(order):
    """The line of the scene file that chooses the integrator."""
    if order.integrator == "path":
        return f'Integrator "path" "integer maxdepth" [ {MOST_BOUNCES} ]'
    line = f'Integrator "{order.integrator}" "integer maxdepth" [ {bounces(order.scene)} ]'
    if order.integrator == "mlt":
        line += f' "integer mutationsperpixel" [ {order.spp} ] "integer bootstrapsamples" [ {first_samples(order.seed)} ]'
    return line


def first_samples(seed):
    """How many first samples of Metropolis stand for a seed."""
    return FIRST_SAMPLES + SEED_STEP * (seed % SEEDS)


def render(order):
    """The `Answer` to an `Order`."""
    program = os.environ.get(PROGRAM)
    if not program:
        raise InputError(PROGRAM, "is not set", "set it to the program pbrt-r4")
    with tempfile.TemporaryDirectory() as folder:
        film, file = Path(folder) / "film.exr", Path(folder) / "scene.pbrt"
        file.write_text(scene_text(order, integrator_line(order), film), encoding="utf-8")
        whole = timed(program, file, film, order.threads)
        # Loading is the same for every integrator; that of the path tracer does nothing before its first sample.
        small = replace(order, integrator="path", spp=1)
        file.write_text(scene_text(small, integrator_line(small), Path(folder) / "pixel.exr"), encoding="utf-8")
        loading = timed(program, file, Path(folder) / "pixel.exr", order.threads, "--cropwindow", one_pixel(order.scene.camera))
        return Answer(read_xyz(film), max(whole[0] - loading[0], 0.0), max(whole[1] - loading[1], 0.0), float(spp_taken(order)))


def spp_taken(order):
    """Samples per pixel that are really taken: `zsobol` goes down to a power of two, mutations are as many as asked for."""
    return order.spp if order.integrator == "mlt" else 1 << (order.spp.bit_length() - 1)


def one_pixel(camera):
    """The window of the first pixel."""
    width, height = camera.resolution
    return f"0,{1 / width:.9g},0,{1 / height:.9g}"


def timed(program, file, film, threads, *words):
    """Processor seconds of the program and its wall seconds; its picture has to be there in the end."""
    before, began = children_cpu_s(), time.monotonic()
    done = subprocess.run([program, "--quiet", "--nthreads", str(threads), *words, str(file)], capture_output=True, text=True, check=False)
    taken = children_cpu_s() - before, time.monotonic() - began
    if done.returncode or not film.is_file():
        said = [line.strip() for line in (done.stderr or done.stdout).splitlines() if line.strip()]
        raise InputError(CRATE, f"failed ({said[-1] if said else f'exit code {done.returncode}'})", "see whether its scene file holds what it understands")
    return taken


def children_cpu_s():
    """Processor seconds of all child processes that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def read_xyz(path):
    """XYZ of the renderer's film, Y in cd/m2."""
    import OpenImageIO as oiio

    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise InputError(path, "cannot be read", "see what pbrt-r4 has written")
    names, pixels = image.spec().channelnames, image.read_image("float").astype(float)
    image.close()
    return pixels[..., [names.index(name) for name in "RGB"]] @ np.linalg.inv(RGB_FROM_XYZ).T
