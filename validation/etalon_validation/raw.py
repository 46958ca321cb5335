"""Reads camera RAW and DNG files as the sensor counted, through LibRaw.

Nothing that a picture would be made pretty with is applied: no automatic
brightening, white balance 1 1 1, no conversion of the camera's own channels,
no tone curve. The black level is subtracted and the white level becomes 1.
Photosites at the white level, and the pixels interpolated from them, are
marked: their values are lower bounds.
"""

import numpy as np
from scipy import ndimage

from .errors import InputError

ENCODING = "camera RAW, linear, black level subtracted, white level 1, no white balance"
SUFFIXES = (".dng", ".cr2", ".cr3", ".crw", ".nef", ".nrw", ".arw", ".sr2", ".srf", ".raf", ".orf", ".rw2", ".pef", ".srw", ".raw", ".3fr", ".iiq", ".erf", ".x3f")
REMEDY = "give a RAW or DNG file as the camera wrote it"
# Full scale of the 16-bit values that LibRaw delivers.
FULL_SCALE = 65535.0
# A photosite saturates within this share of the white level: white levels are stated to about a percent.
NEAR_WHITE = 0.99
# Demosaicing looks this many pixels around.
NEIGHBOURS = 5
# Quarter turns counter-clockwise for LibRaw's codes of orientation.
TURNS = {0: 0, 3: 2, 5: 1, 6: 3}


def read_raw(path):
    """Linear camera RGB (h, w, 3), the saturated pixels (h, w) and the exposure facts of a RAW file."""
    # Only here: the environment of the peers, which reads renders, is without it.
    import rawpy

    try:
        with rawpy.imread(str(path)) as raw:
            saturated = saturated_pixels(raw)
            rgb = raw.postprocess(
                demosaic_algorithm=rawpy.DemosaicAlgorithm.LINEAR, user_wb=[1.0, 1.0, 1.0, 1.0], use_camera_wb=False, use_auto_wb=False,
                no_auto_bright=True, bright=1.0, adjust_maximum_thr=0.0, highlight_mode=rawpy.HighlightMode.Clip,
                output_color=rawpy.ColorSpace.raw, output_bps=16, gamma=(1, 1),
            )
            facts = exposure_facts(raw)
    except (rawpy.LibRawError, ValueError) as error:
        reason = error.args[0].decode() if error.args and isinstance(error.args[0], bytes) else str(error)
        raise InputError(path, f"cannot be decoded ({reason})", REMEDY) from None
    if rgb.ndim != 3 or rgb.shape[2] != 3 or rgb.shape[:2] != saturated.shape:
        raise InputError(path, f"decodes to {rgb.shape} values, not to three channels", REMEDY)
    return np.asarray(rgb, float) / FULL_SCALE, saturated, facts


def saturated_pixels(raw):
    """Pixels (h, w) whose value rests on a photosite at its white level, turned as the picture is."""
    levels = list(raw.camera_white_level_per_channel or []) or [raw.white_level] * 4
    levels = np.array([level or raw.white_level for level in levels], float)
    black = np.array(raw.black_level_per_channel, float)
    limit = black + NEAR_WHITE * (levels - black)
    counts = raw.raw_image_visible
    if counts.ndim == 3:
        over = (counts[..., :3] >= limit[:3]).any(axis=2)
    else:
        over = ndimage.binary_dilation(counts >= limit[np.minimum(raw.raw_colors_visible, len(limit) - 1)], np.ones((NEIGHBOURS, NEIGHBOURS)))
    return np.rot90(over, TURNS.get(raw.sizes.flip, 0))


def exposure_facts(raw):
    """What the file says about its exposure; facts that it does not state are left out."""
    said = raw.other
    facts = {"iso": said.iso_speed, "shutter_s": said.shutter_speed, "f_stop": said.aperture, "focal_length_mm": said.focal_length}
    return {name: round(float(value), 6) for name, value in facts.items() if value and np.isfinite(value) and value > 0}
