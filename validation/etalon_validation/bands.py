"""Reads narrow-band photographs: a folder or an archive with one EXR per band.

The files are called by their band's wavelength, as in 400nm.exr, and hold one
channel. What cannot be known of them is said: whether the archive is the
published one, and whether the camera's response came with it.
"""

import re
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from .errors import InputError, meaning, read_json
from .photograph import first_line, sha256_of

REMEDY = "give the folder of 400nm.exr to 700nm.exr, or box_exr.zip, from the page Cornell Box Comparison, www.graphics.cornell.edu"
BAND_FILE = re.compile(r"(\d{3,4})nm\.exr", re.IGNORECASE)
# A band of the published archive has 5 MB; what is larger than this is no band.
MOST_BYTES = 256 << 20


@dataclass(frozen=True)
class Band:
    """A band of the camera: its nominal wavelength, and whether it counts in fits and overall figures."""

    nm: int
    counted: bool
    why: str

    @property
    def channel(self):
        """The render's channel of this band."""
        return f"sensor.B{self.nm}"


@dataclass(frozen=True)
class Plan:
    """What `bands.json` of a case says."""

    bands: tuple
    table: dict
    path: Path


@dataclass(frozen=True)
class BandImages:
    """Linear values (bands, height, width) in units of their own, and the identity of their files."""

    values: np.ndarray
    file: str
    sha256: str | None
    hashes: dict
    archive: str
    response: str

    @property
    def size(self):
        """(width, height) in pixels."""
        return self.values.shape[2], self.values.shape[1]


def read_plan(case):
    """The `bands.json` of a case."""
    path = Path(case) / "bands.json"
    table = read_json(path, "a case that is scored band by band needs it")
    with meaning(path, "correct it"):
        bands = tuple(Band(int(entry["nm"]), bool(entry["counted"]), str(entry.get("why", ""))) for entry in table["bands"])
        for key in ("archive_sha256", "response_file", "response_sha256", "layout", "length_unit", "level", "blockers"):
            table[key]
    if not any(band.counted for band in bands):
        raise InputError(path, "no band counts", "mark the usable bands as counted")
    return Plan(bands, table, path)


def read_bands(place, plan):
    """The images of all bands of a plan, from a folder or a zip archive."""
    place = Path(place)
    if place.is_dir():
        return collect(place, place, plan, None)
    if not place.is_file():
        raise InputError(place, "no such folder or archive", REMEDY)
    with tempfile.TemporaryDirectory() as holder:
        unpack(place, Path(holder), plan)
        return collect(place, Path(holder), plan, sha256_of(place))


def unpack(archive, folder, plan):
    """Writes the bands, and the response if it is there, from an archive into a folder, whatever folders they lie in."""
    try:
        with zipfile.ZipFile(archive) as content:
            for member in content.infolist():
                name = member.filename.replace("\\", "/").rsplit("/", 1)[-1]
                if not (BAND_FILE.fullmatch(name) or name == plan.table["response_file"]):
                    continue
                if member.file_size > MOST_BYTES:
                    raise InputError(f"{archive}: {member.filename}", f"has {member.file_size >> 20} MB", REMEDY)
                (folder / name).write_bytes(content.read(member))
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
        raise InputError(archive, f"is no zip archive that can be read ({error})", REMEDY) from None


def collect(place, folder, plan, archive_hash):
    """Reads every band of the plan below a folder."""
    files = {int(match[1]): path for path in sorted(folder.rglob("*")) if (match := BAND_FILE.fullmatch(path.name))}
    missing = [f"{band.nm}nm.exr" for band in plan.bands if band.nm not in files]
    if missing:
        raise InputError(place, f"holds no {', '.join(missing)}", REMEDY)
    images = [read_channel(files[band.nm], f"{place}: {files[band.nm].name}") for band in plan.bands]
    if len({image.shape for image in images}) > 1:
        sizes = ", ".join(sorted({f"{image.shape[1]}x{image.shape[0]}" for image in images}))
        raise InputError(place, f"its bands differ in size ({sizes})", "give the bands of one camera")
    response = next(iter(sorted(folder.rglob(plan.table["response_file"]))), None)
    return BandImages(
        np.stack(images), place.name, archive_hash, {f"{band.nm}": sha256_of(files[band.nm]) for band in plan.bands},
        known(archive_hash, plan.table["archive_sha256"], "a folder: the published checksum is that of the archive"),
        known(response and sha256_of(response), plan.table["response_sha256"], "not given"),
    )


def known(found, published, otherwise):
    """Whether a file is the published one, in words."""
    if found is None:
        return otherwise
    return "known: SHA-256 as published" if found == published else "unknown: SHA-256 differs from the published one"


def read_channel(path, place):
    """The only channel of an EXR, or its Y."""
    image = oiio.ImageInput.open(str(path))
    if image is None:
        raise InputError(place, f"cannot be decoded ({first_line(oiio.geterror())})", REMEDY)
    spec = image.spec()
    names = list(spec.channelnames)
    pixels = image.read_image(0, spec.nchannels, "float")
    image.close()
    if pixels is None:
        raise InputError(place, "is cut short or damaged", "get the file again")
    if len(names) > 1 and "Y" not in names:
        raise InputError(place, f"has the channels {', '.join(names)}", "give one channel Y per band")
    values = np.asarray(pixels, float).reshape(spec.height, spec.width, spec.nchannels)
    values = values[..., names.index("Y") if "Y" in names else 0]
    if not np.isfinite(values).all():
        raise InputError(place, "holds values that are not finite", "get the file again")
    return values
