"""Scenes whose size can be chosen: a mesh of any number of triangles, a hall of any number of lamps.

All stand in one hall, so that what differs between two points of an axis is
the axis alone. The mesh is a torus with bumps: closed, without degenerate
triangles at any count, and of one shape however fine. Lamps share one area and
one flux however many there are, and so light the hall alike.
"""

import json
import math
from pathlib import Path

import numpy as np

# The hall in metres: width, height, depth.
HALL_M = (10.0, 3.0, 10.0)
# Share of the ceiling's area that lamps take together, and their flux together.
LAMP_SHARE = 0.04
FLUX_LM = 40000.0
# How far below the ceiling lamps hang.
LAMP_DROP_M = 0.05
# The torus: radii, height of its bumps, and where it stands, in metres.
RADIUS_M, TUBE_M, BUMP_M = 1.6, 0.6, 0.08
PLACE_M = (5.0, 1.0, 6.0)
# Bumps around the ring and around the tube.
BUMPS = (24, 10)


def quad(name, corners, material, **more):
    """A flat object."""
    return {"name": name, "shape": {"quad": {"vertices": corners}}, "material": material} | more


def walls():
    """The six sides of the hall, facing inward, and two pillars that cast shadows."""
    w, h, d = HALL_M
    return [
        quad("floor", [[0, 0, 0], [0, 0, d], [w, 0, d], [w, 0, 0]], "floor"),
        quad("ceiling", [[0, h, 0], [w, h, 0], [w, h, d], [0, h, d]], "wall"),
        quad("front", [[0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0]], "wall"),
        quad("back", [[0, 0, d], [0, h, d], [w, h, d], [w, 0, d]], "wall"),
        quad("left", [[0, 0, 0], [0, h, 0], [0, h, d], [0, 0, d]], "red"),
        quad("right", [[w, 0, 0], [w, 0, d], [w, h, d], [w, h, 0]], "blue"),
        *({"name": f"pillar {x:g}", "shape": {"box": {"min": [x, 0, 7.5], "max": [x + 0.5, 2.4, 8]}}, "material": "wall"} for x in (2.0, 7.5)),
    ]


def lamps(count):
    """So many squares below the ceiling, in rows."""
    w, h, d = HALL_M
    columns = math.ceil(math.sqrt(count))
    rows = math.ceil(count / columns)
    half = 0.5 * math.sqrt(LAMP_SHARE * w * d / count)
    emission = {"spectrum": {"blackbody": {"temperature_k": 4000}}, "level": {"flux_lm": FLUX_LM / count}}
    found = []
    for index in range(count):
        x, z = (index % columns + 0.5) * w / columns, (index // columns + 0.5) * d / rows
        y = h - LAMP_DROP_M
        corners = [[x - half, y, z - half], [x + half, y, z - half], [x + half, y, z + half], [x - half, y, z + half]]
        found.append(quad(f"lamp {index}", corners, "lamp", emission=emission))
    return found


def hall(lamp_count=1, mesh=None):
    """The hall as a scene file says it; `mesh` is the name of a PLY file beside it."""
    w, _, _ = HALL_M
    torus = [{"name": "torus", "shape": {"ply": {"file": mesh}}, "material": "torus"}] if mesh else []
    return {
        "name": "hall", "length_unit": "m",
        "materials": {
            "wall": {"lambertian": {"reflectance": "cornell-white"}},
            "floor": {"lambertian": {"reflectance": "colorchecker-neutral-6-5"}},
            "red": {"lambertian": {"reflectance": "colorchecker-moderate-red"}},
            "blue": {"lambertian": {"reflectance": "colorchecker-blue-sky"}},
            "torus": {"lambertian": {"reflectance": "colorchecker-orange"}},
            "lamp": {"lambertian": {"reflectance": 0}},
        },
        "objects": walls() + torus + lamps(lamp_count),
        "camera": {
            "position": [0.5 * w, 1.7, 0.3], "look_at": [0.5 * w, 1.1, 6], "up": [0, 1, 0], "focal_length_mm": 24,
            "sensor_mm": [36, 20.25], "resolution": [160, 90], "f_stop": 8, "shutter_s": 0.02, "iso": 200,
        },
    }


def torus(triangles):
    """Vertices (n, 3) in metres and faces (m, 3) of about so many triangles, counter-clockwise from outside."""
    tube = segments(triangles)
    ring = 2 * tube
    u, v = np.meshgrid(2 * np.pi * np.arange(ring) / ring, 2 * np.pi * np.arange(tube) / tube, indexing="ij")
    radius = TUBE_M + BUMP_M * np.sin(BUMPS[0] * u) * np.sin(BUMPS[1] * v)
    around = RADIUS_M + radius * np.cos(v)
    points = np.stack([around * np.cos(u), radius * np.sin(v), around * np.sin(u)], axis=-1) + PLACE_M
    i, j = np.meshgrid(np.arange(ring), np.arange(tube), indexing="ij")
    a, b = i * tube + j, (i + 1) % ring * tube + j
    c, d = (i + 1) % ring * tube + (j + 1) % tube, i * tube + (j + 1) % tube
    faces = np.stack([np.stack([a, d, c], -1), np.stack([a, c, b], -1)], axis=2)
    return points.reshape(-1, 3), faces.reshape(-1, 3)


def write_ply(path, points, faces):
    """A binary PLY of 12 bytes a vertex and 13 a face."""
    header = (
        "ply\nformat binary_little_endian 1.0\n"
        f"element vertex {len(points)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    packed = np.empty(len(faces), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    packed["count"], packed["corners"] = 3, faces
    with Path(path).open("wb") as file:
        file.write(header.encode("ascii"))
        points.astype("<f4").tofile(file)
        packed.tofile(file)


def segments(triangles):
    """Vertices around the tube of a torus of about so many triangles; there are twice as many around the ring."""
    return max(round(math.sqrt(triangles / 4)), 3)


def triangles_of(asked):
    """How many triangles a torus of about so many has; a hall without one has none."""
    return 4 * segments(asked) ** 2 if asked else 0


def hall_file(folder, lamp_count=1, triangles=0):
    """Where a scene is written to."""
    return Path(folder) / f"hall-{lamp_count}-lamps-{triangles}-triangles.json"


def write_hall(folder, lamp_count=1, triangles=0):
    """Writes a scene and its mesh, whatever is there from an earlier study; the scene's path."""
    folder = Path(folder)
    file = hall_file(folder, lamp_count, triangles)
    mesh = f"torus-{triangles}.ply" if triangles else None
    if mesh:
        write_ply(folder / mesh, *torus(triangles))
    file.write_text(json.dumps(hall(lamp_count, mesh)), encoding="utf-8")
    return file
