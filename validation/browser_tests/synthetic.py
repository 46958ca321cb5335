"""A photograph with known answers, made from a render: `python -m browser_tests.synthetic RENDER.exr PHOTO.exr`.

It stands in for photographs that may not be part of the project, so that pages
with sliders and maps can be opened.
"""

import sys

import numpy as np
import OpenImageIO as oiio

from etalon_validation.difference import XYZ_TO_SRGB
from etalon_validation.render import read_render

# Stops by which the photograph is darker, and channel gains of its camera.
EXPOSURE_STOPS = -0.37
GAINS = np.array([1.2, 1.0, 0.85])


def photograph(render):
    """Linear RGB of the render, exposed and balanced otherwise."""
    linear = render.xyz / render.saturation @ XYZ_TO_SRGB.T
    return 2**EXPOSURE_STOPS * GAINS * linear


def main(source, target):
    """Writes the photograph of a render."""
    pixels = np.ascontiguousarray(photograph(read_render(source)), dtype=np.float32)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, oiio.FLOAT)
    output = oiio.ImageOutput.create(target)
    output.open(target, spec)
    output.write_image(pixels)
    output.close()


if __name__ == "__main__":
    main(*sys.argv[1:])
