"""Offsets between a photograph and a render along the visible edges of the scene.

Shading differs between a photograph and a render, edges do not move: at points
on the projected edges of the faces, a profile across the edge is taken from
both pictures, each through its own camera, and the photograph's is shifted
until the two correlate best. Gain and offset of the profiles, and with them
exposure and slow shading, drop out. A point counts only where
the render has a step at the edge and the photograph one of the same kind; the
median along the edge keeps single bright pixels out.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from .polygons import inside

# Distance between measured points along an edge, pixels.
SPACING_PX = 6.0
# Half the stretch of edge whose median makes one profile, pixels.
ALONG_PX = 3
# Half the length of a profile that must correlate, pixels, and its sampling.
HALF_PX = 5.0
STEP_PX = 0.25
# Least correlation of the two profiles at their best shift.
CORRELATION = 0.9
# A step counts when it is this large beside the mean of the profile.
CONTRAST = 0.08
# Darker than this share of the picture's 90th percentile, a profile shows noise.
DARK = 0.02


@dataclass(frozen=True)
class Offsets:
    """Points of edges in the scene (n, 3), where they lie in the photograph (n, 2), the edge's normal there (n, 2),
    the measured offset along it in pixels (n,), and which edge each belongs to (n,)."""

    points: np.ndarray
    pixels: np.ndarray
    normals: np.ndarray
    offsets: np.ndarray
    edges: np.ndarray


@dataclass(frozen=True)
class InView:
    """Points at which the render shows an edge: where the photograph should have them (n, 2), which edge (n,), of which thing (n,)."""

    pixels: np.ndarray
    edges: np.ndarray
    things: np.ndarray


def face_edges(layout):
    """Every edge of the layout's faces once, as pairs of points (n, 2, 3), and the thing (n,) that each belongs to.

    Edges that hang together by their ends are one thing: the shell of a room, a block in it.
    """
    kept, things = {}, {}
    extent = max(np.ptp(face.quad) for face in layout.faces.values())
    for face in layout.faces.values():
        ends = [tuple(np.round(corner / extent, 4) + 0.0) for corner in face.quad]
        joined = {things.get(end, end) for end in ends}
        first = min(joined)
        things |= {end: first for end in ends}
        things |= {end: first for end, thing in things.items() if thing in joined}
        for index in range(4):
            kept.setdefault(frozenset((ends[index], ends[index - 3])), (face.quad[index], face.quad[index - 3]))
    names = {thing: number for number, thing in enumerate(dict.fromkeys(things.values()))}
    return np.array(list(kept.values())), np.array([names[things[min(key)]] for key in kept])


def along(layout, start, end):
    """Points (n, 3) on an edge, SPACING_PX apart in the image and inside it, none at its ends."""
    near = 0.02 * np.linalg.norm(end - start)
    share = np.linspace(0, 1, 512)
    points = start + share[:, None] * (end - start)
    points = points[layout.camera.depth(points) > near]
    if len(points) < 8:
        return np.zeros((0, 3))
    pixels = layout.camera.project(points)
    framed = ((pixels > 0) & (pixels < np.asarray(layout.camera.size))).all(axis=1)
    points, pixels = points[framed], pixels[framed]
    if len(points) < 8:
        return np.zeros((0, 3))
    run = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(pixels, axis=0), axis=1))])
    places = np.arange(HALF_PX + ALONG_PX, run[-1] - HALF_PX - ALONG_PX, SPACING_PX)
    return np.array([np.interp(places, run, column) for column in points.T]).T.reshape(-1, 3)


def visible(layout, points, normals):
    """Where nothing hides the edge and its two sides show two different faces.

    An edge against the surroundings is left out: it is the rim of a wall, and walls have a thickness that scenes
    made of faces do not.
    """
    pixels = layout.camera.project(points)
    sides = []
    for sign in (-1.0, 1.0):
        beside = layout.camera.rays(pixels + sign * normals)
        name, distance = layout.nearest(np.broadcast_to(layout.camera.position, beside.shape), beside)
        sides.append((name, distance))
    reach = np.linalg.norm(points - layout.camera.position, axis=1)
    nearest = np.minimum(sides[0][1], sides[1][1])
    free = nearest > 0.97 * reach
    for polygon in layout.keep_out:
        free &= ~inside(polygon, pixels, HALF_PX)
    return free & (sides[0][0] != sides[1][0]) & (sides[0][0] != "") & (sides[1][0] != "")


def profiles(image, camera, points, tangent_to, reach):
    """Profiles (n, m) across edges at points, from -reach to +reach along the normal, and the pixels and normals.

    `tangent_to` are neighbouring points on the edges; they give the direction.
    """
    pixels, beyond = camera.project(points), camera.project(tangent_to)
    tangent = beyond - pixels
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-12)
    normals = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    across = np.arange(-reach, reach + STEP_PX / 2, STEP_PX)
    strips = []
    for shift in range(-ALONG_PX, ALONG_PX + 1):
        where = pixels[:, None] + shift * tangent[:, None] + across[None, :, None] * normals[:, None]
        # Array index i has its centre at the pixel coordinate i + 0.5.
        strips.append(ndimage.map_coordinates(image, [where[..., 1] - 0.5, where[..., 0] - 0.5], order=1, mode="nearest"))
    return np.median(strips, axis=0), pixels, normals


def best_shift(wanted, given, search):
    """For profiles (n, w) in longer ones (n, g): the shift in pixels with the largest correlation, that correlation, and the contrast found."""
    width = wanted.shape[1]
    windows = np.lib.stride_tricks.sliding_window_view(given, width, axis=1)
    count = windows.shape[1]
    a = wanted - wanted.mean(axis=1, keepdims=True)
    squares = (windows**2).sum(axis=2) - width * windows.mean(axis=2) ** 2
    norm = np.sqrt((a**2).sum(axis=1))[:, None] * np.sqrt(np.maximum(squares, 0))
    # The mean of a window drops out against a profile without mean.
    score = np.einsum("nw,ncw->nc", a, windows) / np.maximum(norm, 1e-12)
    rows, best = np.arange(len(wanted)), score.argmax(axis=1)
    edge = (best == 0) | (best == count - 1)
    middle = np.clip(best, 1, count - 2)
    left, top, right = (score[rows, middle + step] for step in (-1, 0, 1))
    bend = left - 2 * top + right
    fine = np.where(bend < 0, 0.5 * (left - right) / np.where(bend < 0, bend, -1), 0)
    shift = (middle + np.clip(fine, -1, 1)) * STEP_PX - search
    return shift, np.where(edge, -1.0, score[rows, best]), contrast(windows[rows, best])


def contrast(strips):
    """The step of profiles (n, m), relative to their mean."""
    return np.ptp(strips, axis=1) / np.maximum(np.abs(strips).mean(axis=1), 1e-12)


def grey(image):
    """The mean (h, w) of a picture's channels (h, w, 3), each in units of its own 90th percentile: no white balance shows in it."""
    level = np.percentile(image, 90, axis=(0, 1))
    return np.mean(np.clip(image, 0, None) / np.maximum(level, 1e-12), axis=2)


