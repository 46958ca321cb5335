"""A scene as every peer can be told it: shapes, materials and lamps in plain tables.

It is read from a scene file once, by one function, so that all renderers are
given the same scene and what they make of it is all that differs. What no peer
understands is refused, never approximated; `peer_variant.py` says what is
changed before, in the open. Everything is plain data: `dataclasses.asdict` gives
what JSON can hold. Lengths are in the scene's unit.
"""

from dataclasses import dataclass

import numpy as np

from .errors import InputError, meaning, need, read_json
from .peer_shapes import Cylinder, Disk, Faces, Sphere, shape_of
from .peer_spectra import EFFICACY, FIRST_NM, LAST_NM, Spectra, Table

__all__ = ["EFFICACY", "FIRST_NM", "LAST_NM", "Camera", "Cylinder", "Diffuse", "Disk", "Faces", "Glass", "Metal", "Mirror", "Scene", "Spectra", "Sphere", "Table", "Thing", "read_scene", "scene_of"]

METERS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


@dataclass(frozen=True)
class Diffuse:
    """Lambertian; black from behind unless it has two sides."""

    reflectance: Table
    two_sided: bool


@dataclass(frozen=True)
class Mirror:
    """The same reflectance at every angle; black from behind unless it has two sides."""

    reflectance: Table
    two_sided: bool


@dataclass(frozen=True)
class Metal:
    """A smooth conductor of index n - ik; black from behind unless it has two sides."""

    n: Table
    k: Table
    two_sided: bool


@dataclass(frozen=True)
class Glass:
    """A smooth dielectric without dispersion and absorption, in vacuum."""

    index: float


@dataclass(frozen=True)
class Thing:
    """A surface. `radiance` in W sr^-1 m^-2 nm^-1 leaves its front evenly in all directions; `None`: no lamp."""

    name: str
    shape: Faces | Sphere | Cylinder | Disk
    material: Diffuse | Mirror | Metal | Glass
    radiance: Table | None = None


@dataclass(frozen=True)
class Camera:
    """A pinhole with square pixels. The picture's right is (target - position) x up; `resolution` is width, height."""

    position: tuple
    target: tuple
    up: tuple
    fov_x_deg: float
    resolution: tuple


@dataclass(frozen=True)
class Scene:
    """All that is rendered."""

    name: str
    meters_per_unit: float
    things: tuple
    camera: Camera

    @property
    def is_diffuse(self):
        """Whether light meets no mirror, metal or glass."""
        return all(isinstance(thing.material, Diffuse) for thing in self.things)


def read_scene(path, spectra, resolution=None):
    """The `Scene` of a scene file; `resolution` (width, height) goes before that of the file."""
    described = read_json(path, "give a case folder with the scene")
    with meaning(path, "correct the scene"):
        return scene_of(described, spectra, path, resolution)


def scene_of(described, spectra, place, resolution=None):
    """The `Scene` of a scene file's content."""
    if described.get("lights"):
        raise InputError(place, "lights without a surface are not understood by the peers", "use lamps with a surface")
    spectra = spectra.of_scene(described)
    meters = METERS[need(described, "length_unit", place)]
    things = tuple(thing_of(entry, described.get("materials", {}), spectra, meters, place) for entry in need(described, "objects", place))
    return Scene(described.get("name", ""), meters, things, camera_of(need(described, "camera", place), place, resolution))


def thing_of(entry, materials, spectra, meters, place):
    """One object."""
    shape = shape_of(need(entry, "shape", place), entry.get("transform") or (), f'{place}: object "{entry.get("name")}"')
    name = need(entry, "material", place)
    material = material_of(need(materials, name, place), spectra, f'{place}: material "{name}"')
    emission = entry.get("emission")
    radiance = spectra.radiance(emission, shape.area * meters**2, place) if emission else None
    return Thing(entry.get("name", ""), shape, material, radiance)


def material_of(described, spectra, place):
    """A material of those that every peer has."""
    (kind, values), *more = described.items()
    if not more and kind in ("lambertian", "mirror"):
        made = Diffuse if kind == "lambertian" else Mirror
        return made(spectra.table(need(values, "reflectance", place), place), values.get("two_sided", True))
    if not more and not values.get("roughness_alpha"):
        if kind == "conductor":
            return Metal(*spectra.metal(need(values, "metal", place), place), values.get("two_sided", True))
        if kind == "dielectric" and not values.get("outside_index") and not values.get("absorption_per_m"):
            return Glass(spectra.index(need(values, "index", place), place))
    raise InputError(place, "is none that every peer has", "use lambertian, mirror, or a smooth conductor or dielectric in vacuum without absorption")


def camera_of(camera, place, resolution):
    """The pinhole."""
    if any(camera.get("principal_point_px", (0, 0))) or camera.get("focus_distance"):
        raise InputError(place, "the peer's camera is a centred pinhole", "leave out principal_point_px and focus_distance")
    position = tuple(map(float, need(camera, "position", place)))
    target = camera.get("look_at") or (np.array(position) + np.array(need(camera, "direction", place))).tolist()
    width, height = resolution or need(camera, "resolution", place)
    across, down = camera["sensor_mm"]
    # A pixel may be off square by the rounding of a stated sensor, not by more.
    if abs(across * height / (down * width) - 1) > 0.01:
        raise InputError(place, f"has a sensor of {across:g} x {down:g} mm, which {width}x{height} pixels do not fill with squares", "give a resolution of the sensor's shape")
    fov = 2 * np.degrees(np.arctan(across / 2 / camera["focal_length_mm"]))
    return Camera(position, tuple(map(float, target)), tuple(map(float, camera["up"])), float(fov), (int(width), int(height)))
