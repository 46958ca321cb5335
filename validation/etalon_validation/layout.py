"""Where the regions lie: patches on the faces of a box, seen through its camera.

A layout (`layout.json` in a case folder) names faces of the scene's objects, or
gives quads of its own where no object has the face, some of them mirrors, and
patches as rectangles in a face's own coordinates: (0, 0) is the first vertex,
(1, 0) the second, (1, 1) the third. A patch on a mirror names the
face that it `shows` ("" for the surroundings). Each projected patch is eroded,
and every pixel of it must see that face along the ray.
"""

import copy
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .camera import Pinhole, unit
from .errors import InputError, meaning, need, read_json
from .polygons import erode, inside_image, mask
from .scene_faces import METERS, SceneFaces

# A patch must stay on its face when the photograph is registered this badly.
REGISTRATION_PX = 1.5
# Fewer pixels than this are no measurement.
LEAST_PIXELS = 30


@dataclass(frozen=True)
class Face:
    """A convex planar quad; `mirror` faces pass the view on."""

    name: str
    quad: np.ndarray
    mirror: bool

    @property
    def normal(self):
        """Unit normal, on either side."""
        return unit(np.cross(self.quad[1] - self.quad[0], self.quad[3] - self.quad[0]))

    def at(self, s, t):
        """The point at the face's own coordinates (s, t)."""
        a, b, c, d = self.quad
        return (1 - s) * (1 - t) * a + s * (1 - t) * b + s * t * c + (1 - s) * t * d

    def reflect(self, directions):
        """Directions (n, 3) mirrored in the face's plane."""
        return directions - 2 * (directions @ self.normal)[:, None] * self.normal

    def distance(self, origins, directions):
        """Distance along each ray to the face, infinite where the ray misses it."""
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = ((self.quad[0] - origins) @ self.normal) / (directions @ self.normal)
            points = origins + distance[:, None] * directions
            sides = [
                np.einsum("ij,j->i", np.cross(end - start, points - start), self.normal)
                for start, end in zip(self.quad, np.roll(self.quad, -1, axis=0))
            ]
        within = np.all([side >= 0 for side in sides], axis=0)
        return np.where(within & (distance > 1e-6), distance, np.inf)


@dataclass(frozen=True)
class Patch:
    """One region to measure: a rectangle on a face, and the face seen in it when it is a mirror."""

    name: str
    surface: str
    face: str
    shows: str | None
    rect: tuple
    may_drop: bool
    erode_px: float


