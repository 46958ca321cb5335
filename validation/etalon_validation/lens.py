"""Takes the lens out of a photograph: fall-off towards the corners, and radial distortion.

The render is the radiance of the scene seen by a pinhole. A photograph is
divided by the relative illuminance that the render's record states for its
camera, or by a measured picture of an even field, and then resampled to the
pinhole of its fitted pose. What was done is listed with the photograph.
"""

from dataclasses import replace

import numpy as np
import OpenImageIO as oiio
from scipy import ndimage

from .errors import InputError, meaning
from .photograph import read_photograph
from .polygons import mask

# A flat field is smoothed over this share of its width: its noise is not the lens.
SMOOTHING = 0.01
# Less than this share of the light of the middle is no lens but a lens cap.
LEAST = 0.02


def corrected(photograph, camera, record=None, flat_field=None, render_file=None):
    """The photograph without vignetting and distortion.

    `camera` is that of its pose. `flat_field`, a picture of an even field, goes
    before the model in the render's `record`; `render_file` is the EXR that
    holds that model's picture where it has one.
    """
    if flat_field is not None:
        factors, said = measured_field(flat_field, photograph), f"flat field {flat_field.name}"
    else:
        factors, said = model_field((record or {}).get("camera", {}).get("vignetting"), (record or {}).get("camera", {}), camera, render_file)
    if factors is not None:
        photograph = replace(photograph, rgb=photograph.rgb / factors, corrections=photograph.corrections + (f"divided by {said}",))
    return undistorted(photograph, camera)


def corrected_regions(regions, camera, record, render_file):
    """Regions measured on a photograph that is not at hand, divided by the recorded vignetting; and what was done."""
    factors, said = model_field(record["camera"].get("vignetting"), record["camera"], camera, render_file)
    if factors is None:
        return regions, []
    divided = []
    for region in regions:
        share = float(factors[mask(region.polygon, camera.size)].mean())
        divided.append(replace(region, rgb=region.rgb / share, deviation=region.deviation / share, error=region.error / share))
    return tuple(divided), [f"region means divided by {said}"]


def grid(size):
    """The centres (h * w, 2) of all pixels of an image (width, height)."""
    u, v = np.meshgrid(np.arange(size[0]) + 0.5, np.arange(size[1]) + 0.5)
    return np.stack([u.ravel(), v.ravel()], axis=1)


def model_field(vignetting, facts, camera, render_file):
    """Relative illuminance (h, w, 1) of a recorded model and its name; None where there is no fall-off."""
    with meaning(render_file or "render", "render it again"):
        model = (vignetting or {"model": "none"})["model"]
        if model == "none":
            return None, None
        radius = np.linalg.norm(camera.straightened(grid(camera.size)), axis=1)
        if model == "cos4":
            factors = 1 / (1 + radius**2) ** 2
        elif model == "radial_table":
            at, given = np.array(vignetting["at"], float), np.array(vignetting["relative_illuminance"], float)
            in_mm = vignetting["coordinate"] == "radius_mm"
            factors = np.interp(radius * float(facts["image_distance_mm"]) if in_mm else np.degrees(np.arctan(radius)), at, given)
        elif model == "flat_field":
            factors = channel(render_file, vignetting["channel"], camera.size).ravel()
        else:
            raise InputError(render_file or "render", f'records the unknown vignetting "{model}"', "render it with a version that this harness knows")
    if not (np.isfinite(factors).all() and factors.min() > LEAST):
        raise InputError(render_file or "render", "its vignetting leaves no light in a part of the picture", "correct camera.vignetting of the scene")
    return factors.reshape(camera.size[1], camera.size[0], 1), model


def channel(path, name, size):
    """One channel of an EXR, resampled to `size`."""
    image = oiio.ImageBuf(str(path))
    names = list(image.spec().channelnames) if image.initialized else []
    if name not in names:
        raise InputError(path, f'has no channel "{name}"', "give the EXR that etalon wrote, or a picture with --flat-field")
    values = np.asarray(image.get_pixels(oiio.FLOAT), float)[..., names.index(name)]
    return ndimage.zoom(values, (size[1] / values.shape[0], size[0] / values.shape[1]), order=1, mode="nearest", grid_mode=True)


def measured_field(path, photograph):
    """Relative illuminance (h, w, 3) from a picture of an even field, each channel relative to its middle."""
    field = read_photograph(path)
    if field.size != photograph.size:
        raise InputError(path, f"is {field.size} pixels, the photograph {photograph.size}", "take both with the same camera and crop")
    if field.saturated is not None and field.saturated.any():
        raise InputError(path, f"{int(field.saturated.sum())} of its pixels are saturated", "expose the flat field less")
    width, height = field.size
    smooth = ndimage.gaussian_filter(field.rgb, (SMOOTHING * width, SMOOTHING * width, 0), mode="nearest")
    factors = smooth / np.maximum(smooth[height // 2, width // 2], 1e-12)
    if not (np.isfinite(factors).all() and factors.min() > LEAST):
        raise InputError(path, "is dark in a part of the picture", "photograph an evenly lit white surface")
    return factors


def undistorted(photograph, camera):
    """The photograph resampled to the pinhole of its camera; unchanged without distortion."""
    if camera.k1 == 0:
        return photograph
    straight = camera.undistorted
    source = camera.project(camera.position + straight.rays(grid(camera.size)))
    places = [source[:, 1] - 0.5, source[:, 0] - 0.5]
    shape = photograph.rgb.shape[:2]

    def resampled(values, order):
        return ndimage.map_coordinates(values, places, order=order, mode="nearest").reshape(shape)

    rgb = np.stack([resampled(values, 1) for values in np.moveaxis(photograph.rgb, -1, 0)], axis=-1)
    saturated = None if photograph.saturated is None else resampled(photograph.saturated.astype(float), 1) > 0
    return replace(photograph, rgb=rgb, saturated=saturated, corrections=photograph.corrections + (f"radial distortion k1 {camera.k1:g} undone by resampling",))
