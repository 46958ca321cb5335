"""Cross-prediction: what is unknown is fitted on one photograph, and another one is predicted.

The fitted picture is never scored: its residual is given as such. `cross.json` names the two
cases, the lamp whose profile may be fitted, and the sets of unknowns to try, from none but the
exposure upwards.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.ndimage import binary_erosion

from . import __version__
from .basis import FIRST_SEED, RIGHT_ANGLE_DEG, Lamp, centre, lamp_object, render_basis
from .difference import SRGB_TO_XYZ, XYZ_TO_SRGB
from .errors import InputError, meaning, need, read_json
from .layout import Layout
from .lens import model_field, undistorted
from .linearity import in_words, noise_exponent
from .photograph import LINEAR, encoding_warning, read_photograph
from .polygons import mask
from .registration import refuse_unless_registered, register
from .regions import read_table
from .unknowns import NAMES, Model, fit, nrmse

# Photographs that differ by less than this are no test of a fit.
ALIKE = 0.1
# Pixels nearer than this to the edge of what the scene shows are left out: registration is no better.
MARGIN_PX = 3
# Fits use means over squares of this many pixels, scores single pixels.
FIT_BLOCK_PX = 6
# Squares whose errors are resampled together for an interval, and the draws.
TILE_PX = 24
DRAWS = 400
SEED = 11


@dataclass(frozen=True)
class Side:
    """One photograph with its basis pictures: values as fitted, and as scored.

    `basis` is (k, n, 3) and `photo` (n, 3) over blocks or regions; the `scored_` ones are over pixels
    or regions, `tile` the square that each scored value lies in; `region_` ones over regions. `mean` (k, 3)
    is that of the whole pictures, which a veil is made of.
    """

    case: Path
    scale: float
    basis: np.ndarray
    photo: np.ndarray
    scored_basis: np.ndarray
    scored_photo: np.ndarray
    tile: np.ndarray
    region_basis: np.ndarray
    region_photo: np.ndarray
    names: tuple
    picture: np.ndarray | None
    inside: np.ndarray | None
    basis_pictures: np.ndarray
    mean: np.ndarray
    noise: dict | None
    file: str


@dataclass(frozen=True)
class Outcome:
    """A set of unknowns fitted on one side and its figures on both."""

    model: Model
    fitted_nrmse: float
    predicted_nrmse: float
    interval: tuple
    region_nrmse: float
    share_rms: float
    scale_stops: float


def read_plan(path):
    """The content of cross.json: its table, the two case folders and the lamp, or None."""
    path = Path(path)
    plan = read_json(path, "name the cases in fit and predict")
    cases = [path.parent.parent / str(need(plan, key, path)) for key in ("fit", "predict")]
    for case in cases:
        if not case.is_dir():
            raise InputError(path, f'no case "{case.name}" beside it', "name a folder of reference/")
    if cases[0] == cases[1]:
        raise InputError(path, "fits and predicts the same case", "name another case in predict")
    sets = need(plan, "unknowns", path)
    with meaning(path, "give lists of " + ", ".join(NAMES)):
        unknown = [name for names in sets for name in names if name not in NAMES]
        if unknown:
            raise InputError(path, f'unknown unknown "{unknown[0]}"', "use " + ", ".join(NAMES))
        if plan["headline"] not in sets:
            raise InputError(path, "headline is no set of unknowns", "repeat one of the sets")
    lamp = None
    if plan.get("lamp"):
        with meaning(path, "give object, axis and orders under lamp"):
            entry = plan["lamp"]
            lamp = Lamp(str(entry["object"]), tuple(float(v) for v in entry["axis"]), tuple(int(v) for v in entry["orders"]))
    return plan, cases, lamp


def channels(render, space):
    """A render in the photograph's channels: the camera's, or linear sRGB, over saturation."""
    if space == "camera_rgb":
        if render.sensor is None:
            raise InputError(render.file, "has no sensor channels", "give the scene's camera a sensor")
        return render.sensor
    return render.xyz @ XYZ_TO_SRGB.T


def visible(layout):
    """Pixels (height, width) that show a face of the layout and are not kept out, without a margin."""
    width, height = layout.camera.size
    rows, columns = np.mgrid[0:height, 0:width]
    first, _ = layout.sees(np.stack([columns.ravel() + 0.5, rows.ravel() + 0.5], axis=1))
    inside = (first != "").reshape(height, width)
    for polygon in layout.keep_out:
        inside &= ~mask(polygon, (width, height))
    return binary_erosion(inside, iterations=MARGIN_PX)


def blocks(values, inside, side):
    """Means (n, channels) of squares of `side` pixels that lie wholly inside."""
    height, width = (size // side * side for size in inside.shape)

    def squares(array):
        cut = array[:height, :width]
        return cut.reshape(height // side, side, width // side, side, -1).swapaxes(1, 2).reshape(-1, side * side, cut.shape[-1] if cut.ndim == 3 else 1)

    whole = squares(inside)[..., 0].all(axis=1)
    return squares(values)[whole].mean(axis=1)


def prepare(case, photo, renders, files, scale=None):
    """A side from a case, its photograph (or None for the region table alone) and its basis renders, read from `files`.

    `scale` divides the renders; the side to be predicted takes that of the fitted one, so that
    one exposure serves both.
    """
    table = read_table(case / "regions.json")
    layout = Layout(case / "layout.json")
    pinhole = layout.camera.undistorted
    facts = renders[0].record["camera"]
    fall_off, _ = model_field(facts.get("vignetting"), facts, pinhole, files[0])
    # Into the prediction and not out of the photograph: a tone curve comes after the lens.
    basis = np.array([channels(render, table.space) for render in renders]) * (1.0 if fall_off is None else fall_off)
    regions = [region for region in table.regions if region.flag is None]
    masks = [mask(region.polygon, table.size) for region in regions]
    region_basis = np.array([[picture[inside].mean(axis=0) for inside in masks] for picture in basis])
    region_photo = np.array([region.rgb for region in regions])
    scale = scale or region_basis[0].mean()
    basis, region_basis = basis / scale, region_basis / scale
    names, mean = tuple(region.name for region in regions), basis.mean(axis=(1, 2))
    if photo is None:
        tile = np.arange(len(names))
        return Side(case, scale, region_basis, region_photo, region_basis, region_photo, tile, region_basis, region_photo, names, None, None, basis, mean, None, table.photo["file"])
    if photo.size != table.size:
        raise InputError(photo.file, f"is {photo.size} pixels, the case has {table.size}", "give the photograph of the case")
    inside = visible(layout.seen_by(pinhole))
    saturated = getattr(photo, "saturated", None)
    if saturated is not None:
        inside &= ~saturated
    rows, columns = np.nonzero(inside)
    tile = rows // TILE_PX * (table.size[0] // TILE_PX + 1) + columns // TILE_PX
    fitted = np.array([blocks(picture, inside, FIT_BLOCK_PX) for picture in basis])
    region_photo = np.array([photo.rgb[within].mean(axis=0) for within in masks])
    return Side(
        case, scale, fitted, blocks(photo.rgb, inside, FIT_BLOCK_PX), basis[:, inside], photo.rgb[inside], tile, region_basis,
        region_photo, names, photo.rgb, inside, basis, mean, noise_exponent(photo.rgb, inside) if photo.encoding == LINEAR else None, photo.file,
    )


def interval(predicted, photo, tile):
    """Central 95 % of the nRMSE over tiles drawn with replacement."""
    _, index = np.unique(tile, return_inverse=True)
    count = np.bincount(index).astype(float)
    squares = np.bincount(index, ((predicted - photo) ** 2).mean(axis=1))
    values = np.bincount(index, photo.mean(axis=1))
    drawn = np.random.default_rng(SEED).integers(len(count), size=(DRAWS, len(count)))
    number = count[drawn].sum(axis=1)
    found = np.sqrt(squares[drawn].sum(axis=1) / number) / (values[drawn].sum(axis=1) / number)
    return tuple(float(end) for end in np.percentile(found, (2.5, 97.5)))


def shares(values):
    """Each channel's share of the three's sum: the colour without the level."""
    return values / values.sum(axis=-1, keepdims=True)


def judge(unknowns, fitted, predicted):
    """Fits a set of unknowns on one side and predicts the other."""
    model = fit(unknowns, fitted.basis, fitted.photo, len(fitted.region_photo), fitted.mean)
    again, photo = model.predict(predicted.scored_basis, predicted.mean), predicted.scored_photo
    regions = model.predict(predicted.region_basis, predicted.mean)
    # The factor on the light with which the prediction would fit best.
    factor = float((again * photo).sum() / (again * again).sum())
    return Outcome(
        model, nrmse(model.predict(fitted.scored_basis, fitted.mean), fitted.scored_photo), nrmse(again, photo),
        interval(again, photo, predicted.tile), nrmse(regions, predicted.region_photo), float(np.sqrt(((shares(regions) - shares(predicted.region_photo)) ** 2).mean())),
        float(np.log2(factor) / model.exponent) if factor > 0 else float("nan"),
    )


def predict(plan_file, renderer, photos, output):
    """The whole comparison: renders, fits, figures; the report as a JSON object and what its pages need."""
    plan, cases, lamp = read_plan(plan_file)
    read = [read_photograph(file) if file else None for file in photos]
    if read[0] is not None and read[0].sha256 == read[1].sha256:
        raise InputError(read[1].file, "is the photograph that is fitted", "give another one to predict")
    sides, renders = [], []
    for index, (case, photo) in enumerate(zip(cases, read)):
        size = read_table(case / "regions.json").size
        seed = FIRST_SEED + 100 * index
        found, files = render_basis(renderer, case, lamp, size, seed, output)
        if photo is not None:
            photo = undistorted(photo, Layout(case / "layout.json").camera)
            refuse_unless_registered(register(case, photo, found[0]), photo, False)
        sides.append(prepare(case, photo, found, files, sides[0].scale if sides else None))
        renders += found
    fitted, predicted = sides
    outcomes = [judge(names, fitted, predicted) for names in plan["unknowns"]]
    report = {
        "kind": "cross", "scene": f"{predicted.case.name} from {fitted.case.name}", "version": renders[0].record.get("version"),
        "integrator": renders[0].record.get("integrator"), "basis_pictures": len(renders) // 2,
        "seconds": sum(render.record["seconds"] for render in renders), "cpu_seconds": sum(render.record["cpu_seconds"] or 0 for render in renders),
        "about": plan.get("about", ""), "published": plan.get("published"), "samples_per_pixel": renderer.spp, "harness_version": __version__,
        "fitted_on": {"case": fitted.case.name, "file": fitted.file, "values": len(fitted.photo), "noise": fitted.noise},
        "predicted": {"case": predicted.case.name, "file": predicted.file, "values": len(predicted.scored_photo), "noise": predicted.noise},
        "scored": "pixels" if predicted.picture is not None else "regions",
        "sets": [row(outcome, lamp) for outcome in outcomes],
        "headline": plan["unknowns"].index(plan["headline"]),
        "lamp_seen_to_deg": round(seen_to_deg(cases[0], lamp), 1) if lamp else None,
    }
    report["apart"] = apart(fitted, predicted)
    report["warnings"] = list(filter(None, (encoding_warning(photo.file, photo.encoding) for photo in read if photo is not None)))
    for entry in report["sets"]:
        if "lamp" in entry:
            entry["lamp"] |= tabulated(lamp, entry.pop("weights"), report["lamp_seen_to_deg"])
    report["statements"] = statements(report)
    return report, sides, outcomes, lamp


def apart(fitted, predicted):
    """How much the photographs themselves differ over the pixels that both score; None without them, or of other sizes."""
    if fitted.picture is None or predicted.picture is None or fitted.picture.shape != predicted.picture.shape:
        return None
    both = fitted.inside & predicted.inside
    if not both.any():
        return None
    first, second = fitted.picture[both], predicted.picture[both]
    return {"nrmse": round(nrmse(first, second), 4), "factor": round(float((first * second).sum() / (first * first).sum()), 4)}


def row(outcome, lamp):
    """An outcome as plain numbers."""
    model = outcome.model
    found = {
        "unknowns": list(model.unknowns), "title": " + ".join(["exposure"] + [NAMES[name] for name in model.unknowns]),
        "parameters": model.parameters, "residual_of_the_fit_nrmse": round(outcome.fitted_nrmse, 4),
        "predicted_nrmse": round(outcome.predicted_nrmse, 4), "predicted_nrmse_95": [round(end, 4) for end in outcome.interval],
        "predicted_regions_nrmse": round(outcome.region_nrmse, 4), "predicted_channel_shares_rms": round(outcome.share_rms, 4), "scale_left_stops": round(outcome.scale_stops, 4),
        "tone_exponent": round(model.exponent, 4), "glare_share": round(model.glare, 4), "matrix": np.round(model.matrix, 4).tolist(),
    }
    if "lamp" in model.unknowns and lamp is not None:
        found |= {"weights": model.weights.tolist(), "lamp": {"orders": list(lamp.orders)}}
    return found


def seen_to_deg(case, lamp):
    """The largest angle from the lamp's axis at which a corner of the case's faces lies."""
    scene = read_json(case / "scene.json", "correct it")
    position = np.array(centre(lamp_object(scene, lamp.object)["shape"]))
    corners = np.concatenate([face.quad for face in Layout(case / "layout.json").faces.values()]) - position
    cosine = corners @ np.array(lamp.axis) / np.linalg.norm(corners, axis=1) / np.linalg.norm(lamp.axis)
    return min(float(np.degrees(np.arccos(np.clip(cosine, -1, 1)).max())), RIGHT_ANGLE_DEG)


def tabulated(lamp, weights, to_deg):
    """The fitted profile where light was seen to fall, relative to its value on the axis."""
    angles = np.linspace(0, to_deg, 13)
    intensity = lamp.profile(weights, angles)
    relative = intensity / intensity[0]
    return {"angles_deg": np.round(angles, 2).tolist(), "relative": np.round(relative, 4).tolist(), "possible": bool((relative >= 0).all())}


def statements(report):
    """What the figures say and what they leave open, in sentences."""
    rows, best = report["sets"], report["sets"][report["headline"]]
    low, high = best["predicted_nrmse_95"]
    said = [
        f"With {best['title']} fitted on {report['fitted_on']['case']} alone, {report['predicted']['case']} is predicted to an nRMSE of "
        f"{100 * best['predicted_nrmse']:.1f} % (95 %: {100 * low:.1f} to {100 * high:.1f} %) over {report['scored']}; nothing was fitted on it."
    ]
    said.append(f"The exposure fitted on the one suits the other within {abs(best['scale_left_stops']):.3f} stops.")
    if report["apart"]:
        said.append(
            f"The two photographs themselves differ by an nRMSE of {100 * report['apart']['nrmse']:.1f} % and a factor of {report['apart']['factor']:.3f} where both are scored"
            + ("; they show nearly the same, so what was fitted on the one tests little on the other." if report["apart"]["nrmse"] < ALIKE else ".")
        )
    impossible = [entry["title"] for entry in rows if "lamp" in entry and not entry["lamp"]["possible"]]
    if impossible:
        said.append("The fitted lamp profile is negative somewhere, which no lamp is, with: " + "; ".join(impossible) + ".")
    for side in ("fitted_on", "predicted"):
        noise = report[side]["noise"]
        if noise is None:
            continue
        said.append(in_words(report[side]["file"], noise)[0])
    by_name = {frozenset(entry["unknowns"]): entry["predicted_nrmse"] for entry in rows}
    for names, figure in by_name.items():
        without = by_name.get(names - {"lamp"})
        if "lamp" in names and without is not None:
            others = " + ".join(["exposure"] + sorted(NAMES[name] for name in names - {"lamp"}))
            said.append(f"Beside {others}, a lamp profile changes the prediction from {100 * without:.1f} to {100 * figure:.1f} %.")
    if any("tone" in entry["unknowns"] for entry in rows):
        said.append("A tone curve, veiling glare, light from the surroundings and the lamp's profile all brighten dark places: one finished photograph of each scene cannot tell them apart. A raw file, or a photograph of a step chart, would.")
    return said


def run(plan_file, renderer, photos, output):
    """Writes report.json and report.html into a folder; returns the report."""
    from .cross_report import write_pages

    output = Path(output)
    output.mkdir(parents=True, exist_ok=True)
    report, sides, outcomes, lamp = predict(plan_file, renderer, photos, output)
    (output / "report.json").write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    write_pages(output, report, sides, outcomes, lamp)
    return report
