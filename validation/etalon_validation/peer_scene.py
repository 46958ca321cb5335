"""An all-diffuse Etalon scene in Mitsuba's terms.

Understood are quads with Lambertian materials, lamps with a tabulated spectrum,
and a pinhole camera. Anything else is refused, never approximated.
"""

import csv
from pathlib import Path

import numpy as np

from .errors import InputError, need

# Luminous efficacy of monochromatic light at 540 THz, lm/W.
EFFICACY = 683.0
FIRST_NM, LAST_NM = 360.0, 830.0
METERS = {"mm": 1e-3, "cm": 1e-2, "m": 1.0}


def read_columns(path):
    """The numbers of a spectral table (n, columns), comments and header left out."""
    path = Path(path)
    try:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        return np.array([[float(cell) for cell in row] for row in csv.reader(lines[1:])])
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "name a table of the spectra folder") from None
    except ValueError as error:
        raise InputError(path, f"not a table of numbers ({error})", "correct it") from None


class Spectra:
    """Spectral tables by name, as the scene file refers to them."""

    def __init__(self, folder):
        self.folder = Path(folder)
        self.observer = read_columns(self.folder / "observer" / "cie-1931-2deg.csv")

    def table(self, spectrum, place):
        """Wavelengths and values of a number, a name, or a written table."""
        if isinstance(spectrum, (int, float)):
            return np.array([FIRST_NM, LAST_NM]), np.full(2, float(spectrum))
        if isinstance(spectrum, dict) and "table" in spectrum:
            return np.array(spectrum["table"]["wavelengths_nm"], float), np.array(spectrum["table"]["values"], float)
        found = sorted(self.folder.glob(f"*/{spectrum}.csv")) if isinstance(spectrum, str) else []
        if not found or found[0].parent.name == "line":
            raise InputError(place, f"spectrum {spectrum!r} is not understood by the peer", "give a number, a table or a name of the spectra folder")
        columns = read_columns(found[0])
        return columns[:, 0], columns[:, 1]

    def reflectance(self, spectrum, place):
        """Mitsuba's description of a reflectance, whose end values go on."""
        nm, values = self.table(spectrum, place)
        return irregular(np.concatenate([[FIRST_NM - 1], nm, [LAST_NM + 1]]), np.concatenate([values[:1], values, values[-1:]]))

    def luminance(self, nm, values):
        """Luminance in cd/m2 of spectral radiance in W sr^-1 m^-2 nm^-1, on the observer's 1 nm grid."""
        grid = self.observer[:, 0]
        return EFFICACY * float(np.trapezoid(np.interp(grid, nm, values, left=0, right=0) * self.observer[:, 2], grid))

    def emission(self, emission, area_m2, place):
        """Mitsuba's description of a lamp's spectral radiance, absolute."""
        nm, values = self.table(need(emission, "spectrum", place), place)
        level = need(emission, "level", place)
        if "spectral_radiance_factor" in level:
            factor = level["spectral_radiance_factor"]
        elif "luminance_cd_m2" in level:
            factor = level["luminance_cd_m2"] / self.luminance(nm, values)
        elif "flux_lm" in level:
            factor = level["flux_lm"] / (np.pi * area_m2) / self.luminance(nm, values)
        else:
            raise InputError(place, f"level {sorted(level)} is not understood by the peer", "give luminance_cd_m2, flux_lm or spectral_radiance_factor")
        if emission.get("two_sided"):
            raise InputError(place, "two-sided lamps are not understood by the peer", "use a one-sided lamp")
        return irregular(nm, values * factor)


def irregular(nm, values):
    """A tabulated spectrum, linear between its samples and zero outside."""
    return {"type": "irregular", "wavelengths": ", ".join(f"{v:.9g}" for v in nm), "values": ", ".join(f"{v:.9g}" for v in values)}


def write_quad(path, vertices):
    """A quad as an ASCII PLY of two triangles, keeping the order of its vertices."""
    corners = "\n".join(" ".join(f"{value:.9g}" for value in vertex) for vertex in vertices)
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n"
    Path(path).write_text(f"{head}{corners}\n3 0 1 2\n3 0 2 3\n")


def shape(entry, materials, spectra, meters, file, place):
    """One object of the scene as a Mitsuba shape."""
    quad = need(entry, "shape", place).get("quad")
    if quad is None or entry.get("transform"):
        raise InputError(place, f'object "{entry.get("name")}" is no plain quad', "the peer compares quads only")
    vertices = np.array(quad["vertices"], float)
    write_quad(file, vertices)
    material = need(materials, need(entry, "material", place), place)
    diffuse = material.get("lambertian")
    if diffuse is None:
        raise InputError(place, f'material "{entry["material"]}" is not Lambertian', "the peer compares diffuse scenes only")
    bsdf = {"type": "diffuse", "reflectance": spectra.reflectance(diffuse["reflectance"], place)}
    if diffuse.get("two_sided", True):
        bsdf = {"type": "twosided", "nested": bsdf}
    made = {"type": "ply", "filename": str(file), "face_normals": True, "bsdf": bsdf}
    if entry.get("emission"):
        sides = np.cross(vertices[1:3] - vertices[0], vertices[2:4] - vertices[0])
        area = 0.5 * np.linalg.norm(sides, axis=1).sum() * meters**2
        made["emitter"] = {"type": "area", "radiance": spectra.emission(entry["emission"], area, place)}
    return made


def mitsuba_scene(mi, scene, spectra, folder, place):
    """The dictionary that Mitsuba loads; quads are written to `folder`."""
    camera = need(scene, "camera", place)
    if any(camera.get("principal_point_px", (0, 0))) or camera.get("focus_distance"):
        raise InputError(place, "the peer's camera is a centred pinhole", "leave out principal_point_px and focus_distance")
    if scene.get("lights"):
        raise InputError(place, "lights without a surface are not understood by the peer", "use lamps with a surface")
    width, height = camera["resolution"]
    target = camera.get("look_at") or (np.array(camera["position"]) + np.array(camera["direction"])).tolist()
    fov = 2 * np.degrees(np.arctan(camera["sensor_mm"][0] / 2 / camera["focal_length_mm"]))
    made = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1, "rr_depth": 20},
        "sensor": {
            "type": "perspective", "fov": float(fov), "fov_axis": "x", "near_clip": 1e-3, "far_clip": 1e6,
            "to_world": mi.ScalarTransform4f().look_at(origin=camera["position"], target=target, up=camera["up"]),
            "film": {
                "type": "hdrfilm", "width": width, "height": height, "pixel_format": "xyz",
                "component_format": "float32", "rfilter": {"type": "box"},
            },
            "sampler": {"type": "independent"},
        },
    }
    for index, entry in enumerate(need(scene, "objects", place)):
        made[f"object_{index}"] = shape(entry, scene.get("materials", {}), spectra, METERS[scene["length_unit"]], Path(folder) / f"{index}.ply", place)
    return made
