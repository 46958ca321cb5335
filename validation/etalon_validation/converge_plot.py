"""Draws a study: error against CPU seconds on logarithmic axes, and efficiency over the best."""

from pathlib import Path


def plot(reports, folder, caption, reference_relmse=None):
    """Writes `converge.svg` and `converge.png` into a folder and returns their paths.

    `reports` are `SeriesReport`s in the order of the legend, `caption` the lines below the
    figure (scene, size, date, machine), `reference_relmse` the reference's own error or None.
    """
    raise NotImplementedError(Path(folder), reports, caption, reference_relmse)
