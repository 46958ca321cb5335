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
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from .errors import InputError, meaning, read_json
from .peer_scene import EFFICACY, Spectra, mitsuba_scene

SCALAR = "scalar_spectral"
LLVM = "llvm_ad_spectral"
# Samples of all pixels that a compiled kernel holds in memory at once.
MOST_LANES = 1 << 22
# X, Y, Z are their own primaries, with equal energy white (OpenEXR's advice for CIE XYZ).
XYZ_CHROMATICITIES = (1, 0, 0, 1, 0, 0, 1 / 3, 1 / 3)


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


def load_scene(mi, scene, spectra, place):
    """The scene as Mitsuba holds it."""
    with tempfile.TemporaryDirectory() as folder:
        with meaning(place, "correct the scene"):
            described = mitsuba_scene(mi, scene, spectra, folder, place)
        return mi.load_dict(described)


def render_xyz(mi, scene, spp, seed):
    """Absolute XYZ (height, width, 3), Y in cd/m2."""
    return EFFICACY / mi.MI_CIE_Y_NORMALIZATION * np.array(mi.render(scene, spp=spp, seed=seed), float)


def write_xyz(path, xyz, stderr=None):
    """Writes XYZ in cd/m2, and its standard errors where they are known, as an EXR."""
    layers = [xyz] if stderr is None else [xyz, stderr]
    pixels = np.ascontiguousarray(np.concatenate(layers, axis=-1), np.float32)
    height, width, channels = pixels.shape
    spec = oiio.ImageSpec(width, height, channels, "float")
    spec.channelnames = tuple("XYZ") + (() if stderr is None else ("stderr.X", "stderr.Y", "stderr.Z"))
    spec.attribute("whiteLuminance", 1.0)
    spec.attribute("chromaticities", "float[8]", XYZ_CHROMATICITIES)
    file = oiio.ImageOutput.create(str(path))
    if file is None or not file.open(str(path), spec) or not file.write_image(pixels):
        raise InputError(path, "cannot be written", "check the folder and its permissions")
    file.close()


def passes(spp, pixels, is_compiled):
    """Samples per pixel of each pass; compiled kernels hold all samples of a pass at once."""
    most = max(1, MOST_LANES // pixels) if is_compiled else spp
    return [most] * (spp // most) + ([spp % most] if spp % most else [])


def render_to_file(case, spectra_folder, resolution, variant, spp, seed, threads, output, times):
    """One run: the picture into `output`, and processor and wall seconds of its rendering as JSON into `times`."""
    place = Path(case) / "scene.json"
    described = read_json(place, "give a case folder with the diffuse scene")
    with meaning(place, "give the scene a camera"):
        described["camera"]["resolution"] = list(resolution)
    mi = load_mitsuba(variant, threads)
    scene = load_scene(mi, described, Spectra(spectra_folder), place)
    parts = passes(spp, resolution[0] * resolution[1], variant == LLVM)
    if variant == LLVM:
        render_xyz(mi, scene, 1, seed)
    wall, cpu = time.monotonic(), time.process_time()
    # Each pass has a seed of its own: runs use fewer than 1000 passes.
    pictures = (count * render_xyz(mi, scene, count, 1000 * seed + index) for index, count in enumerate(parts))
    xyz = sum(pictures) / spp
    taken = {"render": {"cpu_s": time.process_time() - cpu, "wall_s": time.monotonic() - wall}}
    write_xyz(output, xyz)
    Path(times).write_text(json.dumps(taken) + "\n", encoding="utf-8")
