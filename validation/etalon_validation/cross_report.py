"""The page of a cross-prediction: what was fitted on one photograph, and how the other came out."""

import io
from pathlib import Path

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib import pyplot

from .maps import gradient
from .overlay import display, png
from .report import data_uri

# Ends of the difference map: prediction minus photograph, over the photograph's mean.
DIFFERENCE_RANGE = 0.5


def svg(figure):
    """A figure as SVG text to stand in a page."""
    text = io.StringIO()
    figure.savefig(text, format="svg", bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)
    return text.getvalue()[text.getvalue().index("<svg") :]


def profile_plot(report):
    """Fitted lamp profiles over the angles at which the scene is lit; None without any."""
    rows = [entry for entry in report["sets"] if "lamp" in entry]
    if not rows:
        return None
    figure, axes = pyplot.subplots(figsize=(5.2, 3.2))
    for entry in rows:
        bold = entry is report["sets"][report["headline"]]
        axes.plot(entry["lamp"]["angles_deg"], entry["lamp"]["relative"], label=entry["title"].replace("exposure + ", ""), linewidth=2.5 if bold else 1)
    axes.set_xlabel("angle from the axis, degrees")
    axes.set_ylabel("relative to the axis")
    axes.set_ylim(bottom=0)
    axes.grid(alpha=0.3)
    axes.legend(fontsize=7)
    return svg(figure)


def difference(predicted, photo, inside):
    """Map of prediction minus photograph, mean over channels, over the photograph's mean; grey where nothing is scored."""
    values = (predicted - photo).mean(axis=-1) / photo[inside].mean()
    colours = pyplot.get_cmap("RdBu_r")(np.clip(values / DIFFERENCE_RANGE / 2 + 0.5, 0, 1))[..., :3]
    colours[~inside] = 0.35
    return png(colours)


def pictures(report, predicted, outcomes):
    """Photograph, and prediction with its difference for no unknowns and for the headline; None without a photograph."""
    if predicted.picture is None:
        return None
    found = {"photo": data_uri(display(predicted.picture)), "predictions": []}
    for index in dict.fromkeys((0, report["headline"])):
        picture = outcomes[index].model.predict(predicted.basis_pictures)
        found["predictions"].append({
            "title": report["sets"][index]["title"], "nrmse": report["sets"][index]["predicted_nrmse"],
            "picture": data_uri(display(picture)), "difference": data_uri(difference(picture, predicted.picture, predicted.inside)),
        })
    return found


def regions(predicted, outcome):
    """Mean over channels of photograph and prediction in each region."""
    again = outcome.model.predict(predicted.region_basis).mean(axis=1)
    photo = predicted.region_photo.mean(axis=1)
    return [{"name": name, "photo": float(p), "predicted": float(q), "error": float((q - p) / photo.mean())} for name, p, q in zip(predicted.names, photo, again)]


def write_pages(folder, report, sides, outcomes, lamp):
    """cross.html into a folder."""
    engine = Environment(loader=FileSystemLoader(Path(__file__).parent), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    engine.filters["percent"] = lambda value, digits=1: f"{100 * value:.{digits}f}"
    page = engine.get_template("cross.html.jinja").render(
        report=report, profile=profile_plot(report), images=pictures(report, sides[1], outcomes),
        rows=regions(sides[1], outcomes[report["headline"]]), gradient=gradient("RdBu_r"), difference_range=DIFFERENCE_RANGE,
        axis=lamp.axis if lamp else None, longest=max(entry["predicted_nrmse_95"][1] for entry in report["sets"]),
    )
    (Path(folder) / "cross.html").write_text(page, encoding="utf-8")
