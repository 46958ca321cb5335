"""Small pictures of a render and its photograph, for pages that show many cases."""

import numpy as np
from PIL import Image

from .photograph import linear_to_srgb

# Width of a thumbnail.
WIDTH_PX = 240


def write_thumbnail(path, linear):
    """A PNG of linear RGB (height, width, 3) through the sRGB curve, each pixel the mean of those it covers."""
    pixels = np.round(255 * linear_to_srgb(linear)).astype(np.uint8)
    image = Image.fromarray(pixels)
    size = (WIDTH_PX, max(1, round(WIDTH_PX * image.height / image.width)))
    (image if image.width <= WIDTH_PX else image.resize(size, Image.Resampling.BOX)).save(path, format="PNG")


def write_pair(folder, render_linear, photo_linear):
    """The thumbnails of one case; without a photograph only the render's, and none is left from before."""
    write_thumbnail(folder / "thumbnail-render.png", render_linear)
    if photo_linear is None:
        (folder / "thumbnail-photo.png").unlink(missing_ok=True)
    else:
        write_thumbnail(folder / "thumbnail-photo.png", photo_linear)
