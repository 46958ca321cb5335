"""LuxCore as a peer: its path tracer and its bidirectional one, each with Sobol and with Metropolis samples.

LuxCore computes with three channels. They are three bands of luminance here
(`peer_luxcore_bands.py`), so its converged picture is its own reference. Its bidirectional integrator loses no energy to Russian roulette,
which is wrong as shipped, but ends all paths as `peer_depth.py` says. Processor seconds
are those of the threads that render: the thread that waits for them is left out.
"""

import time

import numpy as np

from .errors import InputError
from .peer_command import Answer, fulfil
from .peer_depth import bounces
from .peer_driver import HARNESS_ENVIRONMENT, Ready, add_render_command
from .peer_environment import python_environment
from .peer_luxcore_bands import luminance
from .peer_luxcore_scene import describe

NAME = "luxcore"
TITLE = "LuxCore"
COMMAND = "luxcore-render"
VERSION = "2.11.2"
# Integrator: engine and sampler.
ENGINES = {
    "path": ("PATHCPU", "SOBOL"), "path-metropolis": ("PATHCPU", "METROPOLIS"),
    "bidir": ("BIDIRCPU", "SOBOL"), "bidir-metropolis": ("BIDIRCPU", "METROPOLIS"),
}
INTEGRATORS = tuple(ENGINES)
REFERENCE = {"path": "path", "path-metropolis": "path", "bidir": "bidir", "bidir-metropolis": "bidir"}
# Where those of the path tracer end at the latest, which roulette ends before.
MOST_BOUNCES = 64
# Seconds between looks at how many samples are there.
LOOK_S = 0.005
NOTES = (
    "LuxCore computes with three channels, which are luminance in three bands of wavelengths, and has round shapes as triangles; its bidirectional integrator runs without Russian roulette and ends paths after a number of reflections that leaves out under 0.4 % of the picture.",
    "LuxCore's seconds are the processor seconds of its rendering threads.",
)


def ready(target, spectra):
    """Its own environment, made if need be; it asks nothing of the spectra."""
    del spectra
    python = python_environment(target, "python-peers-luxcore", "requirements-luxcore.txt")
    return Ready((str(python), "-m", "etalon_validation"), HARNESS_ENVIRONMENT, f"pyluxcore {VERSION}", NOTES)


def refuses(integrator, scene):
    """Nothing is refused."""
    del integrator, scene


def add_command(commands):
    """Adds the subcommand that renders once."""
    add_render_command(commands, COMMAND, TITLE, INTEGRATORS, lambda chosen: fulfil(chosen, render))


def configuration(order):
    """Properties of the run: film, engine, sampler, threads and seed."""
    engine, sampler = ENGINES[order.integrator]
    width, height = order.scene.camera.resolution
    common = {
        "renderengine.type": engine, "sampler.type": sampler, "native.threads.count": order.threads,
        # A seed of 0 is the clock's.
        "renderengine.seed": order.seed + 1,
        "film.width": width, "film.height": height, "film.filter.type": "NONE",
        "film.outputs.0.type": "RGB", "film.outputs.0.filename": "unused.exr",
        "path.clamping.variance.maxvalue": 0.0,
    }
    if engine == "BIDIRCPU":
        ends = bounces(order.scene)
        return common | {"path.maxdepth": ends, "light.maxdepth": ends, "path.russianroulette.depth": 1000}
    return common | {f"path.pathdepth.{kind}": MOST_BOUNCES for kind in ("total", "diffuse", "glossy", "specular")}


def render(order):
    """The `Answer` to an `Order`."""
    try:
        import pyluxcore
    except ImportError as error:
        raise InputError("pyluxcore", f"cannot be loaded ({error})", "install validation/requirements-luxcore.txt in an environment of its own") from None
    pyluxcore.Init()
    try:
        return rendered(pyluxcore, order)
    except RuntimeError as error:
        raise InputError("LuxCore", f"failed ({str(error).splitlines()[0]})", "see whether the scene holds what it understands") from None


def rendered(pyluxcore, order):
    """The `Answer` of the renderer, which tells its failures as `RuntimeError`."""
    session = pyluxcore.RenderSession(pyluxcore.RenderConfig(properties(pyluxcore, configuration(order)), load(pyluxcore, order)))
    width, height = order.scene.camera.resolution
    session.Start()
    before = clocks()
    samples = sampled(session, order.spp * width * height)
    session.Stop()
    cpu_s, wall_s = np.subtract(clocks(), before).tolist()
    return Answer(picture(pyluxcore, session.GetFilm(), width, height), cpu_s, wall_s, samples / (width * height))


def clocks():
    """Processor seconds of all threads but this one, and wall seconds."""
    return time.process_time() - time.thread_time(), time.monotonic()


def sampled(session, least):
    """Waits until so many samples have been taken; how many there are then."""
    while True:
        session.UpdateStats()
        samples = session.GetStats().Get("stats.renderengine.total.samplecount").GetFloat()
        if samples >= least:
            return samples
        time.sleep(LOOK_S)


def picture(pyluxcore, film, width, height):
    """Luminance in cd/m2 (height, width), the top row first."""
    pixels = np.zeros((height, width, 3), np.float32)
    film.GetOutputFloat(pyluxcore.FilmOutputType.RGB, pixels, 0, False)
    return luminance(pixels[::-1].astype(float))


def properties(pyluxcore, values):
    """Properties as the renderer takes them."""
    made = pyluxcore.Properties()
    for name, value in values.items():
        made.Set(pyluxcore.Property(name, value))
    return made


def load(pyluxcore, order):
    """The scene in the renderer."""
    described, scene = describe(order.scene, order.observer), pyluxcore.Scene()
    for name, mesh in described.shapes.items():
        points, triangles = (list(map(tuple, table.tolist())) for table in (mesh.points, mesh.triangles))
        normals = None if mesh.normals is None else list(map(tuple, mesh.normals.tolist()))
        scene.DefineMesh(name, points, triangles, normals, None, None, None)
    scene.Parse(properties(pyluxcore, described.properties))
    return scene
