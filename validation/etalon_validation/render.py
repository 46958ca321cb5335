"""Reads a render: absolute XYZ, its standard error, and the record of how it was made."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from .errors import InputError, need, read_json
from .photograph import first_line, sha256_of

REMEDY = "give an EXR written by etalon"


@dataclass(frozen=True)
class Render:
    """XYZ with Y in cd/m2, standard errors on the same scale, and the `etalon` attribute."""

    xyz: np.ndarray
    stderr: np.ndarray
    sensor: np.ndarray | None
    record: dict
    file: str
    sha256: str

    @property
    def size(self):
        """(width, height) in pixels."""
        return self.xyz.shape[1], self.xyz.shape[0]

    @property
    def saturation(self):
        """The luminance that the camera records as 1, cd/m2."""
        return float(self.record["camera"]["saturation_luminance_cd_m2"])


def read_pixels(path, remedy=REMEDY):
    """The header of an EXR, its channel names, and its values (height, width, channels); an `InputError` ends with `remedy`."""
    path = Path(path)
    if not path.is_file():
        raise InputError(path, "no such render" if remedy is REMEDY else "no such picture", remedy)
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise InputError(path, f"cannot be decoded ({first_line(oiio.geterror())})", remedy)
    spec = image.spec()
    pixels = image.read_image(0, spec.nchannels, "float")
    image.close()
    if pixels is None:
        raise InputError(path, "is cut short", "render it again")
    return spec, list(spec.channelnames), np.asarray(pixels, float).reshape(spec.height, spec.width, spec.nchannels)


def read_channels(path, wanted):
    """Channels by name (channels, height, width); an `InputError` names those that are not there."""
    _, names, pixels = read_pixels(path)
    missing = [name for name in wanted if name not in names]
    if missing:
        raise InputError(path, f"has no channel {', '.join(missing)}", "give the scene's camera a sensor with these bands")
    found = np.stack([pixels[..., names.index(name)] for name in wanted])
    if not np.isfinite(found).all():
        raise InputError(path, "holds values that are not finite", "render it again")
    return found


def read_render(path):
    """The render in `path`; an `InputError` when channels or record are not those of a render."""
    path = Path(path)
    spec, names, pixels = read_pixels(path)

    def take(wanted):
        missing = [name for name in wanted if name not in names]
        if missing:
            raise InputError(path, f"has no channel {', '.join(missing)}", REMEDY)
        return pixels[..., [names.index(name) for name in wanted]]

    xyz, stderr = take("XYZ"), take(["stderr.X", "stderr.Y", "stderr.Z"])
    sensor = take(["sensor.R", "sensor.G", "sensor.B"]) if "sensor.G" in names else None
    for values in (xyz, stderr) if sensor is None else (xyz, stderr, sensor):
        if not np.isfinite(values).all():
            raise InputError(path, "holds values that are not finite", "render it again, with two samples per pixel or more: one has no standard error")
    return Render(xyz, stderr, sensor, read_record(spec, path), path.name, sha256_of(path))


def check_scene(render, case):
    """Refuses a render of another scene than that of the case folder, where both say which."""
    file = Path(case) / "scene.json"
    if not file.is_file():
        return
    expected, found = read_json(file, "correct it").get("name"), render.record.get("scene")
    if expected is not None and found is not None and expected != found:
        raise InputError(render.file, f'is a render of the scene "{found}", the case has "{expected}"', f"render {file}")


def read_record(spec, path):
    """The JSON in the `etalon` attribute, checked for what scoring needs."""
    text = spec.getattribute("etalon")
    if not isinstance(text, str):
        raise InputError(path, 'has no "etalon" attribute', REMEDY)
    try:
        record = json.loads(text)
    except json.JSONDecodeError as error:
        raise InputError(path, f'its "etalon" attribute is not JSON ({error.msg})', REMEDY) from None
    camera = need(record, "camera", path)
    saturation = need(camera, "saturation_luminance_cd_m2", path)
    if not isinstance(record.get("plan", []), list):
        raise InputError(path, "its plan is no list", REMEDY)
    for key in ("seconds", "cpu_seconds"):
        if not isinstance(record.get(key), (int, float, type(None))):
            raise InputError(path, f"its {key} is no number", REMEDY)
    if not isinstance(saturation, (int, float)) or not saturation > 0:
        raise InputError(path, "camera.saturation_luminance_cd_m2 is not positive", "give the scene's camera an exposure")
    return record
