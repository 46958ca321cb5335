"""The page of `validate peers`: the verdict block by block, and error against run time."""

from pathlib import Path

from .converge_plot import draw
from .errors import read_json
from .page import svg, write_page
from .peers import TOLERANCE


def write_peer_page(folder, report, reports):
    """report.html beside peers.json, which it shows too."""
    folder = Path(folder)
    blocks = read_json(folder / "peers.json", "run validate peers")
    rows = [row | {"pixels": pixels} for pixels, row in blocks["block_sizes"].items()]
    from .peer_study import caption

    figure = draw(reports, caption(report), report["reference"]["relative_variance"])
    write_page(folder / "report.html", "peers.html.jinja", report=report, blocks=blocks, rows=rows, plot=svg(figure), tolerance=TOLERANCE)