def measure_offsets(layout, photo, render, render_camera, search):
    """The offsets that a photograph (h, w) shows against a render (h, w), searched to `search` pixels either way, and the
    points that could have been found.

    `layout` is seen by the photograph's camera; both pictures as `grey` makes them.
    """
    starts, tips, belongs = [], [], []
    ends, things = face_edges(layout)
    for index, (start, end) in enumerate(ends):
        points = along(layout, start, end)
        starts.append(points)
        tips.append(points + 1e-3 * (end - start))
        belongs.append(np.full(len(points), index))
    points, tips, belongs = np.concatenate(starts), np.concatenate(tips), np.concatenate(belongs)
    given, pixels, normals = profiles(photo, layout.camera, points, tips, HALF_PX + search)
    wanted, seen, _ = profiles(render, render_camera, points, tips, HALF_PX)
    shift, score, step = best_shift(wanted, given, search)
    within = ((pixels > HALF_PX) & (pixels < np.asarray(layout.camera.size) - HALF_PX)).all(axis=1)
    within &= ((seen > HALF_PX) & (seen < np.asarray(render_camera.size) - HALF_PX)).all(axis=1)
    candidate = within & (contrast(wanted) > CONTRAST) & (wanted.max(axis=1) > DARK) & visible(layout, points, normals)
    kept = candidate & (score > CORRELATION) & (step > CONTRAST / 2)
    return Offsets(points[kept], pixels[kept], normals[kept], shift[kept], belongs[kept]), InView(pixels[candidate], belongs[candidate], things[belongs[candidate]])
