"""Faces of a scene's objects, by name, as quads in the layout's unit of length.

The scene is the one place that says where surfaces are: a layout names an
object, and for a box one of its sides "-x" ... "+z", and gets the corners with
the object's transform applied. Corners keep the scene's order; a box's side
lists them around, its next two axes low-low, high-low, high-high, low-high.
"""

from pathlib import Path

import numpy as np

from .errors import InputError, meaning, read_json

METERS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}
SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")


def rotation(axis, degrees):
    """The 4x4 matrix of a right-handed turn about an axis through the origin (Rodrigues)."""
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle, turn = np.radians(float(degrees)), np.eye(4)
    turn[:3, :3] = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    return turn


def step_matrix(step):
    """The 4x4 matrix of one step of an object's transform."""
    (kind, value), = step.items()
    matrix = np.eye(4)
    if kind == "rotate":
        return rotation(value["axis"], value["degrees"])
    if kind == "translate":
        matrix[:3, 3] = np.asarray(value, float).reshape(3)
    elif kind == "scale":
        matrix[:3, :3] = np.diag(np.broadcast_to(np.asarray(value, float), 3))
    elif kind == "matrix":
        rows = np.asarray(value, float)
        matrix[: len(rows), : rows.shape[1]] = rows
    else:
        raise ValueError(f'unknown transform "{kind}"')
    return matrix


def box_side(box, side):
    """The corners (4, 3) of one side of an axis-parallel box."""
    if side not in SIDES:
        raise KeyError(side)
    low, high = np.asarray(box["min"], float), np.asarray(box["max"], float)
    axis = "xyz".index(side[1])
    second, third = (axis + 1) % 3, (axis + 2) % 3
    corners = np.empty((4, 3))
    corners[:, axis] = high[axis] if side[0] == "+" else low[axis]
    corners[:, second] = [low[second], high[second], high[second], low[second]]
    corners[:, third] = [low[third], low[third], high[third], high[third]]
    return corners


class SceneFaces:
    """The objects of a scene file by name; read when the first face is asked for."""

    def __init__(self, path, unit):
        self.path, self.unit, self.objects, self.scale = Path(path), unit, None, 1.0

    def read(self):
        """Reads the scene once."""
        scene = read_json(self.path, "faces of the layout name its objects")
        with meaning(self.path, "correct it (etalon check names the place)"):
            self.objects = {entry["name"]: entry for entry in scene["objects"] if "name" in entry}
            self.scale = METERS[scene["length_unit"]] / METERS[self.unit]

    def quad(self, name, side, order, place):
        """The corners (4, 3) of an object's face; `order` lists them anew by index.

        `InputError` at `place` where the scene has no such object or it no such face.
        """
        if self.objects is None:
            self.read()
        if name not in self.objects:
            raise InputError(place, f'names no object "{name}" of {self.path.name}', "name one of " + ", ".join(f'"{known}"' for known in self.objects))
        thing = self.objects[name]
        with meaning(f'{self.path}: object "{name}"', "correct it (etalon check names the place)"):
            corners = self.local(thing["shape"], side, place)
            matrix = np.eye(4)
            for step in thing.get("transform", []):
                matrix = step_matrix(step) @ matrix
            corners = corners @ matrix[:3, :3].T + matrix[:3, 3]
        order = list(range(4)) if order is None else order
        if sorted(order) != [0, 1, 2, 3]:
            raise InputError(place, "corners is no order of 0, 1, 2, 3", "list each index once, or leave it out")
        return self.scale * corners[order]

    def local(self, shape, side, place):
        """The corners before the object's transform."""
        if "quad" in shape:
            if side is not None:
                raise InputError(place, "a quad has one face only", 'leave "face" out')
            return np.asarray(shape["quad"]["vertices"], float).reshape(4, 3)
        if "box" in shape:
            if side not in SIDES:
                raise InputError(place, f"a box has no face {side!r}", "name one of " + ", ".join(SIDES))
            return box_side(shape["box"], side)
        raise InputError(place, "only quads and boxes have flat faces", "name another object or give a quad")
