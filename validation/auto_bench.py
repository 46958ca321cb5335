"""What `--integrator auto` picks on the reference scenes, held against measured efficiencies.

    python validation/auto_bench.py --program target/release/etalon -o auto.json [SCENE ...]

Each scene is rendered small by every candidate, in independent repeats, and held against a long
render of another seed (by chains where samples hardly find the light). The efficiency of a
candidate is one over relative mean squared error times processor seconds, loading apart. What auto
would pick for 60 s at the scene's own size, and from what figures, is set beside it; the processor
seconds and the pilot's counts are what the constants of `src/pilot/work.rs` are fitted to
(`--fit auto.json` does it).
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from etalon_validation.efficiency import floor_of  # noqa: E402
from etalon_validation.render import read_render  # noqa: E402

REFERENCE = Path(__file__).parent.parent / "reference"
SCENES = ("cornell", "schoedl-2007", "schoedl-2007-small-bulb", "schoedl-2007-glass-bulb", "slit-room",
          "door-ajar", "pool", "stanford", "yale-grey")
# Scenes of whose light chains give the surer picture.
BY_CHAINS = ("door-ajar", "schoedl-2007-glass-bulb")
CANDIDATES = {
    "path": ["--integrator", "path"],
    "light": ["--integrator", "light"],
    "bdpt path,splats": ["--integrator", "bdpt", "--groups", "path,splats"],
    "bdpt path,joins": ["--integrator", "bdpt", "--groups", "path,joins"],
    "bdpt": ["--integrator", "bdpt"],
    "mlt": ["--integrator", "mlt"],
}
WIDTH = 64
REFERENCE_SEED = 1000


def render(program, scene, words, folder):
    """The picture and the facts of a render on one thread."""
    exr, report = folder / "x.exr", folder / "x.json"
    command = [program, "render", str(REFERENCE / scene / "scene.json"), "-o", str(exr), "--report", str(report),
               "--threads", "1", *words]
    subprocess.run(command, check=True, capture_output=True, text=True)
    picture = read_render(exr)
    return picture, json.loads(report.read_text())


def size(scene):
    """A small picture of a scene's own shape, as WIDTHxHEIGHT."""
    width, height = json.loads((REFERENCE / scene / "scene.json").read_text())["camera"]["resolution"]
    return f"{WIDTH}x{round(WIDTH * height / width)}"


def measured(program, scene, options, folder):
    """Efficiencies of the candidates on one scene, and what auto makes of it."""
    common = ["--resolution", size(scene)]
    by = "mlt" if scene in BY_CHAINS else "bdpt"
    words = [*common, "--integrator", by, "--spp", str(options.reference_spp), "--seed", str(REFERENCE_SEED)]
    reference, _ = render(program, scene, words, folder)
    truth = reference.xyz[..., 1]
    below = truth**2 + floor_of(truth)
    noise = np.mean(reference.stderr[..., 1] ** 2 / below)
    _, facts = render(program, scene, [*common, "--integrator", "path", "--spp", "2"], folder)
    load_s = facts["cpu_seconds"] - facts["seconds"]
    rows = {}
    for name, algorithm in CANDIDATES.items():
        errors, seconds = [], []
        for seed in range(1, options.repeats + 1):
            words = [*common, *algorithm, "--spp", str(options.spp), "--seed", str(seed)]
            picture, facts = render(program, scene, words, folder)
            errors.append(np.mean((picture.xyz[..., 1] - truth) ** 2 / below) - noise)
            seconds.append(facts["cpu_seconds"] - load_s)
        samples = options.spp * truth.size
        rows[name] = {"relmse": float(np.mean(errors) * options.spp), "each": [float(e * options.spp) for e in errors],
                      "seconds": float(np.median(seconds) / samples)}
    return {"measured": rows, "reference_noise": float(noise), "auto": picked(options, scene)}


def picked(options, scene):
    """What auto makes of a scene at its own size."""
    command = [options.auto, str(REFERENCE / scene / "scene.json"), str(options.time)]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def main():
    """Measures the scenes that are named, or all, and writes JSON."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("--program", default="target/release/etalon")
    parser.add_argument("--auto", default="target/release/examples/auto", help="the example of that name")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--reference-spp", type=int, default=1024)
    parser.add_argument("--repeats", type=int, default=4)
    parser.add_argument("--time", type=float, default=60.0)
    parser.add_argument("-o", "--output", type=Path, required=True)
    options = parser.parse_args()
    found = json.loads(options.output.read_text()) if options.output.exists() else {}
    with tempfile.TemporaryDirectory() as folder:
        for scene in options.scenes:
            found[scene] = measured(options.program, scene, options, Path(folder))
            options.output.write_text(json.dumps(found, indent=1) + "\n")
            print(scene, "auto:", found[scene]["auto"]["pick"])
            best = min(row["relmse"] * row["seconds"] for row in found[scene]["measured"].values())
            estimated = {row["name"]: row for row in found[scene]["auto"]["candidates"]}
            for name, row in found[scene]["measured"].items():
                guess = estimated.get(name, {})
                cost = row["relmse"] * row["seconds"]
                print(f"  {name:18} relMSE {row['relmse']:9.3g}  {1e6 * row['seconds']:6.2f} us  {best / cost:6.3f}"
                      f"   auto: {guess.get('relmse_per_sample')} {guess.get('seconds_per_sample')} {guess.get('efficiency')}",
                      flush=True)


if __name__ == "__main__":
    main()
