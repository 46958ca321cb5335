"""Synthetic comparisons whose truth is known: pixels with noise of a stated size, or region means outright."""

from pathlib import Path

import numpy as np
from scipy.stats import binom

from etalon_validation.calibration import Calibration, Component
from etalon_validation.compare import Comparison, compare
from etalon_validation.difference import SRGB_TO_XYZ
from etalon_validation.ladder import Setting
from etalon_validation.photograph import Photograph
from etalon_validation.regions import RegionTable, measure
from etalon_validation.render import Render

from .case import COLOURS, SURFACES

# A statistical test fails by chance with this probability.
FALSE_ALARM = 1e-3
# Regions of 9 x 9 pixels, in which 3 x 3 blocks share their noise as neighbouring pixels of photographs do.
BLOCK, BLOCKS = 3, 3
REGION = BLOCK * BLOCKS
BRIGHT = COLOURS[:8]
SURFACES_OF = np.array(SURFACES[:8])


def acceptance(trials, share=0.95):
    """Smallest and largest count of successes among `trials` that chance leaves, with `FALSE_ALARM` in both tails together."""
    return binom.ppf(FALSE_ALARM / 2, trials, share), binom.isf(FALSE_ALARM / 2, trials, share)


def side_by_side(colours):
    """One square of `REGION` pixels per colour."""
    return np.repeat(np.repeat(colours[None], REGION, axis=0), REGION, axis=1)


def blocks(generator, count):
    """Standard normal noise of three channels for `count` squares, constant over blocks of `BLOCK` pixels."""
    small = generator.standard_normal((BLOCKS, count * BLOCKS, 3))
    return np.repeat(np.repeat(small, BLOCK, axis=0), BLOCK, axis=1)


def pixels(generator, factor=1.0, render_noise=0.0, photo_noise=0.0, glare=0.0):
    """A comparison of pictures: photograph = factor (render, veiled by a share `glare`), relative noise per pixel on
    both sides. The render's noise is the same in all channels, the photograph's shared by 3 x 3 pixels."""
    truth = side_by_side(BRIGHT)
    veiled = (1 - glare) * truth + glare * truth.mean(axis=(0, 1))
    photo = factor * veiled * (1 + photo_noise * blocks(generator, len(BRIGHT)))
    xyz = truth @ SRGB_TO_XYZ.T
    noisy = xyz * (1 + render_noise * generator.standard_normal(xyz.shape[:2])[..., None])
    photograph = Photograph(photo, "photo.exr", "0", "linear")
    squares = [np.array([[0, 0], [REGION, 0], [REGION, REGION], [0, REGION]], float) + [REGION * i, 0] for i in range(len(BRIGHT))]
    regions = tuple(measure(photograph, f"patch_{i}", surface, square) for i, (surface, square) in enumerate(zip(SURFACES_OF, squares)))
    table = RegionTable({"width": photo.shape[1], "height": photo.shape[0]}, "linear_srgb", "", regions, Path("regions.json"))
    render = Render(noisy, render_noise * xyz, None, {"camera": {"saturation_luminance_cd_m2": 1.0}}, "out.exr", "0")
    return compare(table, regions, render)


def region_means(render, photo, radius2=None):
    """A comparison of region means without any noise."""
    count = len(render)
    return Comparison(
        render=render, photo=photo, to_xyz=SRGB_TO_XYZ, render_covariance=np.zeros((count, 3, 3)), photo_error=np.zeros((count, 3)),
        pixels=np.full(count, 81), channels=render[None], mean_picture=BRIGHT.mean(axis=0), noise=np.zeros(count),
        photo_pixels=np.full(count, 81), quantisation=np.zeros((count, 3)), shift=np.zeros((count, 2, 3)),
        radius2=np.zeros(count) if radius2 is None else radius2,
    )


def setting_of(both):
    """The fit's setting when every region may be fitted."""
    return Setting.of(both.render, both.photo, both.luminance, SURFACES_OF, np.ones(len(both.render), bool), both.mean_picture)


def calibration(**patterns):
    """A calibration with one component per pattern, its regions placed exactly."""
    components = tuple(Component(pattern, pattern, u, "B", None, "planted") for pattern, u in patterns.items())
    return Calibration(components, 0.0, None, "exact", True)
