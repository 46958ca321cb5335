"""The variant of a scene that every peer can be given, as a scene file of its own.

What is changed is changed for all renderers alike, Etalon included, and said:
the aperture becomes a pinhole, glass gets one index, rough metal and rough glass
become diffuse (renderers differ in what they take roughness for), fall-off of
the lens and the electronics are left out. A scene that needs none of it is
copied as it stands.
"""

import copy
import json
from pathlib import Path

import numpy as np

from .errors import meaning, read_json
from .peer_spectra import INDEX_NM, Spectra

# Reflectance of what stands in for rough glass, which absorbs nothing and returns most light.
FROSTED_REFLECTANCE = 0.8
CAMERA_KEYS = ("vignetting", "electronics", "noise", "lens_transmission", "sensor", "principal_point_px")


def variant_of(described, spectra, place):
    """The changed content of a scene file, and a sentence for each change."""
    made, said = copy.deepcopy(described), []
    spectra = spectra.of_scene(made)
    for name, material in made.get("materials", {}).items():
        changed, sentence = plain(material, spectra, f'{place}: material "{name}"')
        if sentence:
            made["materials"][name] = changed
            said.append(f"{name}: {sentence}")
    camera = made["camera"]
    if camera.pop("focus_distance", None) is not None:
        said.append("the camera is a pinhole")
    dropped = [key for key in CAMERA_KEYS if camera.pop(key, None) is not None]
    if dropped:
        said.append(f"left out of the camera: {', '.join(dropped)}")
    return made, tuple(said)


def plain(material, spectra, place):
    """A material that every peer has, and what was changed in words; nothing where it was one."""
    (kind, values), *_ = material.items()
    alpha = values.get("roughness_alpha")
    if kind == "conductor" and alpha:
        n, k = spectra.metal(values["metal"], place)
        nm = np.array(n.nm)
        squares = (np.array(n.values) - 1) ** 2 + np.array(k.values) ** 2
        reflectance = squares / (squares + 4 * np.array(n.values))
        table = {"table": {"wavelengths_nm": nm.tolist(), "values": np.round(reflectance, 6).tolist()}}
        return {"lambertian": {"reflectance": table, "two_sided": values.get("two_sided", True)}}, f"rough metal (alpha {alpha:g}) is diffuse with the reflectance of the metal at normal incidence"
    if kind == "dielectric" and alpha:
        return {"lambertian": {"reflectance": FROSTED_REFLECTANCE}}, f"rough glass (alpha {alpha:g}) is diffuse with reflectance {FROSTED_REFLECTANCE:g}"
    if kind == "dielectric" and not isinstance(values["index"], (int, float)):
        index = round(spectra.index(values["index"], place), 6)
        return {"dielectric": values | {"index": index}}, f"glass has the index {index:g} ({INDEX_NM:g} nm) at all wavelengths"
    return material, None


def write_variant(case, spectra_folder, folder):
    """Writes the variant of a case's scene as scene.json into a folder; returns the sentences."""
    place = Path(case) / "scene.json"
    described = read_json(place, "give a case folder with the scene")
    with meaning(place, "correct the scene"):
        made, said = variant_of(described, Spectra(spectra_folder), place)
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scene.json").write_text(json.dumps(made, indent=1) + "\n", encoding="utf-8")
    return said
