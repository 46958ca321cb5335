"""Round shapes as triangles, for a renderer that has no others.

Spheres and disks get the area of what they stand for. Glass and mirrors get the
normals of the round shape at their corners besides, which lamps do without:
their radiance is the same in all directions. Triangles of lamps are few, since
the renderer chooses among them one by one.
"""

from dataclasses import dataclass

import numpy as np

from .peer_scene import Cylinder, Disk, Faces, Sphere

# Halvings of an icosahedron's edges: 320 triangles for a lamp, 20480 for the rest.
LAMP_HALVINGS, FINE_HALVINGS = 2, 5
LAMP_SIDES, FINE_SIDES = 32, 256


@dataclass(frozen=True)
class Mesh:
    """Corners (n, 3), triangles (m, 3) counter-clockwise from the front, and normals (n, 3) where it is smooth."""

    points: np.ndarray
    triangles: np.ndarray
    normals: np.ndarray | None = None

    @property
    def area(self):
        """Area in square units."""
        return 0.5 * float(np.linalg.norm(doubled(self.points, self.triangles), axis=1).sum())


def doubled(points, triangles):
    """Twice the area vector of each triangle."""
    corners = points[triangles]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])


def meshes(shape, is_lamp):
    """The meshes of a shape, one for each smooth part."""
    if isinstance(shape, Faces):
        return [Mesh(np.array(shape.vertices, float), np.array(shape.triangles))]
    if isinstance(shape, Sphere):
        return [sphere(shape, is_lamp)]
    sides = LAMP_SIDES if is_lamp else FINE_SIDES
    if isinstance(shape, Disk):
        center = np.array(shape.center, float)
        return [fan(center, center + widened(shape.radius, sides) * round_about(np.array(shape.normal, float), sides))]
    return cylinder(shape, sides, is_lamp)


def sphere(shape: Sphere, is_lamp):
    """An icosahedron whose triangles are halved and pushed out."""
    points, triangles = icosahedron()
    for _ in range(LAMP_HALVINGS if is_lamp else FINE_HALVINGS):
        points, triangles = halved(points, triangles)
    factor = np.sqrt(4 * np.pi / Mesh(points, triangles).area)
    return Mesh(np.array(shape.center) + shape.radius * factor * points, triangles, None if is_lamp else points)


def icosahedron():
    """Corners on the unit sphere, and triangles that face outwards."""
    golden = (1 + np.sqrt(5)) / 2
    points = np.array([corner for a in (-1, 1) for b in (-golden, golden) for corner in ((0, a, b), (a, b, 0), (b, 0, a))], float)
    points /= np.linalg.norm(points[0])
    edge = min(np.linalg.norm(points[0] - point) for point in points[1:])
    near = np.linalg.norm(points[:, None] - points, axis=-1) < 1.01 * edge
    threes = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[i, k]]
    return points, np.array([three if np.linalg.det(points[list(three)]) > 0 else three[::-1] for three in threes])


def halved(points, triangles):
    """Each triangle as four, with the new corners on the unit sphere."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    between = points[unique].sum(axis=1)
    between /= np.linalg.norm(between, axis=1, keepdims=True)
    a, b, c = triangles.T
    ab, bc, ca = len(points) + which.reshape(-1, 3).T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([points, between]), np.concatenate([np.stack(part, axis=1) for part in parts])


def round_about(axis, sides):
    """Unit vectors (sides, 3) at right angles to an axis, counter-clockwise as seen from its tip."""
    axis = axis / np.linalg.norm(axis)
    first = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    first /= np.linalg.norm(first)
    angles = 2 * np.pi * np.arange(sides)[:, None] / sides
    return np.cos(angles) * first + np.sin(angles) * np.cross(axis, first)


def widened(radius, sides):
    """The radius of a regular polygon's corners that gives it the area of a circle."""
    return radius * np.sqrt(2 * np.pi / sides / np.sin(2 * np.pi / sides))


def fan(center, rim):
    """A flat disk with these corners, counter-clockwise from its front."""
    index = np.arange(len(rim))
    return Mesh(np.concatenate([[center], rim]), np.stack([np.zeros(len(rim), int), 1 + index, 1 + (index + 1) % len(rim)], axis=1))


def cylinder(shape: Cylinder, sides, is_lamp):
    """The side and both ends, which share their corners."""
    start, end = np.array(shape.start, float), np.array(shape.end, float)
    out = round_about(end - start, sides)
    rims = [tip + widened(shape.radius, sides) * out for tip in (start, end)]
    low = np.arange(sides)
    following = (low + 1) % sides
    triangles = np.concatenate([np.stack([low, following, sides + following], axis=1), np.stack([low, sides + following, sides + low], axis=1)])
    side = Mesh(np.concatenate(rims), triangles, None if is_lamp else np.concatenate([out, out]))
    return [side, fan(start, rims[0][::-1]), fan(end, rims[1])]
