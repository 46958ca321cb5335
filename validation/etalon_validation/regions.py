"""The region table: polygons on a photograph and the linear values measured in them.

The table (`regions.json`) holds numbers only and stands in for the photograph
wherever the photograph itself may not be passed on.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from .errors import InputError, meaning, need, read_json
from .polygons import mask

# Neighbouring pixels share demosaicing, compression and blur: 3 x 3 of them count as one.
CORRELATED_PIXELS = 9
# Below this mean linear value a photograph shows its black level and not the scene.
NOISE_FLOOR = 0.01
# With a larger share of saturated pixels left out, what remains is the darker part of a region that the render has whole.
MOST_SATURATED = 0.01
SPACES = ("linear_srgb", "camera_rgb")


@dataclass(frozen=True)
class Region:
    """A polygon, the surface it shows, and the photograph's mean linear RGB with its spread."""

    name: str
    surface: str
    polygon: np.ndarray
    pixels: int
    rgb: np.ndarray
    deviation: np.ndarray
    error: np.ndarray
    # Saturated pixels of the polygon, left out of the mean.
    saturated: int = 0
    # The polygon in the pixels of a render, through the render's own camera; None scales `polygon`.
    in_render: np.ndarray | None = None

    @property
    def dark(self):
        """Whether the photograph has no signal here."""
        return float(self.rgb.mean()) < NOISE_FLOOR

    @property
    def flag(self):
        """Why the region cannot be fitted or counted, or None."""
        if self.dark:
            return "photograph at its black level"
        share = self.saturated / max(self.saturated + self.pixels, 1)
        return f"photograph saturated in {100 * share:.0f} % of it" if share > MOST_SATURATED else None


@dataclass(frozen=True)
class RegionTable:
    """All regions of one photograph, and which photograph that is."""

    photo: dict
    space: str
    provenance: str
    regions: tuple
    path: Path

    @property
    def size(self):
        """(width, height) of the photograph in pixels."""
        return int(self.photo["width"]), int(self.photo["height"])


def measure(photograph, name, surface, polygon):
    """The region that a polygon cuts out of a photograph, without its saturated pixels."""
    within = mask(polygon, photograph.size)
    covered = int(within.sum())
    if photograph.saturated is not None:
        within &= ~photograph.saturated
    values = photograph.rgb[within]
    if len(values) < 2:
        what = f"covers {covered} pixels" if covered < 2 else f"is saturated in {covered - len(values)} of {covered} pixels"
        raise InputError(photograph.file, f'region "{name}" {what}', "correct its polygon, or expose less")
    deviation = values.std(axis=0, ddof=1)
    error = deviation * np.sqrt(min(1.0, CORRELATED_PIXELS / len(values)))
    return Region(name, surface, np.asarray(polygon, float), len(values), values.mean(axis=0), deviation, error, covered - len(values))


def measure_layout(layout, photograph, report=print):
    """Measures every patch of a layout; grid cells that do not show their face are dropped and named."""
    if photograph.size != layout.camera.size:
        raise InputError(photograph.file, f"is {photograph.size} pixels, the camera has {layout.camera.size}", "give the photograph that the pose was fitted on")
    regions = []
    for patch in layout.patches:
        polygon, share = layout.polygon(patch)
        if share == 1.0:
            regions.append(measure(photograph, patch.name, patch.surface, np.round(polygon, 2)))
        elif patch.may_drop:
            report(f"{patch.name}: dropped, {100 * share:.0f} % of it shows {patch.surface}")
        else:
            raise InputError(layout.path, f'patch "{patch.name}" shows {patch.surface} in {100 * share:.0f} % of its pixels', "move or shrink it")
    return regions


def remeasure(table, photograph):
    """The same polygons measured on another file of the same size."""
    if photograph.size != table.size:
        raise InputError(photograph.file, f"is {photograph.size} pixels, the region table was measured at {table.size}", "give a photograph of that size")
    return tuple(measure(photograph, region.name, region.surface, region.polygon) for region in table.regions)


def through_the_render(regions, layout, camera):
    """The regions with their polygons in a render also seen through the render's own `camera`.

    A camera that stands a pixel beside that of the photograph then shows the same patch of the same face. Regions
    that are no patch of the layout, or that the render's camera does not show, keep their scaled polygon.
    """
    seen = layout.seen_by(camera)
    patches = {patch.name: patch for patch in layout.patches}
    placed = []
    for region in regions:
        polygon = seen.polygon(patches[region.name])[0] if region.name in patches else []
        placed.append(replace(region, in_render=np.round(polygon, 2)) if len(polygon) >= 3 else region)
    return tuple(placed)


def write_table(path, layout, photograph, regions):
    """Writes regions.json, one region a line so that a change can be read."""
    def numbers(values, digits=6):
        return [round(float(value), digits) for value in values]

    head = {
        "photo": {
            "file": photograph.file, "sha256": photograph.sha256,
            "width": photograph.size[0], "height": photograph.size[1], "encoding": photograph.encoding,
        },
        "photo_space": layout.photo.get("space", "linear_srgb"),
        "provenance": layout.photo.get("provenance", ""),
        "made_by": "python -m etalon_validation measure-regions",
        "about": "polygon: pixels from the top left corner, first pixel centre (0.5, 0.5); mean_rgb, deviation_rgb, standard_error_rgb: linear",
    }
    lines = [json.dumps({
        "name": region.name, "surface": region.surface, "pixels": region.pixels,
        "mean_rgb": numbers(region.rgb), "deviation_rgb": numbers(region.deviation),
        "standard_error_rgb": numbers(region.error), "polygon": [numbers(point, 2) for point in region.polygon],
    } | ({"saturated_pixels": region.saturated} if region.saturated else {})) for region in regions]
    text = json.dumps(head, indent=2)[:-2] + ',\n  "regions": [\n    ' + ",\n    ".join(lines) + "\n  ]\n}\n"
    Path(path).write_text(text, encoding="utf-8")


def read_region(entry, path):
    """One region of the table."""
    with meaning(path, "run measure-regions again"):
        name = entry["name"]
    with meaning(f'{path}: region "{name}"', "run measure-regions again"):
        numbers = [np.array(entry[key], float).reshape(3) for key in ("mean_rgb", "deviation_rgb", "standard_error_rgb")]
        polygon = np.array(entry["polygon"], float).reshape(-1, 2)
        if not all(np.isfinite(values).all() for values in (polygon, *numbers)):
            raise ValueError("not finite")
        return Region(str(name), str(entry["surface"]), polygon, int(entry["pixels"]), *numbers, int(entry.get("saturated_pixels", 0)))


def read_table(path):
    """The region table in `path`."""
    path = Path(path)
    table = read_json(path, "run measure-regions on the photograph first")
    with meaning(path, "run measure-regions again"):
        photo = {key: str(table["photo"][key]) for key in ("file", "sha256", "encoding")}
        photo |= {key: int(table["photo"][key]) for key in ("width", "height")}
        entries = list(table["regions"])
    space = table.get("photo_space", "linear_srgb")
    if space not in SPACES:
        raise InputError(path, f'unknown photo_space "{space}"', "write " + " or ".join(SPACES))
    if not entries or min(photo["width"], photo["height"]) < 1:
        raise InputError(path, "holds no regions or no size", "run measure-regions again")
    return RegionTable(photo, space, str(table.get("provenance", "")), tuple(read_region(entry, path) for entry in entries), path)
