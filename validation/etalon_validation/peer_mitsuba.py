"""Mitsuba 3 as a peer: pictures of one scene in absolute XYZ, and a process for each.

No factor is fitted: both renderers integrate absolute spectral radiance with the
CIE 1931 observer times 683 lm/W. Mitsuba's XYZ film divides the integral by its
constant 106.7503, while the observer's own integral over 360 to 830 nm is
106.8569; multiplying by the constant restores the integral. Its observer has
5 nm samples, ours 1 nm.

Runs against time are processes of their own (`mitsuba-render`), as those of
Etalon are, with as many threads. A process tells the seconds of its rendering;
what is left of the whole is loading: Python, imports, scene, and under LLVM the
compilation, which a first sample per pixel that is thrown away takes.
"""

import json
import subprocess
import tempfile
import time
from importlib import metadata
from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_driver import HARNESS_ENVIRONMENT, Ready, add_render_command
from .peer_mitsuba_scene import LIGHT, PATH, mitsuba_scene
from .peer_scene import EFFICACY, Spectra, read_scene
from .peer_write import write_xyz

SCALAR = "scalar_spectral"
LLVM = "llvm_ad_spectral"
NAME, COMMAND = "mitsuba", "mitsuba-render"
# Variant and integrator by what `--integrator` takes.
KINDS = {"scalar-path": (SCALAR, PATH), "llvm-path": (LLVM, PATH), "llvm-ptracer": (LLVM, LIGHT)}
INTEGRATORS = tuple(KINDS)
# All three estimate one picture: the most efficient of those that can makes the reference.
REFERENCE = dict.fromkeys(INTEGRATORS, ("llvm-path", "llvm-ptracer", "scalar-path"))
# The folder of its environment below `target`, and what a library of LLVM is tried on.
ENVIRONMENT, TRIAL_SIZE = "python-peers", "16x16"
# Samples of all pixels that a compiled kernel holds in memory at once.
MOST_LANES = 1 << 22


def add_command(commands):
    """Adds `mitsuba-render`."""
    add_render_command(commands, COMMAND, "Mitsuba 3", INTEGRATORS, lambda chosen: render_to_file(
        chosen.case, chosen.spectra, chosen.resolution, chosen.integrator, chosen.spp, chosen.seed, chosen.threads, chosen.output, chosen.times,
    ))


def ready(target, spectra):
    """The environment below `target` and an LLVM that works; both are looked for, neither is installed here."""
    from .peer_llvm import LIBRARY, usable

    python = Path(target) / ENVIRONMENT / "bin" / "python"
    version = installed_version(python)
    words, environment = (str(python), "-m", "etalon_validation"), dict(HARNESS_ENVIRONMENT)
    case = Path(spectra).parent / "reference" / "cornell"

    def trial(output, times):
        return [*words, COMMAND, "--case", case, "--spectra", spectra, "--integrator", "llvm-path", "--resolution", TRIAL_SIZE, "--spp", 1, "-o", output, "--times", times]

    library, note = usable(trial, environment)
    if library is not None:
        return Ready(words, environment | {LIBRARY: str(library)}, f"Mitsuba {version}", (note,))
    unable = {name: note for name, (variant, _) in KINDS.items() if variant == LLVM}
    return Ready(words, environment, f"Mitsuba {version}", (note,), unable)


def installed_version(python):
    """Mitsuba's version in an environment."""
    asked = "from importlib import metadata; print(metadata.version('mitsuba'))"
    try:
        return subprocess.run([str(python), "-c", asked], capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        raise InputError("mitsuba", f"is not installed in {python.parent.parent}", "run etalon validate peers, or install validation/requirements-peers.txt there") from None


def refuses(integrator, scene):
    """Why an integrator cannot render a scene; `None` where it can."""
    if KINDS[integrator][1] == LIGHT and not scene.is_diffuse:
        return "light tracing to a pinhole sees nothing in mirrors and through glass"
    return None


def load_mitsuba(variant, threads=None):
    """The module in a variant, on so many threads, the calling one counted; `None`: all processors."""
    try:
        import drjit
        import mitsuba as mi
    except ImportError:
        raise InputError("mitsuba", "is not installed", "install validation/requirements-peers.txt in an environment of its own") from None
    if threads:
        drjit.set_thread_count(threads)
    mi.set_variant(variant)
    return mi


def load_scene(mi, scene, integrator=PATH):
    """A `Scene` as Mitsuba holds it."""
    with tempfile.TemporaryDirectory() as folder:
        return mi.load_dict(mitsuba_scene(mi, scene, folder, integrator))


def render_xyz(mi, scene, spp, seed):
    """Absolute XYZ (height, width, 3), Y in cd/m2."""
    return EFFICACY / mi.MI_CIE_Y_NORMALIZATION * np.array(mi.render(scene, spp=spp, seed=seed), float)


def passes(spp, pixels, is_compiled):
    """Samples per pixel of each pass; compiled kernels hold all samples of a pass at once."""
    most = max(1, MOST_LANES // pixels) if is_compiled else spp
    return [most] * (spp // most) + ([spp % most] if spp % most else [])


def render_to_file(case, spectra_folder, resolution, integrator, spp, seed, threads, output, times):
    """One run: the picture into `output`, and processor and wall seconds of its rendering as JSON into `times`."""
    variant, kind = KINDS[integrator]
    described = read_scene(Path(case) / "scene.json", Spectra(spectra_folder), resolution)
    mi = load_mitsuba(variant, threads)
    scene = load_scene(mi, described, kind)
    parts = passes(spp, resolution[0] * resolution[1], variant == LLVM)
    if variant == LLVM:
        render_xyz(mi, scene, 1, seed)
    wall, cpu = time.monotonic(), time.process_time()
    # Each pass has a seed of its own: runs use fewer than 1000 passes.
    pictures = (count * render_xyz(mi, scene, count, 1000 * seed + index) for index, count in enumerate(parts))
    xyz = sum(pictures) / spp
    taken = {"render": {"cpu_s": time.process_time() - cpu, "wall_s": time.monotonic() - wall}, "version": f"Mitsuba {metadata.version('mitsuba')}"}
    write_xyz(output, xyz)
    Path(times).write_text(json.dumps(taken) + "\n", encoding="utf-8")
