"""The self-test with a known answer: a synthetic photograph is taken apart again.

A render by a camera that stands a few pixels off, made into a photograph
(`synthetic`), is compared with a second, independent render by the nominal
camera, as a case is: points picked with noise, pose fitted and refined on the
edges, vignetting divided out, regions measured through the found camera, gains
fitted. What went in is known, so every error is. Faults planted on the way, a
step left out, must show as failures: a test that they pass would prove nothing.
"""

import json
import subprocess
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .align import Picked, refine
from .camera import turned
from .edges import grey
from .errors import InputError, read_json
from .layout import Layout
from .lens import corrected
from .misfit import judge_photograph
from .polygons import mask
from .pose import PICKING_PX, fit_pose, read_frame, read_points
from .regions import measure
from .registration import METERS, render_camera
from .render import read_render
from .synthetic import Sensor, photographed

CASE = Path("reference/cornell-photo")
SPP = 256
# Seeds of picking and sensor noise.
SEEDS = 8
# Where the photograph's camera stands off: turns in degrees, and steps right, up and ahead in thousandths of its distance.
YAW_DEG, PITCH_DEG, ROLL_DEG = 0.3, -0.2, 0.05
STEP = (4e-3, -3e-3, 6e-3)
# How far each quantity may be from the truth.
LIMITS = {"pose_px": 0.2, "exposure_stops": 0.01, "gain_1_percent": 0.5, "gain_3_percent": 0.5}
# Regions darker than this share of the brightest fix no gain.
DARK = 0.02
FAULTS = ("vignetting not corrected", "pose not refined")


@dataclass(frozen=True)
class Bench:
    """Two renders' channels (h, w, 3) over saturation, the cameras they were made with, and the layout and points of the case."""

    layout: Layout
    frame: object
    points: np.ndarray
    truth: object
    nominal: object
    photo_channels: np.ndarray
    render_channels: np.ndarray


def displaced(camera, reach):
    """The camera that the synthetic photograph is taken with; `reach` is the distance to the scene's middle."""
    look, up = turned(camera.look, camera.up, *np.radians([YAW_DEG, PITCH_DEG, ROLL_DEG]))
    right, above, ahead = (reach * step for step in STEP)
    return replace(camera, look=look, up=up, position=camera.position + right * camera.right + above * camera.up + ahead * camera.look)


def take_apart(bench, seed, sensor=Sensor(), fault=None):
    """What the harness finds in the photograph of one noise seed: errors by quantity, what was found, and the verdict."""
    generator = np.random.default_rng(seed)
    photograph = photographed(bench.photo_channels, bench.truth, sensor, generator)
    pixels = bench.truth.project(bench.points)
    pixels = pixels + PICKING_PX * generator.standard_normal(pixels.shape)
    result = fit_pose(bench.points, pixels, bench.frame)
    values = [entry["value"] for name, entry in result["models"][result["chosen"]]["parameters"].items() if name != "horizontal_fov_deg"]
    camera = bench.frame.camera(np.array(values))
    made = grey(bench.render_channels)
    if fault != "pose not refined":
        found = refine(bench.layout.seen_by(camera), bench.frame, len(values), Picked(bench.points, pixels), grey(photograph.rgb), made, bench.nominal, "self-test")
        camera = found.camera
    record = None if fault == "vignetting not corrected" else {"camera": {"vignetting": {"model": "cos4"}}}
    photograph, camera = corrected(photograph, camera, record), camera.undistorted
    verdict = judge_photograph(bench.layout.seen_by(camera), grey(photograph.rgb), made, bench.nominal)
    gain = region_gains(bench, photograph, camera)
    stops = float(np.log2(gain[1]))
    relative = gain / gain[1] / np.asarray(sensor.gains)
    corners = face_corners(bench.layout.seen_by(bench.truth))
    errors = {
        "pose_px": float(np.linalg.norm(camera.project(corners) - bench.truth.project(corners), axis=1).max()),
        "exposure_stops": stops - sensor.exposure_stops,
        "gain_1_percent": 100 * (relative[0] - 1),
        "gain_3_percent": 100 * (relative[2] - 1),
    }
    found = {"exposure_stops": stops, "gains": [float(value) for value in gain / gain[1]], "model": result["chosen"], "registration": verdict["verdict"]}
    return {name: float(value) for name, value in errors.items()}, found


def region_gains(bench, photograph, camera):
    """The three gains from render to photograph, by least squares of relative differences over the matte regions that both cameras show."""
    photo_layout, render_layout = bench.layout.seen_by(camera), bench.layout.seen_by(bench.nominal)
    seen, made = [], []
    for patch in bench.layout.patches:
        if bench.layout.faces[patch.face].mirror:
            continue
        here, share = photo_layout.polygon(patch)
        there, other = render_layout.polygon(patch)
        if share == other == 1.0:
            seen.append(measure(photograph, patch.name, patch.surface, here).rgb)
            made.append(bench.render_channels[mask(there, bench.nominal.size)].mean(axis=0))
    seen, made = np.array(seen), np.array(made)
    bright = seen.min(axis=1) > DARK * seen.max()
    made, seen = made[bright] / seen[bright, 1:2], seen[bright] / seen[bright, 1:2]
    return (made * seen).sum(axis=0) / (made**2).sum(axis=0)


def face_corners(layout):
    """Corners (n, 3) of the layout's faces inside its picture."""
    corners = np.unique(np.concatenate([face.quad for face in layout.faces.values()]), axis=0)
    corners = corners[layout.camera.depth(corners) > 0]
    pixels = layout.camera.project(corners)
    return corners[((pixels >= 0) & (pixels <= np.asarray(layout.camera.size))).all(axis=1)]


