"""Images for eyes: photographs and renders as PNG, with region outlines drawn on them."""

import io
from html import escape

import matplotlib
import numpy as np
from matplotlib import image as mpl_image

from .photograph import linear_to_srgb

matplotlib.use("Agg")


def png(encoded):
    """PNG bytes of display-encoded values in 0..1."""
    buffer = io.BytesIO()
    mpl_image.imsave(buffer, np.clip(encoded, 0, 1), format="png")
    return buffer.getvalue()


def display(linear):
    """PNG bytes of linear RGB through the sRGB curve."""
    return png(linear_to_srgb(linear))


def spoken(name):
    """A region's name in words."""
    return name.replace("_", " ")


def outlines_svg(regions, size):
    """An SVG layer with every region's outline and name, to lie over an image of `size`."""
    shapes = "".join(
        f'<polygon data-region="{escape(region.name)}" points="{" ".join(f"{u:.1f},{v:.1f}" for u, v in region.polygon)}"><title>{escape(spoken(region.name))}</title></polygon>'
        for region in regions
    )
    return f'<svg class="outlines" viewBox="0 0 {size[0]} {size[1]}" preserveAspectRatio="none">{shapes}</svg>'


def write_overlay(path, photograph, regions, scale=2):
    """Writes a photograph with the regions drawn on it."""
    from matplotlib import pyplot

    width, height = photograph.size
    figure = pyplot.figure(figsize=(width * scale / 100, height * scale / 100), dpi=100)
    axes = figure.add_axes((0, 0, 1, 1))
    gain = 1 / max(np.percentile(photograph.rgb, 99.5), 1e-6)
    axes.imshow(linear_to_srgb(photograph.rgb * gain), extent=(0, width, height, 0), interpolation="nearest")
    for region in regions:
        closed = np.vstack([region.polygon, region.polygon[:1]])
        axes.plot(closed[:, 0], closed[:, 1], color="white", linewidth=2)
        axes.plot(closed[:, 0], closed[:, 1], color="magenta", linewidth=1)
        axes.text(*region.polygon.mean(axis=0), region.name, color="cyan", fontsize=6, ha="center", va="center")
    axes.set_axis_off()
    figure.savefig(path)
    pyplot.close(figure)
