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
import tempfile
import time
from importlib import metadata
from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_mitsuba_scene import LIGHT, PATH, mitsuba_scene
from .peer_scene import EFFICACY, Spectra, read_scene
from .peer_write import write_xyz

SCALAR = "scalar_spectral"
LLVM = "llvm_ad_spectral"
# Variant and integrator by what `--integrator` takes.
INTEGRATORS = {"scalar-path": (SCALAR, PATH), "llvm-path": (LLVM, PATH), "llvm-ptracer": (LLVM, LIGHT)}
# Samples of all pixels that a compiled kernel holds in memory at once.
MOST_LANES = 1 << 22


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
    variant, kind = INTEGRATORS[integrator]
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
