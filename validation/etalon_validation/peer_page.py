"""The page of `validate peers`: the verdict block by block, and error against run time."""

from pathlib import Path

from .converge_plot import draw
from .errors import read_json
from .page import svg, write_page
from .peer_study import RENDERING, caption
from .peers import TOLERANCE


def write_peer_page(folder, report, judged):
    """report.html beside peers.json, which it shows too."""
    folder = Path(folder)
    blocks = read_json(folder / "peers.json", "run validate peers")
    rows = [row | {"pixels": pixels} for pixels, row in blocks["block_sizes"].items()]
    floor = report["reference"]["relative_variance"]
    plots = {
        "rendering": svg(draw(judged.rendering, caption(report), floor, RENDERING)),
        "whole": svg(draw(judged.reports, (), floor)),
    }
    write_page(folder / "report.html", "peers.html.jinja", report=report, blocks=blocks, rows=rows, plots=plots, tolerance=TOLERANCE)
