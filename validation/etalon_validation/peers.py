"""Compares an all-diffuse render with Mitsuba 3 in absolute XYZ, block by block.

No factor is fitted: see `peer_mitsuba.py`. Both images are seen as by an eye:
the right of the picture is look x up. The mean of the peer's runs is kept as its
own converged picture, with the standard error by their scatter.
"""

import json
import time
from importlib import metadata
from pathlib import Path

import numpy as np
from scipy import stats

from .errors import InputError, meaning, read_json
from .peer_mitsuba import SCALAR, load_mitsuba, load_scene, render_xyz
from .peer_scene import EFFICACY, Spectra, scene_of
from .peer_write import write_xyz
from .render import read_render

BLOCK = 8
# Relative difference that a block may have beyond its noise.
TOLERANCE = 0.005
# Independent runs of the peer: their scatter is its noise.
RUNS = 32
# Chance that a perfect pair of images fails somewhere.
FALSE_ALARM = 0.01
# Blocks darker than this share of the mean are empty surroundings.
EMPTY = 1e-3
# The peer's own picture, the mean of its runs.
REFERENCE_FILE = "mitsuba-reference.exr"
# A block size whose typical noise is below this shows agreement within the tolerance.
MOST_NOISE = 0.0025


def blocks(image):
    """Means over blocks of 8 x 8 pixels; a partial block at the right or bottom is left out."""
    height, width = image.shape[0] // BLOCK, image.shape[1] // BLOCK
    cut = image[: height * BLOCK, : width * BLOCK]
    return cut.reshape(height, BLOCK, width, BLOCK, -1).mean(axis=(1, 3))


