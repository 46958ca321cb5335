"""What leaving an item of a plan out saves: instructions counted, and efficiency where noise changes.

The program renders each scene with the item kept (`--plan keep=ITEM`) and with all left out that the
scene does not need. Valgrind counts the instructions of two lengths of render, whose difference is
that of the samples alone. Counts do not depend on what else the machine does.
"""

import csv
import json
import math
import os
import re
import shutil
import subprocess
import tempfile
import uuid
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import date
from pathlib import Path

from .errors import InputError

TABLE = Path("src/scene/plan/savings.csv")
LANES = Path("validation/plan_lanes.csv")
PAGE = Path("validation/plan.md")
# Samples per pixel of the two renders whose instructions are counted, and their size in pixels.
COUNTED_SPP = (2, 8)
COUNTED_SIDE = 24
# Pairs of renders by which efficiencies are compared, with their seeds, and their size.
SEEDS = range(1, 6)
NOISE_SPP = 32
NOISE_SIDE = 32
# 97.5 % quantile of Student's t with one degree of freedom less than there are seeds.
T_975 = 2.776


@dataclass(frozen=True)
class Case:
    """An item kept and left out on a scene; whether the noise of the picture changes with it."""

    item: str
    scene: str
    integrator: str
    changes_noise: bool = False


CASES = (
    Case("everything", "cornell", "path", True),
    Case("everything", "cornell", "bdpt", True),
    Case("everything", "schoedl-2007", "bdpt", True),
    Case("outer-wavelengths", "cornell", "path", True),
    Case("even-wavelengths", "cornell", "path", True),
    Case("even-wavelengths", "schoedl-2007", "bdpt", True),
    Case("lane-densities", "cornell", "path"),
    Case("lane-densities", "cornell", "bdpt"),
    Case("media", "cornell", "path"),
    Case("media", "schoedl-2007-glass-bulb", "bdpt"),
    Case("lens", "cornell", "path"),
    Case("lens", "cornell", "bdpt"),
    Case("lamp-choice", "cornell", "path"),
    Case("lamp-choice", "schoedl-2007", "bdpt"),
    Case("meets-lights", "point", "bdpt"),
    Case("asks-lights", "mirrors", "path"),
    Case("joins", "chart", "bdpt"),
    Case("asks-eye", "chart", "bdpt"),
    Case("direct-asks-eye", "cornell", "bdpt", True),
    Case("light-to-eye", "cornell", "bdpt", True),
    Case("meets-eye", "cornell", "bdpt"),
)


def quad(corners, material, **more):
    """A flat object."""
    return {"shape": {"quad": {"vertices": corners}}, "material": material} | more


def floor(low, high, material):
    """A strip of the floor, from one x to another."""
    return quad([[low, 0, -1], [low, 0, 1], [high, 0, 1], [high, 0, -1]], material)


def small_scene(name):
    """A scene that no reference scene stands for: a point light, a chart in a plane, mirrors."""
    daylight = {"spectrum": "d65", "level": {"flux_lm": 400}}
    lamp = quad([[0.5, 2, -0.5], [0.5, 2, 0.5], [-0.5, 2, 0.5], [-0.5, 2, -0.5]], "black", emission=daylight)
    back = quad([[1, 0, 1], [1, 2, 1], [-1, 2, 1], [-1, 0, 1]], "orange")
    objects = {
        "point": [floor(-1, 1, "white"), back],
        "chart": [lamp, floor(-1, 0, "orange"), floor(0, 1, "white")],
        "mirrors": [lamp, *(quad([[x, 0, -1], [x, 2, -1], [x, 2, 1], [x, 0, 1]], "mirror") for x in (-0.6, 0.6))],
    }[name]
    return {
        "name": name, "length_unit": "m", "objects": objects,
        "materials": {
            "white": {"lambertian": {"reflectance": "cornell-white"}},
            "orange": {"lambertian": {"reflectance": "colorchecker-orange"}},
            "black": {"lambertian": {"reflectance": 0}},
            "mirror": {"mirror": {"reflectance": 0.9}},
        },
        "lights": [{"point": {"position": [0.1, 1.8, -0.5], "emission": daylight}}] if name == "point" else [],
        "camera": {
            "position": [0, 1, -0.95], "look_at": [0, 1.5 if name == "mirrors" else 0.1, 0.3], "up": [0, 1, 0.01],
            "focal_length_mm": 20, "sensor_mm": [25, 25], "resolution": [24, 24], "f_stop": 4, "shutter_s": 0.1, "iso": 800,
        },
    }


