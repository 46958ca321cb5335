"""A scene as LuxCore holds it: properties by name, and triangles.

Everything is plain data here, so that it can be looked at without the renderer.
Lengths stay in the scene's unit. The camera's window is moved by one row of
pixels, since LuxCore writes the ray of each row into the row above; its rows
begin at the bottom.
"""

from dataclasses import dataclass

import numpy as np

from .peer_luxcore_bands import bands_of, normal_reflectance
from .peer_luxcore_mesh import meshes
from .peer_scene import Diffuse, Glass, Metal

BLACK = [0.0, 0.0, 0.0]


@dataclass(frozen=True)
class Described:
    """Properties of the scene (a value or a list each), and its meshes by the name of their shape."""

    properties: dict
    shapes: dict


def describe(scene, observer):
    """The `Described` of a scene."""
    bands = bands_of(scene, observer)
    properties, shapes = camera(scene.camera), {}
    for index, thing in enumerate(scene.things):
        material, parts = f"material_{index}", meshes(thing.shape, thing.radiance is not None)
        properties |= under(f"scene.materials.{material}", surface(thing.material, bands))
        if isinstance(thing.material, Glass) or thing.radiance is not None or thing.material.two_sided:
            worn = material
        else:
            worn = f"{material}_front"
            properties |= under(f"scene.materials.{material}_back", {"type": "matte", "kd": BLACK})
            properties |= under(f"scene.materials.{worn}", {"type": "twosided", "frontmaterial": material, "backmaterial": f"{material}_back"})
        if thing.radiance is not None:
            # The triangles of a round lamp give the flux of the round surface.
            fuller = thing.shape.area / sum(part.area for part in parts)
            properties |= under(f"scene.materials.{material}", lamp(fuller * bands.radiance(thing.radiance)))
        for number, part in enumerate(parts):
            shapes[f"shape_{index}_{number}"] = part
            properties |= under(f"scene.objects.object_{index}_{number}", {"shape": f"shape_{index}_{number}", "material": worn})
    return Described(properties, shapes)


def under(prefix, values):
    """Properties with their full names."""
    return {f"{prefix}.{name}": value for name, value in values.items()}


def surface(material, bands):
    """Properties of a material; a metal reflects at all angles as it does at normal incidence."""
    if isinstance(material, Glass):
        return {"type": "glass", "kr": [1.0] * 3, "kt": [1.0] * 3, "interiorior": material.index, "exteriorior": 1.0}
    if isinstance(material, Metal):
        reflectance = normal_reflectance(material.n.at(bands.nm), material.k.at(bands.nm))
    else:
        reflectance = material.reflectance.at(bands.nm)
    channels = bands.share(reflectance).tolist()
    return {"type": "matte", "kd": channels} if isinstance(material, Diffuse) else {"type": "mirror", "kr": channels}


def lamp(radiance):
    """What makes a material shine; direct light is sampled however many triangles there are."""
    return {"emission": radiance.tolist(), "emission.directlightsampling.type": "ENABLED"}


def camera(camera):
    """Properties of the camera, whose window is one row of pixels off (see above)."""
    width, height = camera.resolution
    half, row = height / width, 2 / width
    return under("scene.camera", {
        "type": "perspective",
        "lookat.orig": list(camera.position),
        "lookat.target": list(camera.target),
        "up": list(camera.up),
        "fieldofview": camera.fov_x_deg,
        "screenwindow": [-1.0, 1.0, -half - row, half - row],
        "autofocus.enable": 0,
        "cliphither": 1e-6 * float(np.linalg.norm(np.subtract(camera.target, camera.position))),
        "clipyon": 1e30,
    })
