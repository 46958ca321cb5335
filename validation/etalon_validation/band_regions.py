"""Regions of two cameras: the same patches of the box, seen in a render and in band images.

Each side is measured through its own camera. The render's is the scene's; that
of the band images is fitted to picked points where they are given, and taken to
be the scene's where not. A patch counts where both see nothing but its face.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .camera import Pinhole, unit
from .errors import InputError, meaning, read_json
from .layout import Face, Layout
from .pose import Frame, fit_pose, read_points
from .registration import METERS, scene_camera

# Corners of a box's faces, as choices of minimum and maximum along x, y, z.
BOX_FACES = (
    ((0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)), ((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
    ((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)), ((0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
    ((0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)), ((0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)),
)


@dataclass(frozen=True)
class Pair:
    """A patch and its outline in the render and in the band images, pixels."""

    name: str
    surface: str
    in_render: np.ndarray
    in_bands: np.ndarray


@dataclass(frozen=True)
class Sight:
    """The camera of the band images, how it was found, and the regions that both sides see."""

    camera: Pinhole
    pose: dict
    pairs: tuple
    dropped: tuple


def find_regions(plan, scene, scene_path, render_size, bands_size, points):
    """The regions of a case in both pictures."""
    length = plan.table["length_unit"]
    with meaning(scene_path, "correct the camera"):
        ours = scene_camera(scene, length, render_size)
        assumed = scene_camera(scene, length, bands_size)
    if ours is None:
        raise InputError(scene_path, "has no camera", "add one")
    for name, size in (("the render", render_size), ("the band images", bands_size)):
        check_shape(scene, scene_path, name, size)
    theirs, pose = fitted(plan, points, bands_size) if points else (assumed, {"kind": "scene"})
    sides = [patches(plan, scene, camera, with_mirrors=not points) for camera in (ours, theirs)]
    both = [Pair(name, surface, polygon, sides[1][name][1]) for name, (surface, polygon) in sides[0].items() if name in sides[1]]
    dropped = sorted(set(sides[0]) ^ set(sides[1]))
    if len({pair.surface for pair in both}) < 2:
        raise InputError(plan.path, f"{len(both)} regions are seen in both pictures", "check the scene's camera, or give --points")
    return Sight(theirs, pose, tuple(both), tuple(dropped))


def check_shape(scene, path, name, size):
    """Refuses a picture of another shape than the scene's."""
    width, height = scene["camera"]["resolution"]
    if abs(size[0] * height / (size[1] * width) - 1) > 0.005:
        raise InputError(path, f"its camera has {width}x{height} pixels, {name} {size[0]}x{size[1]}", "use pictures of one shape")


def fitted(plan, points, size):
    """The camera fitted to picked points, and what the fit says."""
    world, pixels, length, names = read_points(points)
    if length != plan.table["length_unit"]:
        raise InputError(points, f"is in {length}", f"write the columns in {plan.table['length_unit']}")
    with meaning(plan.path, "give level.look and level.up"):
        level = plan.table["level"]
        frame = Frame(unit(level["look"]), unit(level["up"]), tuple(size), length)
    try:
        pose = fit_pose(world, pixels, frame, names)
    except (np.linalg.LinAlgError, ValueError) as error:
        raise InputError(points, f"fix no camera ({error})", "pick vertices that span the picture and lie in more than one plane") from None
    camera = Pinhole.looking(pose[f"position_{length}"], pose["look"], pose["up"], pose["horizontal_fov_deg"], tuple(size), tuple(pose["principal_point_px"]), pose["k1"])
    return camera, {"kind": "fitted", "points": pose["points"], "rms_px": pose["rms_px"], "parameters": pose["models"][pose["chosen"]]["parameters"]}


def patches(plan, scene, camera, with_mirrors):
    """Surface and outline by name of every patch that a camera sees whole, those on mirrors only if asked for."""
    layout = Layout((Path(plan.path).parent / plan.table["layout"]).resolve())
    scale = camera.size[0] / layout.camera.size[0]
    # What the photograph's layout keeps out in pixels stands here as faces of its own.
    layout.camera, layout.keep_out = camera, []
    layout.faces = layout.faces | {face.name: face for name in plan.table["blockers"] for face in blocker(plan, scene, name)}
    seen = {}
    for patch in (patch for patch in layout.patches if with_mirrors or not layout.faces[patch.face].mirror):
        polygon, share = layout.polygon(replace(patch, erode_px=patch.erode_px * scale))
        if share == 1.0:
            seen[patch.name] = (patch.surface, polygon)
    return seen


def blocker(plan, scene, name):
    """The faces of an object that hides part of the box."""
    entry = next((entry for entry in scene["objects"] if entry.get("name") == name), None)
    if entry is None:
        raise InputError(plan.path, f'the scene has no object "{name}"', "correct blockers")
    scale = METERS[scene["length_unit"]] / METERS[plan.table["length_unit"]]
    with meaning(plan.path, f'"{name}" should be a quad, or a box without transform'):
        if "quad" in entry["shape"]:
            return [Face(name, scale * np.array(entry["shape"]["quad"]["vertices"], float), False)]
        ends = scale * np.array([entry["shape"]["box"]["min"], entry["shape"]["box"]["max"]], float)
        if "transform" in entry:
            raise ValueError("it is transformed")
        return [Face(f"{name} {index}", np.array([[ends[c[axis], axis] for axis in range(3)] for c in face]), False) for index, face in enumerate(BOX_FACES)]


def read_scene(case):
    """The scene of a case and its path."""
    path = Path(case) / "scene.json"
    return read_json(path, "correct it"), path
