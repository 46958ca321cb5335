"""How far a case's scene camera stands from the camera fitted to its photograph.

Regions lie where the fitted camera puts them. A scene with another camera shows
other surfaces there, and no colour difference would tell.
"""

from pathlib import Path

import numpy as np

from .camera import Pinhole
from .errors import InputError, meaning, read_json
from .layout import REGISTRATION_PX, Layout
from .scene_faces import METERS


def scene_camera(scene, length, size):
    """The scene's pinhole in `length` units for an image of `size`; None when the scene has no camera."""
    camera = scene.get("camera")
    if not camera:
        return None
    scale = METERS[scene["length_unit"]] / METERS[length]
    position = scale * np.array(camera["position"], float)
    look = np.array(camera["direction"], float) if camera.get("direction") else scale * np.array(camera["look_at"], float) - position
    hfov_deg = 2 * np.degrees(np.arctan(camera["sensor_mm"][0] / 2 / camera["focal_length_mm"]))
    shift = np.array(camera.get("principal_point_px", (0, 0)), float) * size[0] / camera["resolution"][0]
    return Pinhole.looking(position, look, camera["up"], hfov_deg, size, tuple(shift))


def registration(case):
    """Mean and largest distance in pixels between face corners seen by both cameras; None without both."""
    case = Path(case)
    if not all((case / name).is_file() for name in ("scene.json", "layout.json", "pose.json")):
        return None
    layout = Layout(case / "layout.json")
    pose = read_json(case / "pose.json", "run fit-pose")
    length = next(key.removeprefix("position_") for key in pose if key.startswith("position_"))
    scene = read_json(case / "scene.json", "correct it")
    with meaning(case / "scene.json", "correct the camera"):
        camera = scene_camera(scene, length, layout.camera.size)
    if camera is None:
        return None
    corners = np.unique(np.concatenate([face.quad for face in layout.faces.values()]), axis=0)
    fitted = layout.camera.project(corners)
    seen = ((fitted >= 0) & (fitted <= layout.camera.size)).all(axis=1) & ((corners - layout.camera.position) @ layout.camera.look > 0)
    if not seen.any():
        raise InputError(case / "pose.json", "its camera sees no corner of the box", "run fit-pose again")
    distance = np.linalg.norm(camera.project(corners[seen]) - fitted[seen], axis=1)
    return {"mean_px": round(float(distance.mean()), 2), "largest_px": round(float(distance.max()), 2), "corners": int(seen.sum()), "allowed_px": REGISTRATION_PX}


def registration_warning(found):
    """The warning that a badly registered scene deserves, or None."""
    if found is None or found["largest_px"] <= found["allowed_px"]:
        return None
    return (
        f"scene.json: its camera puts corners of the box up to {found['largest_px']:.1f} px from where pose.json finds them in the photograph; "
        "take the camera from pose.json, or regions show other surfaces than the photograph"
    )