def scene_file(name, folder):
    """Where a case's scene is; small ones are written first."""
    reference = Path("reference") / name / "scene.json"
    if reference.is_file():
        return reference
    file = Path(folder) / f"{name}.json"
    file.write_text(json.dumps(small_scene(name)))
    return file


def setting_of(item):
    """The plan that keeps an item."""
    return "full" if item == "everything" else f"keep={item}"


def render(program, scene, integrator, plan, side, spp, seed, folder, counted=False):
    """Report of a render, and its instructions where they are counted."""
    stem = Path(folder) / uuid.uuid4().hex
    command = [program, "render", scene, "-o", f"{stem}.exr", "--report", f"{stem}.json", "--integrator", integrator]
    command += ["--plan", plan, "--spp", spp, "--seed", seed, "--resolution", f"{side}x{side}", "--threads", 1]
    valgrind = ["valgrind", "--tool=cachegrind", "--cache-sim=no", f"--cachegrind-out-file={os.devnull}"]
    done = subprocess.run([str(word) for word in (valgrind if counted else []) + command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise InputError(str(scene), f"the render failed: {done.stderr.strip()[-300:]}", "run it by hand")
    report = json.loads(Path(f"{stem}.json").read_text())
    found = re.search(r"I\s+refs:\s+([\d,]+)", done.stderr)
    return report, int(found.group(1).replace(",", "")) if found else None


def instructions(program, scene, integrator, plan, folder):
    """Instructions per sample."""
    counts = [render(program, scene, integrator, plan, COUNTED_SIDE, spp, 1, folder, counted=True)[1] for spp in COUNTED_SPP]
    return (counts[1] - counts[0]) / ((COUNTED_SPP[1] - COUNTED_SPP[0]) * COUNTED_SIDE**2)


def relative_variances(program, scene, integrator, plan, folder):
    """Squared relative error of a picture for each seed."""
    reports = (render(program, scene, integrator, plan, NOISE_SIDE, NOISE_SPP, seed, folder)[0] for seed in SEEDS)
    return [report["relative_error"] ** 2 for report in reports]


def ratio_with_interval(kept, left_out):
    """Geometric mean of the ratios kept over left out, and its 95 % interval."""
    logs = [math.log(a / b) for a, b in zip(kept, left_out, strict=True)]
    mean = sum(logs) / len(logs)
    scatter = math.sqrt(sum((x - mean) ** 2 for x in logs) / (len(logs) - 1) / len(logs))
    return [math.exp(mean + k * T_975 * scatter) for k in (0, -1, 1)]


def measured(program, folder, pool):
    """Instructions and relative variances by scene, integrator and plan; each is found once."""
    wanted = [(case, plan) for case in CASES for plan in (setting_of(case.item), "lean")]
    counts = {(case.scene, case.integrator, plan): instructions for case, plan in wanted}
    noises = {(case.scene, case.integrator, plan): relative_variances for case, plan in wanted if case.changes_noise}
    files = {case.scene: scene_file(case.scene, folder) for case in CASES}
    for found in (counts, noises):
        for (scene, integrator, plan), ask in found.items():
            found[scene, integrator, plan] = pool.submit(ask, program, files[scene], integrator, plan, folder)
    return [{key: future.result() for key, future in found.items()} for found in (counts, noises)]


def row_of(case, counts, noises):
    """A row of the table."""
    keys = [(case.scene, case.integrator, plan) for plan in (setting_of(case.item), "lean")]
    kept, left_out = (counts[key] for key in keys)
    ratios = ["", "", ""]
    if case.changes_noise:
        noise = [noises[key] for key in keys]
        ratios = [f"{ratio * kept / left_out:.4f}" for ratio in ratio_with_interval(*noise)]
    return [case.item, case.scene, case.integrator, f"{kept:.1f}", f"{left_out:.1f}", *ratios]


def page_of(rows, lanes, said):
    """The page: how it was measured, and the tables."""
    text = [
        "# What plans leave out, and what that saves", "",
        "A plan leaves out what a scene does not need (`etalon check SCENE.json` lists it with reasons, as every report does under",
        "`plan_items`); `--plan full` keeps everything, `--plan keep=NAME` single items. The picture is the same, which",
        "`tests/plan` proves. This page and the table that plans quote (`src/scene/plan/savings.csv`) are written by", "",
        "```sh", "python -m etalon_validation plan-savings", "```", "",
        f"{said} Instructions are those of a sample, counted by valgrind ({COUNTED_SIDE} x {COUNTED_SIDE} pixels, the difference",
        f"of {COUNTED_SPP[0]} and {COUNTED_SPP[1]} samples per pixel). Efficiency is 1 / (relative mean squared error x instructions), left out over",
        f"kept, with the 95 % interval over {len(SEEDS)} pairs of renders of {NOISE_SPP} samples per pixel; there is none where the noise does not",
        "change. *Everything* is the full plan against the lean one. A negative saving is what a surer way of drawing costs.", "",
        "| item | scene | integrator | kept | left out | saves | efficiency |", "|---|---|---|---|---|---|---|",
    ]
    for item, scene, integrator, kept, left_out, ratio, low, high in rows:
        share = 100 * (1 - float(left_out) / float(kept))
        told = f"{float(ratio):.3f} ({float(low):.3f} to {float(high):.3f})" if ratio else ""
        text.append(f"| {item} | {scene} | {integrator} | {float(kept):.0f} | {float(left_out):.0f} | {share:.1f} % | {told} |")
    return "\n".join(text + lanes_of(lanes)) + "\n"


def lanes_of(lanes):
    """The section on the number of wavelengths."""
    text = [
        "", "## Wavelengths per path", "",
        "Their number is fixed when the program is built (`spectrum::LANES`). Counted in copies that were built with 4 and 16",
        "(`validation/plan_lanes.csv`, from before the sampler of wavelengths got its guide; relative variance of X, Y and Z of one sample over the squared luminance, from one render of",
        "48 x 48 pixels and 256 samples per pixel), efficiency relative to 8:", "",
        "| scene | integrator | wavelengths | instructions | variance | efficiency |", "|---|---|---|---|---|---|",
    ]
    cost = {(row["scene"], row["lanes"]): float(row["instructions_per_sample"]) * float(row["relmse_xyz_per_sample"]) for row in lanes}
    for row in lanes:
        ratio = cost[row["scene"], "8"] / cost[row["scene"], row["lanes"]]
        text.append(f"| {row['scene']} | {row['integrator']} | {row['lanes']} | {row['instructions_per_sample']} | {row['relmse_xyz_per_sample']} | {ratio:.2f} |")
    return text


def run(program, workers=None):
    """Measures every case, as many at a time as there are processors, and writes table and page."""
    if shutil.which("valgrind") is None:
        raise InputError("valgrind", "it is not installed", "install it, for example by apt-get install valgrind")
    if not Path(program).is_file():
        raise InputError(str(program), "there is no such program", "build it by cargo build --release")
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(workers or os.cpu_count()) as pool:
        counts, noises = measured(program, folder, pool)
    rows = [row_of(case, counts, noises) for case in CASES]
    version = subprocess.run([str(program), "--version"], capture_output=True, text=True, check=False).stdout.strip()
    said = f"Measured on {date.today().isoformat()} with {version}."
    header = ["item", "scene", "integrator", "instructions_kept", "instructions_left_out", "efficiency_ratio", "low", "high"]
    lines = ["# What leaving an item of a plan out saves; written with validation/plan.md.", f"# {said}", ",".join(header)]
    TABLE.write_text("\n".join(lines + [",".join(row) for row in rows]) + "\n")
    with LANES.open(newline="") as file:
        lanes = list(csv.DictReader(file))
    PAGE.write_text(page_of(rows, lanes, said))
    return 0