class Layout:
    """Faces, patches and camera of one case."""

    def __init__(self, path):
        self.path = Path(path)
        table = read_json(self.path, "a case needs a layout.json to measure regions")
        with meaning(self.path, "correct it"):
            self.take(table)

    def take(self, table):
        """Fills the layout from its JSON object."""
        path = self.path
        self.scale = 1.0
        self.photo = dict(need(table, "photo", path))
        self.camera, self.length_unit = read_camera(need(table, "camera", path), self.path)
        scene = SceneFaces(path.parent / "scene.json", self.length_unit)
        self.faces = {
            name: Face(name, self.corners(name, entry, scene), bool(entry.get("mirror", False)))
            for name, entry in need(table, "faces", path).items()
        }
        self.keep_out = [np.array(polygon, float).reshape(-1, 2) for polygon in table.get("keep_out_px", [])]
        erosion = float(table.get("erode_px", 4))
        self.patches = [patch for entry in need(table, "patches", path) for patch in self.cells(entry, erosion)]

    def corners(self, name, entry, scene):
        """A face's four corners: those of a scene object, in the order of `corners`, or its own quad."""
        if "object" in entry:
            return scene.quad(str(entry["object"]), entry.get("face"), entry.get("corners"), f'{self.path}: face "{name}"')
        quad = np.asarray(need(entry, "quad", self.path), float)
        if quad.shape != (4, 3):
            raise InputError(self.path, f'face "{name}" has no four vertices of three coordinates', "name an object of the scene or give a quad")
        return quad

    def seen_by(self, camera):
        """The same layout seen by another camera; erosion grows with the size of the image."""
        other, scale = copy.copy(self), camera.size[0] / self.camera.size[0]
        other.camera, other.scale = camera, self.scale * scale
        other.keep_out = [scale * polygon for polygon in self.keep_out]
        return other

    def cells(self, entry, erosion):
        """The patches of one entry: one, or the cells of its grid (columns along s, rows along t)."""
        face, shows = need(entry, "face", self.path), entry.get("shows")
        for name in (face, shows):
            if name and name not in self.faces:
                raise InputError(self.path, f'patch "{entry["name"]}" names no face "{name}"', "declare it under faces")
        s0, t0, s1, t1 = entry.get("rect", (0, 0, 1, 1))
        columns, rows = entry.get("grid", (1, 1))
        for row in range(rows):
            for column in range(columns):
                rect = (
                    s0 + (s1 - s0) * column / columns, t0 + (t1 - t0) * row / rows,
                    s0 + (s1 - s0) * (column + 1) / columns, t0 + (t1 - t0) * (row + 1) / rows,
                )
                alone = rows * columns == 1
                name = entry["name"] if alone else f"{entry['name']}_{row + 1}{column + 1}"
                surface = entry.get("surface", face if shows is None else shows or "surroundings")
                yield Patch(name, surface, face, shows, rect, not alone, float(entry.get("erode_px", erosion)))

    def points(self, patch):
        """The patch's four corners in the scene."""
        face, (s0, t0, s1, t1) = self.faces[patch.face], patch.rect
        return np.array([face.at(s0, t0), face.at(s1, t0), face.at(s1, t1), face.at(s0, t1)])

    def outline(self, patch):
        """The patch's projected outline in pixels, before erosion."""
        return self.camera.project(self.points(patch))

    def sees(self, pixels):
        """For pixels (n, 2): the first face of each, and the face seen in it if it is a mirror."""
        directions = self.camera.rays(pixels)
        origins = np.broadcast_to(self.camera.position, directions.shape)
        first, distance = self.nearest(origins, directions)
        second = np.full(len(pixels), "", dtype=object)
        for name, face in self.faces.items():
            chosen = first == name
            if face.mirror and chosen.any():
                points = origins[chosen] + distance[chosen, None] * directions[chosen]
                turned = face.reflect(directions[chosen])
                second[chosen], _ = self.nearest(points + 1e-3 * turned, turned, but=name)
        return first, second

    def nearest(self, origins, directions, but=None):
        """Name of and distance to the nearest face along each ray; "" where there is none."""
        names = [name for name in self.faces if name != but]
        distances = np.array([self.faces[name].distance(origins, directions) for name in names])
        best = distances.argmin(axis=0)
        distance = distances[best, np.arange(distances.shape[1])]
        return np.where(np.isfinite(distance), np.array(names, dtype=object)[best], ""), distance

    def polygon(self, patch):
        """The eroded polygon and the share of its surroundings that shows the right face."""
        size = self.camera.size
        outline = inside_image(self.outline(patch), size, 0)
        polygon = erode(outline, patch.erode_px * self.scale) if len(outline) >= 3 else outline
        if len(polygon) < 3 or mask(polygon, size).sum() < LEAST_PIXELS:
            return polygon, 0.0
        # Eroded less, the patch covers everywhere a badly registered region could lie.
        around = mask(erode(outline, max(patch.erode_px - REGISTRATION_PX, 0) * self.scale), size)
        rows, columns = np.nonzero(around)
        first, second = self.sees(np.stack([columns + 0.5, rows + 0.5], axis=1))
        right = first == patch.face
        if patch.shows is not None:
            right &= second == patch.shows
        for forbidden in self.keep_out:
            right &= ~mask(forbidden, size)[rows, columns]
        return polygon, float(right.mean())


def read_camera(entry, path):
    """The camera of a layout, from the `pose` file beside it, and its unit of length."""
    file = path.parent / need(entry, "pose", path)
    return read_pose(read_json(file, "run fit-pose first"), file)


def read_pose(pose, file):
    """The camera that a pose describes, and its unit of length."""
    unit_name = next((name for name in METERS if f"position_{name}" in pose), None)
    if unit_name is None:
        raise InputError(file, "names no position", "run fit-pose again")
    with meaning(file, "run fit-pose again"):
        camera = Pinhole.looking(
            pose[f"position_{unit_name}"], pose["look"], pose["up"], float(pose["horizontal_fov_deg"]),
            tuple(pose["image_px"]), tuple(pose.get("principal_point_px", (0, 0))), float(pose.get("k1", 0.0)),
        )
    return camera, unit_name
