"""A room with a block seen by ray casting: pictures of any camera, without the renderer, and its case folder."""

import json

import numpy as np

from etalon_validation.camera import Pinhole
from etalon_validation.layout import Layout
from etalon_validation.lens import grid
from etalon_validation.pose import read_frame

from .case import write_exr

SIZE = (240, 180)
# Reflectance-like colours of the six kinds of face, brighter or darker towards one side of the room.
WALLS = {
    "back": [[-1, 0, 2], [1, 0, 2], [1, 1.5, 2], [-1, 1.5, 2]],
    "left": [[1, 0, 0], [1, 0, 2], [1, 1.5, 2], [1, 1.5, 0]],
    "right": [[-1, 0, 2], [-1, 0, 0], [-1, 1.5, 0], [-1, 1.5, 2]],
    "floor": [[1, 0, 0], [-1, 0, 0], [-1, 0, 2], [1, 0, 2]],
    "ceiling": [[1, 1.5, 0], [-1, 1.5, 0], [-1, 1.5, 2], [1, 1.5, 2]],
}
COLOURS = {
    "back": [0.6, 0.6, 0.55], "left": [0.5, 0.12, 0.1], "right": [0.12, 0.4, 0.15], "floor": [0.45, 0.42, 0.4], "ceiling": [0.75, 0.7, 0.7],
    "+x": [0.3, 0.2, 0.6], "-x": [0.2, 0.3, 0.5], "-z": [0.8, 0.6, 0.3], "+z": [0.3, 0.3, 0.3], "+y": [0.95, 0.9, 0.8],
}
SIDES = ("+x", "-x", "-z", "+z", "+y")
CORNERS = np.array([[x, y, z] for x in (-1, 1) for y in (0, 1.5) for z in (0.4, 2)] + [[x, 0.5, z] for x in (-0.3, 0.3) for z in (0.8, 1.4)], float)
POSITION, FOV_DEG = (0.1, 0.8, -1.3), 62.0


def scene(camera=None):
    """The scene file of the room, its block turned by 20 degrees."""
    objects = [{"name": f"{name} wall", "shape": {"quad": {"vertices": quad}}} for name, quad in WALLS.items()]
    block = {"name": "block", "shape": {"box": {"min": [-0.3, 0, -0.3], "max": [0.3, 0.5, 0.3]}}}
    block["transform"] = [{"rotate": {"axis": [0, 1, 0], "degrees": 20}}, {"translate": [-0.2, 0, 1.1]}]
    described = camera or {
        "position": list(POSITION), "direction": [0, 0, 1], "up": [0, 1, 0], "resolution": list(SIZE),
        "focal_length_mm": 50 / np.tan(np.radians(FOV_DEG / 2)), "sensor_mm": [100, 75],
    }
    return {"length_unit": "m", "objects": [*objects, block], "camera": described}


def write_room(folder, k1=0.0):
    """scene.json, layout.json, pose.json and points.csv of the room; returns the layout and its frame."""
    faces = {name: {"object": f"{name} wall"} for name in WALLS} | {f"block {side}": {"object": "block", "face": side} for side in SIDES}
    patches = [{"name": name, "face": name, "grid": [2, 2]} for name in ("back", "left", "right", "floor", "ceiling")]
    patches += [{"name": "front", "face": "block -z", "grid": [1, 1], "rect": [0.05, 0.05, 0.95, 0.95]}]
    pose = {"position_m": list(POSITION), "look": [0, 0, 1], "up": [0, 1, 0], "horizontal_fov_deg": FOV_DEG, "image_px": list(SIZE), "k1": k1}
    level = {"look": [0, 0, 1], "up": [0, 1, 0]}
    (folder / "scene.json").write_text(json.dumps(scene()))
    (folder / "pose.json").write_text(json.dumps(pose))
    (folder / "layout.json").write_text(json.dumps({
        "photo": {}, "camera": {"pose": "pose.json", "image_px": list(SIZE), "level": level}, "erode_px": 3, "faces": faces, "patches": patches,
    }))
    layout = Layout(folder / "layout.json")
    pixels = layout.camera.project(CORNERS)
    rows = [f"corner {index},{x},{y},{z},{u},{v}" for index, ((x, y, z), (u, v)) in enumerate(zip(CORNERS.tolist(), pixels.tolist()))]
    (folder / "points.csv").write_text("name,x_m,y_m,z_m,u_px,v_px\n" + "\n".join(rows) + "\n")
    return layout, read_frame(folder / "layout.json", "m")


def seen(layout, camera, shading=0.0, over=3):
    """The room's linear RGB (h, w, 3) by a camera, `over` x `over` rays a pixel; `shading` darkens it from left to right."""
    fine = camera.resized((camera.size[0] * over, camera.size[1] * over))
    # Rays jittered within their cells: along an edge parallel to the rows a regular grid would be off by the same part of a cell.
    directions = fine.rays(grid(fine.size) + np.random.default_rng(7).random((fine.size[0] * fine.size[1], 2)) - 0.5)
    names, distance = layout.nearest(np.broadcast_to(fine.position, directions.shape), directions)
    colours = np.zeros((len(names), 3))
    for name in layout.faces:
        colours[names == name] = COLOURS[name.removeprefix("block ")]
    places = fine.position + np.where(np.isfinite(distance), distance, 0)[:, None] * directions
    colours *= (1 - shading * (places[:, :1] + 1) / 2) * (0.8 + 0.1 * places[:, 1:2])
    return colours.reshape(camera.size[1], over, camera.size[0], over, 3).mean(axis=(1, 3))


def write_photo(path, rgb):
    """A linear photograph as EXR."""
    write_exr(path, rgb, ["R", "G", "B"])


def nominal(size=SIZE):
    """The camera of the room."""
    return Pinhole.looking(POSITION, (0, 0, 1), (0, 1, 0), FOV_DEG, size)
