"""Convex polygons in pixel coordinates: erosion, and the pixels inside."""

import numpy as np


def area(polygon):
    """Signed area of a polygon (n, 2), square pixels."""
    x, y = np.asarray(polygon, float).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def clip(polygon, point, normal):
    """The part of a convex polygon on the side of `point` that `normal` looks to."""
    kept = []
    heights = (polygon - point) @ normal
    for i, (here, height) in enumerate(zip(polygon, heights)):
        there, other = polygon[(i + 1) % len(polygon)], heights[(i + 1) % len(polygon)]
        if height >= 0:
            kept.append(here)
        if (height >= 0) != (other >= 0):
            kept.append(here + (there - here) * height / (height - other))
    return np.array(kept).reshape(-1, 2)


def erode(polygon, distance):
    """A convex polygon moved inwards by `distance` pixels; empty when nothing is left."""
    polygon = np.asarray(polygon, float)
    if area(polygon) < 0:
        polygon = polygon[::-1]
    eroded = polygon
    for start, end in zip(polygon, np.roll(polygon, -1, axis=0)):
        edge = end - start
        length = np.linalg.norm(edge)
        if length < 1e-9 or len(eroded) == 0:
            continue
        inward = np.array([-edge[1], edge[0]]) / length
        eroded = clip(eroded, start + distance * inward, inward)
    return eroded if len(eroded) >= 3 else np.zeros((0, 2))


def inside_image(polygon, size, margin):
    """The part of a convex polygon at least `margin` pixels inside an image (width, height)."""
    polygon = np.asarray(polygon, float)
    if area(polygon) < 0:
        polygon = polygon[::-1]
    near, far = np.full(2, float(margin)), np.asarray(size, float) - margin
    for point, normal in ((near, (1, 0)), (near, (0, 1)), (far, (-1, 0)), (far, (0, -1))):
        polygon = clip(polygon, point, np.array(normal, float)) if len(polygon) else polygon
    return polygon


def mask(polygon, size):
    """Which pixels of an image (width, height) have their centre inside the polygon (even-odd)."""
    width, height = size
    u, v = np.arange(width)[None, :] + 0.5, np.arange(height)[:, None] + 0.5
    within = np.zeros((height, width), dtype=bool)
    polygon = np.asarray(polygon, float)
    for (u0, v0), (u1, v1) in zip(polygon, np.roll(polygon, -1, axis=0)):
        if v0 == v1:
            continue
        crosses = (v0 <= v) != (v1 <= v)
        within ^= crosses & (u < u0 + (v - v0) / (v1 - v0) * (u1 - u0))
    return within


def inside(polygon, points, margin):
    """Which points (n, 2) lie in a convex polygon, or within `margin` pixels of its lines."""
    polygon = np.asarray(polygon, float)
    if area(polygon) < 0:
        polygon = polygon[::-1]
    edges = np.roll(polygon, -1, axis=0) - polygon
    inward = np.stack([-edges[:, 1], edges[:, 0]], axis=1) / np.linalg.norm(edges, axis=1, keepdims=True)
    return np.all([(points - point) @ normal >= -margin for point, normal in zip(polygon, inward)], axis=0)
