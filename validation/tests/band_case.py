"""A case with narrow bands and known answers: the Cornell box, each face of one level, in a small picture."""

import json
import shutil
from pathlib import Path

import numpy as np

from etalon_validation.band_regions import blocker
from etalon_validation.bands import read_plan
from etalon_validation.layout import Layout
from etalon_validation.registration import scene_camera

from .case import record, write_exr

REFERENCE = Path(__file__).parents[2] / "reference"
NMS = (400, 450, 500, 550, 600, 650, 700)
SIZE = (320, 256)
# Levels of faces; the mirror block shows what it mirrors, at nine tenths.
LEVELS = {"floor": 0.5, "ceiling": 0.4, "back_wall": 0.6, "left_wall": 0.2, "right_wall": 0.3}
OTHER_LEVEL = 0.45
MIRRORED = 0.9


def write_band_case(folder):
    """A case folder like that of the CCD, with the scene of the photograph."""
    plan = json.loads((REFERENCE / "cornell-ccd" / "bands.json").read_text())
    plan["layout"] = str(REFERENCE / "cornell-photo" / "layout.json")
    (folder / "bands.json").write_text(json.dumps(plan))
    shutil.copy(REFERENCE / "cornell-photo" / "scene.json", folder / "scene.json")


def camera_of(folder, size=SIZE):
    """The camera of the case's scene."""
    return scene_camera(json.loads((folder / "scene.json").read_text()), "mm", size)


def picture(folder, camera):
    """What a camera sees of the box when every face has its level; the baffle is black."""
    layout = Layout(REFERENCE / "cornell-photo" / "layout.json")
    scene = json.loads((folder / "scene.json").read_text())
    layout.camera = camera
    layout.faces = layout.faces | {face.name: face for face in blocker(read_plan(folder), scene, "baffle")}
    rows, columns = np.mgrid[0 : camera.size[1], 0 : camera.size[0]]
    first, second = layout.sees(np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1))

    def level(name):
        return 0.0 if not name or name.startswith("baffle") else LEVELS.get(name, OTHER_LEVEL)

    values = [MIRRORED * level(b) if name and name in layout.faces and layout.faces[name].mirror else level(name) for name, b in zip(first, second)]
    return np.array(values).reshape(rows.shape)


def write_band_render(path, image):
    """A render whose bands all show `image`, with a relative standard error of 1 %."""
    xyz = np.repeat(image[..., None], 3, axis=-1)
    names = ["X", "Y", "Z", "stderr.X", "stderr.Y", "stderr.Z"] + [f"sensor.B{nm}" for nm in NMS]
    data = np.concatenate([xyz, 0.01 * xyz, np.repeat(image[..., None], len(NMS), axis=-1)], axis=-1)
    write_exr(path, data, names, [("etalon", json.dumps(record() | {"scene": "cornell-photo"}))])


def write_band_images(folder, image, factors):
    """One EXR per band: `image` times the band's factor."""
    folder.mkdir(exist_ok=True)
    for nm, factor in zip(NMS, factors):
        write_exr(folder / f"{nm}nm.exr", factor * image[..., None], ["Y"])
