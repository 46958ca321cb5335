"""Pictures of a scene under basis functions of its lamp's profile, rendered by etalon.

Light adds up: with a picture for each basis function, any profile is a weighted sum of
pictures, and fitting one needs no further render. The basis is even in the angle from the
axis, (angle / 90 degrees)^order, times the cosine for a flat lamp, and dark behind the lamp.
"""

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError, meaning, read_json
from .render import read_render

# Angles at which a basis function is tabulated.
STEP_DEG = 2.0
RIGHT_ANGLE_DEG = 90.0
# The level cancels: the exposure is fitted.
INTENSITY_CD = 100.0
# The first case's seed; a case's further pictures and the next case take the next ones.
FIRST_SEED = 1


@dataclass(frozen=True)
class Lamp:
    """The object that is the lamp, the axis of its profile in world axes, and the even orders of its basis."""

    object: str
    axis: tuple
    orders: tuple

    def profile(self, weights, angles_deg):
        """Intensity at angles for weights of the basis, on the weights' scale; of a flat lamp, radiance."""
        share = np.asarray(angles_deg, float) / RIGHT_ANGLE_DEG
        return sum(weight * share**order for weight, order in zip(weights, self.orders))

    def light(self, scene, weights):
        """The entry of the scene's `lights` that stands for the lamp with these weights."""
        angles = np.arange(0, RIGHT_ANGLE_DEG + STEP_DEG / 2, STEP_DEG)
        shape = lamp_object(scene, self.object)
        intensity = np.maximum(self.profile(weights, angles), 0)
        if "quad" in shape["shape"]:
            intensity = intensity * np.maximum(np.cos(np.radians(angles)), 0)
        distribution = {"profile": {"axis": list(self.axis), "angles_deg": angles.tolist(), "relative_intensity": intensity.tolist()}}
        emission = {"spectrum": shape["emission"]["spectrum"], "level": {"intensity_cd": INTENSITY_CD}}
        return {"point": {"position": centre(shape["shape"]), "distribution": distribution, "emission": emission}}


@dataclass(frozen=True)
class Renderer:
    """The program etalon, and how much it is to render."""

    program: Path
    spp: int
    threads: int | None = None

    def render(self, source, size, seed, output):
        """Renders a scene file to an EXR and reads it."""
        command = [self.program, "render", source, "-o", output, "--integrator", "path", "--spp", self.spp, "--seed", seed, "--resolution", f"{size[0]}x{size[1]}"]
        if self.threads:
            command += ["--threads", self.threads]
        done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
        if done.returncode:
            raise InputError(source, done.stderr.strip() or "cannot be rendered", "render it by hand to see why")
        return read_render(output)


def lamp_object(scene, name):
    """The scene's object of this name; a `KeyError` where it is no luminous sphere or quad."""
    found = next((entry for entry in scene["objects"] if entry.get("name") == name), None)
    if found is None or "emission" not in found or not {"sphere", "quad"} & set(found["shape"]):
        raise KeyError(name)
    return found


def centre(shape):
    """The centre of a sphere or a quad, in the scene's coordinates."""
    if "sphere" in shape:
        return shape["sphere"]["center"]
    return np.mean(shape["quad"]["vertices"], axis=0).tolist()


def scenes(scene, lamp):
    """The scene once for each basis function, the lamp replaced by a point; the scene itself without a lamp."""
    if lamp is None:
        return [scene]
    others = [entry for entry in scene["objects"] if entry.get("name") != lamp.object]
    lights = [lamp.light(scene, np.eye(len(lamp.orders))[index]) for index in range(len(lamp.orders))]
    return [scene | {"objects": others, "lights": scene.get("lights", []) + [light]} for light in lights]


def render_basis(renderer, case, lamp, size, seed, folder):
    """Renders (k) of a case's scene under each basis function, at `size`, and their files in `folder`."""
    file = Path(case) / "scene.json"
    scene = read_json(file, "a case needs a scene.json")
    with meaning(file, "name a luminous sphere or quad of the scene as the lamp"):
        variants = scenes(scene, lamp)
    files = [folder / f"{Path(case).name}-{index}.exr" for index in range(len(variants))]
    renders = []
    for index, variant in enumerate(variants):
        # Beside the original file, paths in the scene would mean the same; built-in spectra do anywhere.
        source = file if lamp is None else folder / f"{Path(case).name}-{index}.json"
        if lamp is not None:
            source.write_text(json.dumps(variant), encoding="utf-8")
        renders.append(renderer.render(source, size, seed + index, files[index]))
    return renders, files