def run_mitsuba(scene, spp, threads):
    """Block means (runs, rows, columns, 3) of absolute XYZ, the picture's mean and standard error (height, width, 3), the run time, and the normalisation undone."""
    mi = load_mitsuba(SCALAR, threads)
    start = time.monotonic()
    loaded = load_scene(mi, scene)
    means, total, squares = [], 0, 0
    for seed in range(RUNS):
        xyz = render_xyz(mi, loaded, max(1, spp // RUNS), seed)
        means.append(blocks(xyz))
        total, squares = total + xyz, squares + xyz**2
    mean = total / RUNS
    stderr = np.sqrt(np.maximum(squares / RUNS - mean**2, 0) / (RUNS - 1))
    return np.array(means), (mean, stderr), time.monotonic() - start, 1 / mi.MI_CIE_Y_NORMALIZATION


def merged(means):
    """Means of 2 x 2 neighbouring blocks (..., rows, columns, 3); an odd last row or column is left out."""
    rows, columns = means.shape[-3] // 2, means.shape[-2] // 2
    cut = means[..., : 2 * rows, : 2 * columns, :]
    return cut.reshape(*means.shape[:-3], rows, 2, columns, 2, 3).mean(axis=(-4, -2))


def judge_size(ours, our_error, peers):
    """Ratios of one block size with their noise, and how many differ by more than tolerance and noise allow."""
    theirs, their_error = peers.mean(axis=0), peers.std(axis=0, ddof=1) / np.sqrt(RUNS)
    lit = (theirs[..., 1] > EMPTY * theirs[..., 1].mean())[..., None] & (theirs > 0)
    ratio, noise = np.ones_like(ours), np.zeros_like(ours)
    ratio[lit] = ours[lit] / theirs[lit]
    noise[lit] = np.hypot(our_error[lit] / theirs[lit], ratio[lit] * their_error[lit] / theirs[lit])
    tests = max(int(lit.sum()), 1)
    critical = float(stats.t.isf((1 - (1 - FALSE_ALARM) ** (1 / tests)) / 2, RUNS - 1))
    beyond = np.maximum(np.abs(ratio - 1) - critical * noise, 0)
    score = (ratio[lit] - 1) / np.maximum(noise[lit], 1e-12)
    return {
        "tests": int(lit.sum()), "failed": int(((beyond > TOLERANCE) & lit).sum()), "empty_blocks": int((~lit[..., 1]).sum()),
        "critical": critical, "largest_deviation": float(np.abs(ratio[lit] - 1).max(initial=0)), "largest_score": float(np.abs(score).max(initial=0)), "largest_beyond_noise": float(beyond[lit].max(initial=0)),
        "typical_noise": float(np.median(noise[lit])) if lit.any() else None,
        "mean_square_of_scores": float((score**2).mean()) if lit.any() else None,
        "expected_mean_square": (RUNS - 1) / (RUNS - 3),
        "ratio": np.round(ratio, 6).tolist(), "standard_error": np.round(noise, 6).tolist(),
    }


def judge(ours, our_error, peers):
    """The judgement at every block size up to the largest, and the verdict over all of them.

    Merging blocks averages noise away, so a difference that hides in the noise
    of small blocks is found in large ones.
    """
    sizes, pixels = {}, BLOCK
    mirror = mirrored(ours, peers.mean(axis=0))
    while min(ours.shape[:2]) >= 1:
        sizes[pixels] = judge_size(ours, our_error, peers)
        ours, our_error, peers, pixels = merged(ours), np.sqrt(merged(our_error**2)) / 2, merged(peers), 2 * pixels
    resolved = [size for size, result in sizes.items() if result["typical_noise"] is not None and result["typical_noise"] < MOST_NOISE]
    failed = sum(result["failed"] for result in sizes.values())
    return {
        "verdict": "fail" if failed else "pass" if BLOCK in resolved else "undecided",
        "failed": failed, "tests": sum(result["tests"] for result in sizes.values()),
        "resolved_block_px": min(resolved) if resolved else None,
        "mirrored_left_right": mirror, "block_sizes": sizes,
    }


def mirrored(ours, theirs):
    """Whether the peer turned left for right matches better than as it stands."""
    plain, turned = (np.abs(ours - image).sum() for image in (theirs, theirs[:, ::-1]))
    return bool(turned < plain)


def compare_with_mitsuba(case, spectra_folder, render_path, output, spp, threads=None):
    """Writes peers.json and the peer's picture, and returns one line with the verdict."""
    place = Path(case) / "scene.json"
    scene = read_json(place, "give a case folder with the diffuse scene")
    render = read_render(render_path)
    with meaning(place, "give the scene a camera"):
        resolution = tuple(scene["camera"]["resolution"])
    width, height = render.size
    if width * resolution[1] != height * resolution[0]:
        raise InputError(render_path, f"has {render.size} pixels, the scene {resolution}", "render the scene at its own shape")
    with meaning(place, "correct the scene"):
        described = scene_of(scene, Spectra(spectra_folder), place, (width, height))
    peers, picture, seconds, normalisation = run_mitsuba(described, spp, threads)
    our_error = np.sqrt(blocks(render.stderr**2)) / BLOCK
    result = judge(blocks(render.xyz), our_error, peers)
    head = {
        "scene": scene.get("name"), "render": {"file": render.file, "sha256": render.sha256, "samples_per_pixel": render.record.get("samples_per_pixel"), "seconds": render.record.get("seconds")},
        "peer": {"name": "Mitsuba", "version": metadata.version("mitsuba"), "variant": SCALAR, "samples_per_pixel": spp // RUNS * RUNS, "runs": RUNS, "seconds": round(seconds, 1), "file": REFERENCE_FILE},
        "scale": f"Nothing fitted. Mitsuba XYZ x {normalisation:.4f} (its Y constant; the observer's own integral is 106.8569) x {EFFICACY:g} lm/W.",
        "orientation": "The picture's right is look x up on both sides.",
        "rule": f"Pass when every block and channel agrees within {TOLERANCE:.1%} beyond noise (t quantile, Sidak over all blocks of a size, false alarm {FALSE_ALARM:.0%}), at {BLOCK}x{BLOCK} pixels and every doubling; resolved_block_px is the smallest size with typical noise below {MOST_NOISE:.2%}; where that is not {BLOCK}, the verdict is undecided.",
    }
    Path(output).mkdir(parents=True, exist_ok=True)
    write_xyz(Path(output) / REFERENCE_FILE, *picture)
    (Path(output) / "peers.json").write_text(json.dumps(head | result) + "\n", encoding="utf-8")
    smallest = result["block_sizes"][BLOCK]
    largest = f"largest difference of a {BLOCK} px block {smallest['largest_deviation']:.2%} with typical noise {smallest['typical_noise']:.2%}, largest z-score {smallest['largest_score']:.1f}" if smallest["tests"] else "no block is lit"
    resolved = f"agreement shown at {result['resolved_block_px']} px blocks" if result["resolved_block_px"] else "too noisy to show agreement at any block size"
    return f"{result['verdict']}: {result['failed']} of {result['tests']} block tests differ by more than {TOLERANCE:.1%} beyond noise; {largest}; {resolved}"
