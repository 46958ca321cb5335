"""The page of a cross-prediction: what was fitted on one photograph, and how the other came out."""

from pathlib import Path

import numpy as np
from matplotlib import pyplot

from .maps import gradient
from .overlay import display, png
from .page import svg, today, write_page
from .report import data_uri
from .thumbnails import write_pair

# Ends of the difference map: prediction minus photograph, over the photograph's mean.
DIFFERENCE_RANGE = 0.5


def profile_plot(report):
    """Fitted lamp profiles over the angles at which the scene is lit; None without any."""
    rows = [entry for entry in report["sets"] if "lamp" in entry]
    if not rows:
        return None
    figure, axes = pyplot.subplots(figsize=(6.4, 3.6), layout="constrained")
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
        picture = outcomes[index].model.predict(predicted.basis_pictures, predicted.mean)
        found["predictions"].append({
            "title": report["sets"][index]["title"], "nrmse": report["sets"][index]["predicted_nrmse"],
            "picture": data_uri(display(picture)), "difference": data_uri(difference(picture, predicted.picture, predicted.inside)),
        })
    return found


def regions(predicted, outcome):
    """Mean over channels of photograph and prediction in each region."""
    again = outcome.model.predict(predicted.region_basis, predicted.mean).mean(axis=1)
    photo = predicted.region_photo.mean(axis=1)
    return [{"name": name, "photo": float(p), "predicted": float(q), "error": float((q - p) / photo.mean())} for name, p, q in zip(predicted.names, photo, again)]


def write_pages(folder, report, sides, outcomes, lamp):
    """report.html and the thumbnails into a folder."""
    folder, predicted = Path(folder), sides[1]
    best = outcomes[report["headline"]]
    write_pair(folder, np.clip(best.model.predict(predicted.basis_pictures, predicted.mean), 0, 1), predicted.picture)
    write_page(
        folder / "report.html", "cross.html.jinja", report=report, profile=profile_plot(report), images=pictures(report, predicted, outcomes),
        rows=regions(predicted, best), gradient=gradient("RdBu_r"), difference_range=DIFFERENCE_RANGE, today=today(),
        axis=lamp.axis if lamp else None, longest=max(entry["predicted_nrmse_95"][1] for entry in report["sets"]),
    )
