"""A scene in Mitsuba's terms: the dictionary that it loads.

Spectra on an even grid become `regular` tables, which Mitsuba reads faster than
`irregular` ones: a peer is given what suits it. Reflectances and indices are
carried on to 360 and 830 nm, outside of which Mitsuba takes no wavelength.
"""

from pathlib import Path

import numpy as np

from .errors import InputError
from .peer_scene import FIRST_NM, LAST_NM, Cylinder, Diffuse, Disk, Faces, Glass, Metal, Mirror, Sphere

PATH, LIGHT = "path", "ptracer"


def mitsuba_scene(mi, scene, folder, integrator=PATH):
    """The dictionary of a `Scene`; meshes are written to `folder`."""
    camera = scene.camera
    width, height = camera.resolution
    made = {
        "type": "scene",
        "integrator": {"type": integrator, "max_depth": -1},
        "sensor": {
            "type": "perspective", "fov": camera.fov_x_deg, "fov_axis": "x", "near_clip": 1e-3, "far_clip": 1e6,
            "to_world": mi.ScalarTransform4f().look_at(origin=list(camera.position), target=list(camera.target), up=list(camera.up)),
            "film": {
                "type": "hdrfilm", "width": width, "height": height, "pixel_format": "xyz",
                "component_format": "float32", "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        },
    }
    for index, thing in enumerate(scene.things):
        for part, shape in enumerate(shapes(mi, thing.shape, Path(folder) / f"{index}.ply")):
            made[f"object_{index}_{part}"] = shape | {"bsdf": bsdf(thing.material)} | lamp(thing.radiance)
    return made


def shapes(mi, shape, file):
    """Mitsuba's shapes of one of ours."""
    if isinstance(shape, Faces):
        write_ply(file, shape)
        return [{"type": "ply", "filename": str(file), "face_normals": True}]
    if isinstance(shape, Sphere):
        return [{"type": "sphere", "center": list(shape.center), "radius": shape.radius}]
    if isinstance(shape, Cylinder):
        axis = np.subtract(shape.end, shape.start)
        axis /= np.linalg.norm(axis)
        side = {"type": "cylinder", "p0": list(shape.start), "p1": list(shape.end), "radius": shape.radius}
        ends = (Disk(shape.start, tuple(-axis), shape.radius), Disk(shape.end, tuple(axis), shape.radius))
        return [side, *(disk(mi, end) for end in ends)]
    return [disk(mi, shape)]


def disk(mi, shape):
    """Mitsuba's unit disk, which faces z, brought to its place."""
    normal = np.array(shape.normal, float)
    first = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    first /= np.linalg.norm(first)
    matrix = np.eye(4)
    matrix[:3, :3] = np.column_stack([shape.radius * first, shape.radius * np.cross(normal, first), normal])
    matrix[:3, 3] = shape.center
    return {"type": "disk", "to_world": mi.ScalarTransform4f(matrix)}


def bsdf(material):
    """Mitsuba's material."""
    if isinstance(material, Glass):
        return {"type": "dielectric", "int_ior": material.index, "ext_ior": 1.0}
    if isinstance(material, Diffuse):
        made = {"type": "diffuse", "reflectance": spectrum(material.reflectance)}
    elif isinstance(material, Mirror):
        made = {"type": "conductor", "material": "none", "specular_reflectance": spectrum(material.reflectance)}
    elif isinstance(material, Metal):
        made = {"type": "conductor", "eta": spectrum(material.n), "k": spectrum(material.k)}
    else:
        raise InputError("mitsuba", f"has no material {type(material).__name__}", "leave it out")
    return {"type": "twosided", "nested": made} if material.two_sided else made


def lamp(radiance):
    """What makes a shape shine."""
    return {} if radiance is None else {"emitter": {"type": "area", "radiance": spectrum(radiance)}}


def spectrum(table):
    """A table as Mitsuba's tabulated spectrum, linear between samples and zero outside."""
    if table.holds and len(set(table.values)) == 1:
        # A table of nothing but zeros is refused.
        return {"type": "uniform", "value": table.values[0]}
    nm, values = np.array(table.nm), np.array(table.values)
    step = nm[1] - nm[0] if len(nm) > 1 else 0.0
    is_even = len(nm) > 2 and np.allclose(np.diff(nm), step, rtol=1e-6)
    if table.holds:
        before, after = (np.ceil(max(gap, 0.0) / step) if is_even else float(gap > 0) for gap in (nm[0] - FIRST_NM, LAST_NM - nm[-1]))
        values = np.concatenate([np.full(int(before), values[0]), values, np.full(int(after), values[-1])])
        if is_even:
            nm = nm[0] + step * np.arange(-before, len(nm) + after)
        else:
            nm = np.concatenate([[FIRST_NM] * int(before), nm, [LAST_NM] * int(after)])
    words = ", ".join(f"{value:.9g}" for value in values)
    if is_even:
        return {"type": "regular", "wavelength_min": float(nm[0]), "wavelength_max": float(nm[-1]), "values": words}
    return {"type": "irregular", "wavelengths": ", ".join(f"{value:.9g}" for value in nm), "values": words}


def write_ply(path, shape):
    """Faces as an ASCII PLY of triangles, keeping the order of corners."""
    corners = "\n".join(" ".join(f"{value:.9g}" for value in vertex) for vertex in shape.vertices)
    triangles = "\n".join("3 {} {} {}".format(*triangle) for triangle in shape.triangles)
    head = f"ply\nformat ascii 1.0\nelement vertex {len(shape.vertices)}\nproperty float x\nproperty float y\nproperty float z\nelement face {len(shape.triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    Path(path).write_text(f"{head}{corners}\n{triangles}\n", encoding="utf-8")