def passes(errors):
    """Whether every quantity is within its limit."""
    return all(abs(errors[name]) <= limit for name, limit in LIMITS.items())


def examine(bench, seeds=SEEDS, sensor=Sensor()):
    """The whole self-test on a bench as a JSON object; `pass` asks every seed to pass and every planted fault to fail."""
    runs = [take_apart(bench, seed, sensor) for seed in range(seeds)]
    errors, found = runs[0]
    truth = {"exposure_stops": sensor.exposure_stops, "gain_1_percent": 100 * sensor.gains[0], "gain_3_percent": 100 * sensor.gains[2], "pose_px": 0.0}
    planted = []
    for fault in FAULTS:
        wrong, _ = take_apart(bench, 0, sensor, fault)
        planted.append({"fault": fault, "errors": rounded(wrong), "caught": not passes(wrong)})
    table = {name: np.array([run[name] for run, _ in runs]) for name in LIMITS}
    report = {
        "quantities": [
            {"name": name, "truth": truth[name], "found": round(truth[name] + errors[name] * (truth[name] / 100 if "percent" in name else 1), 5),
             "error": round(errors[name], 5), "limit": limit, "pass": bool(abs(errors[name]) <= limit)}
            for name, limit in LIMITS.items()
        ],
        "seeds": [{"seed": seed, "errors": rounded(run), "pass": passes(run), "registration": said["registration"], "model": said["model"]} for seed, (run, said) in enumerate(runs)],
        "spread": {name: {"mean": round(float(values.mean()), 5), "deviation": round(float(values.std(ddof=1)), 5) if seeds > 1 else None, "worst": round(float(np.abs(values).max()), 5)} for name, values in table.items()},
        "planted": planted,
        "about": "errors are found minus truth; pose_px is the largest distance between true and found images of visible face corners; gains are relative to the second channel; a planted fault must fail a limit",
    }
    right = all(run["pass"] and run["registration"] == "accepted" for run in report["seeds"])
    return report | {"pass": bool(right and all(entry["caught"] for entry in planted))}


def rounded(errors):
    """Errors for JSON."""
    return {name: round(value, 5) for name, value in errors.items()}


def prepare(program, output, spp, case=CASE):
    """Renders the case twice, by its own camera and by the displaced one, with independent seeds."""
    scene = read_json(case / "scene.json", "give a case folder")
    layout = Layout(case / "layout.json")
    frame = read_frame(case / "layout.json", layout.length_unit)
    points, *_ = read_points(case / "points.csv")
    nominal = render_camera(case, layout, layout.camera.size)
    truth = displaced(nominal, float(np.linalg.norm(points.mean(axis=0) - nominal.position)))
    scale = METERS[layout.length_unit] / METERS[scene["length_unit"]]
    moved = {key: value for key, value in scene["camera"].items() if key != "look_at"}
    moved |= {"position": list(scale * truth.position), "direction": list(truth.look), "up": list(truth.up)}
    output.mkdir(parents=True, exist_ok=True)
    (output / "photograph.json").write_text(json.dumps(scene | {"camera": moved}, indent=2), encoding="utf-8")
    made = render(program, output / "photograph.json", output / "photograph.exr", spp, 1)
    plain = render(program, case / "scene.json", output / "render.exr", spp, 2)
    return Bench(layout, frame, points, truth, nominal, made.xyz / made.saturation, plain.xyz / plain.saturation)


def render(program, scene, file, spp, seed):
    """One render by the program; bidirectional, which finds the light thrown by mirrors."""
    words = [str(program), "render", str(scene), "--integrator", "bdpt", "--spp", str(spp), "--seed", str(seed), "-o", str(file)]
    try:
        run = subprocess.run(words, capture_output=True, text=True, check=False)
    except OSError as error:
        raise InputError(program, f"cannot be run ({error.strerror})", "build it, or name it with --program") from None
    if run.returncode != 0:
        lines = run.stderr.strip().splitlines()
        raise InputError(scene, f"cannot be rendered ({lines[0] if lines else 'no reason given'})", "see what etalon check says of it")
    return read_render(file)


def describe(report):
    """The report in lines for the terminal."""
    lines = [f"{'quantity':16}{'truth':>10}{'found':>10}{'error':>10}{'limit':>8}"]
    for entry in report["quantities"]:
        lines.append(f"{entry['name']:16}{entry['truth']:10.4f}{entry['found']:10.4f}{entry['error']:10.4f}{entry['limit']:8.3f}  {'pass' if entry['pass'] else 'FAIL'}")
    lines.append(f"over {len(report['seeds'])} noise seeds, {sum(run['pass'] for run in report['seeds'])} pass:")
    for name, spread in report["spread"].items():
        deviation = "-" if spread["deviation"] is None else f"{spread['deviation']:.4f}"
        lines.append(f"  {name:16} mean {spread['mean']:.4f}, deviation {deviation}, worst {spread['worst']:.4f}")
    for entry in report["planted"]:
        wrong = {name: value for name, value in entry["errors"].items() if abs(value) > LIMITS[name]}
        lines.append(f"planted: {entry['fault']}: " + ("caught, " + ", ".join(f"{name} off by {value:.3f}" for name, value in wrong.items()) if entry["caught"] else "NOT CAUGHT"))
    return "\n".join(lines + ["self-test passed" if report["pass"] else "self-test FAILED"])
