"""Shapes of a scene file in the world's coordinates: flat faces, spheres, closed cylinders, disks.

Boxes become six faces with their corners counter-clockwise from outside, which
all renderers take for the front. Transforms are applied here, once; round shapes
take those that leave them round and no others.
"""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from .errors import InputError

# Corners of a box: bit 0 is x, bit 1 y, bit 2 z; each face counter-clockwise from outside.
BOX_FACES = ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6))


@dataclass(frozen=True)
class Faces:
    """Flat faces by the numbers of their corners, counter-clockwise seen from the front."""

    vertices: tuple
    faces: tuple

    @property
    def triangles(self):
        """The faces as triangles, each a fan around its first corner."""
        return tuple((face[0], *pair) for face in self.faces for pair in zip(face[1:], face[2:]))

    @property
    def area(self):
        """Area of all faces in square units."""
        corners = np.array(self.vertices)[np.array(self.triangles)]
        return 0.5 * float(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum())


@dataclass(frozen=True)
class Sphere:
    """Facing outwards."""

    center: tuple
    radius: float

    @property
    def area(self):
        """Area in square units."""
        return 4 * np.pi * self.radius**2


@dataclass(frozen=True)
class Cylinder:
    """Facing outwards, closed by disks at both ends."""

    start: tuple
    end: tuple
    radius: float

    @property
    def area(self):
        """Area of side and ends in square units."""
        return 2 * np.pi * self.radius * (float(np.linalg.norm(np.subtract(self.end, self.start))) + self.radius)


@dataclass(frozen=True)
class Disk:
    """Facing along its normal, which has length 1."""

    center: tuple
    normal: tuple
    radius: float

    @property
    def area(self):
        """Area in square units."""
        return np.pi * self.radius**2


def shape_of(described, transforms, place):
    """The shape of an object in the world's coordinates."""
    (kind, values), *_ = described.items()
    linear, shift = affine(transforms, place)
    if kind in ("quad", "box", "mesh"):
        vertices, faces = corners_of(kind, values, place)
        moved = np.array(vertices, float) @ linear.T + shift
        # A reflection turns front to back unless the corners run the other way.
        turn = -1 if np.linalg.det(linear) < 0 else 1
        return Faces(tuple(map(tuple, moved.tolist())), tuple(tuple(face[::turn]) for face in faces))
    scale = similarity(linear, place)

    def moved(point):
        return tuple((linear @ np.array(point, float) + shift).tolist())

    if kind == "sphere":
        return Sphere(moved(values["center"]), float(scale * values["radius"]))
    if kind == "cylinder" and values.get("capped", True):
        return Cylinder(moved(values["from"]), moved(values["to"]), float(scale * values["radius"]))
    if kind == "disk":
        normal = linear @ np.array(values["normal"], float)
        return Disk(moved(values["center"]), tuple((normal / np.linalg.norm(normal)).tolist()), float(scale * values["radius"]))
    raise InputError(place, f'shape "{kind}" is not understood by the peers', "use quad, box, mesh, sphere, closed cylinder or disk")


def corners_of(kind, values, place):
    """Vertices and faces of a flat shape."""
    if kind == "quad":
        return values["vertices"], ((0, 1, 2, 3),)
    if kind == "mesh":
        if values.get("normals"):
            raise InputError(place, "has normals for smooth shading", "leave them out: renderers differ in what they make of them")
        return values["vertices"], values["triangles"]
    ends = (values["min"], values["max"])
    return [[ends[corner >> axis & 1][axis] for axis in range(3)] for corner in range(8)], BOX_FACES


def affine(transforms, place):
    """Matrix (3, 3) and shift of the transforms, applied in order."""
    linear, shift = np.eye(3), np.zeros(3)
    for entry in transforms:
        (kind, value), *_ = entry.items()
        step, by = np.eye(3), np.zeros(3)
        if kind == "translate":
            by = np.array(value, float)
        elif kind == "rotate":
            axis = np.array(value["axis"], float)
            step = Rotation.from_rotvec(axis / np.linalg.norm(axis) * np.radians(value["degrees"])).as_matrix()
        elif kind == "scale":
            step = np.diag(np.array(value, float))
        elif kind == "matrix":
            matrix = np.array(value, float)
            step, by = matrix[:, :3], matrix[:, 3]
        else:
            raise InputError(place, f'transform "{kind}" is not understood by the peers', "use translate, rotate, scale or matrix")
        linear, shift = step @ linear, step @ shift + by
    return linear, shift


def similarity(linear, place):
    """The factor by which a matrix scales all directions alike."""
    scale = float(np.cbrt(abs(np.linalg.det(linear))))
    if not np.allclose(linear.T @ linear, scale**2 * np.eye(3), atol=1e-9 * scale**2):
        raise InputError(place, "is round, and scaled by other factors along other axes", "scale round shapes alike in all directions")
    return scale
