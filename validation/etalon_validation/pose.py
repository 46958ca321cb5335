"""Fits the camera of a photograph to published vertices picked in it.

Three nested models: principal point in the middle of the image (centred), free
(shifted), and free with one radial distortion term (distorted). A larger model
is taken only when an F-test at 1 % and the corrected Akaike criterion both say
that it describes the points better, and the smaller one misses them by more
than they can be picked (chi-squared at 1 %): below that, more parameters
describe the picking and not the camera.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy import optimize, stats

from .camera import Pinhole, turned, unit
from .errors import InputError, meaning, need, read_json

ABOUT = (
    "Camera of the photograph, fitted to points.csv in the world axes of that file. look and up are unit vectors; "
    "the image's right is look x up. principal_point_px is the shift from the image centre, right and down; k1 moves a point at r focal "
    "lengths from the axis to r (1 + k1 r^2). covariance belongs to the parameters of the chosen model in their order. "
    "Standard errors are one sigma, from the residuals."
)
# Standard deviation of a picked coordinate, pixels: corners are blurred over three.
PICKING_PX = 1.5
UNITS = ("mm", "cm", "m")
CENTRED = ("yaw_deg", "pitch_deg", "roll_deg", "focal_px")
# Added by each larger model; a name of the model, its new parameters and where they start.
MODELS = (("centred", ()), ("shifted", ("shift_u_px", "shift_v_px")), ("distorted", ("k1",)))
# A larger model must be better, and a smaller one worse than picking, with less than this chance of error.
LEVEL = 0.01


def read_points(path):
    """World points (n, 3), their pixels (n, 2), the unit of length and the points' names from a picked-points CSV.

    The column `name` is optional; without it points are called by their order.
    """
    path = Path(path)
    remedy = "write the columns name,x_mm,y_mm,z_mm,u_px,v_px (or _cm, _m; name may be left out)"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(path, f"cannot be read ({error})", remedy) from None
    rows = list(csv.DictReader(line for line in lines if line and not line.startswith("#")))
    unit = next((unit for unit in UNITS if rows and f"x_{unit}" in rows[0]), None)
    if unit is None:
        raise InputError(path, "not a table of picked points", remedy)
    columns = [f"{axis}_{unit}" for axis in "xyz"] + ["u_px", "v_px"]
    try:
        table = np.array([[float(row[name]) for name in columns] for row in rows])
    except (KeyError, TypeError, ValueError) as error:
        raise InputError(path, f"not a table of picked points ({error})", remedy) from None
    if not np.isfinite(table).all():
        raise InputError(path, "holds a value that is not finite", remedy)
    if len(table) < 6:
        raise InputError(path, f"{len(table)} points are too few", "pick six or more vertices")
    names = [row.get("name") or f"point {index + 1}" for index, row in enumerate(rows)]
    return table[:, :3], table[:, 3:], unit, names


@dataclass(frozen=True)
class Frame:
    """The level view that angles are counted from, the image size, and the unit of length."""

    look: np.ndarray
    up: np.ndarray
    size: tuple
    unit: str

    def names(self, count):
        """Names of the first `count` parameters."""
        added = tuple(name for _, names in MODELS for name in names)
        return (tuple(f"{axis}_{self.unit}" for axis in "xyz") + CENTRED + added)[:count]

    def parameters(self, camera):
        """The ten parameters of a camera; the inverse of `camera`."""
        right = np.cross(self.look, self.up)
        yaw = np.arctan2(camera.look @ right, camera.look @ self.look)
        pitch = np.arcsin(np.clip(camera.look @ self.up, -1, 1))
        aimed, upright = turned(self.look, self.up, yaw, pitch, 0.0)
        roll = np.arctan2(camera.up @ np.cross(aimed, upright), camera.up @ upright)
        shift = np.asarray(camera.centre_px) - np.asarray(self.size) / 2
        return np.array([*camera.position, *np.degrees([yaw, pitch, roll]), camera.focal_px, *shift, camera.k1])

    def camera(self, parameters):
        """The pinhole that a parameter vector stands for."""
        parameters = np.asarray(parameters, float)
        look, up = turned(self.look, self.up, *np.radians(parameters[3:6]))
        shift = parameters[7:9] if len(parameters) > 7 else np.zeros(2)
        k1 = float(parameters[9]) if len(parameters) > 9 else 0.0
        centre = (self.size[0] / 2 + shift[0], self.size[1] / 2 + shift[1])
        return Pinhole(parameters[:3], look, up, float(parameters[6]), centre, tuple(self.size), k1)


def fit(points, pixels, frame, start):
    """Least squares of reprojection; returns the values, their deviations, and the residuals."""
    def residuals(parameters):
        return (frame.camera(parameters).project(points) - pixels).ravel()

    solution = optimize.least_squares(residuals, start, x_scale=np.maximum(np.abs(start), 1.0), xtol=1e-14, ftol=1e-14)
    freedom = solution.fun.size - len(start)
    variance = solution.fun @ solution.fun / freedom
    covariance = variance * np.linalg.inv(solution.jac.T @ solution.jac)
    return {
        "names": frame.names(len(start)),
        "values": solution.x,
        "covariance": covariance,
        "deviations": np.sqrt(np.diag(covariance)),
        "residuals": solution.fun.reshape(-1, 2),
        "freedom": freedom,
        "squares": float(solution.fun @ solution.fun),
    }


def corrected_akaike(model):
    """Akaike's criterion with the small-sample correction; infinite where points are too few for it. The variance counts as a parameter."""
    count = model["residuals"].size
    parameters = len(model["names"]) + 1
    if count <= parameters + 1:
        return np.inf
    return count * np.log(model["squares"] / count) + 2 * parameters * count / (count - parameters - 1)


def describe(model, frame):
    """The fitted model as plain numbers for pose.json."""
    camera, size = frame.camera(model["values"]), frame.size
    rms = np.sqrt(np.mean(np.sum(model["residuals"] ** 2, axis=1)))
    focal, focal_deviation = model["values"][6], model["deviations"][6]
    hfov_deviation = np.degrees(size[0] / focal**2 / (1 + (size[0] / 2 / focal) ** 2)) * focal_deviation
    return {
        f"position_{frame.unit}": [round(float(v), 4) for v in camera.position],
        "look": [round(float(v), 7) for v in camera.look],
        "up": [round(float(v), 7) for v in camera.up],
        "horizontal_fov_deg": round(camera.hfov_deg, 4),
        "principal_point_px": [round(camera.centre_px[0] - size[0] / 2, 3), round(camera.centre_px[1] - size[1] / 2, 3)],
        "k1": round(float(camera.k1), 6),
        "rms_px": round(float(rms), 3),
        "worst_px": round(float(np.sqrt(np.max(np.sum(model["residuals"] ** 2, axis=1)))), 3),
        "parameters": {
            name: {"value": round(float(value), 4), "standard_error": round(float(deviation), 4)}
            for name, value, deviation in zip(model["names"], model["values"], model["deviations"])
        } | {"horizontal_fov_deg": {"value": round(camera.hfov_deg, 4), "standard_error": round(float(hfov_deviation), 4)}},
        "aicc": finite(corrected_akaike(model), 3),
    }


def moved(first, second, points, frame):
    """The largest distance between the two models' images of the points, pixels."""
    steps = frame.camera(first["values"]).project(points) - frame.camera(second["values"]).project(points)
    return float(np.sqrt(np.max(np.sum(steps**2, axis=1))))


def finite(value, digits):
    """A rounded number for JSON, or None where it is not finite."""
    return round(float(value), digits) if np.isfinite(value) else None


def fit_models(points, pixels, frame):
    """Every model that the points leave freedom to test, smallest first, as (name, fit) pairs."""
    stand = points.mean(axis=0) - 2 * np.ptp(points, axis=0).max() * frame.look
    start, fits = np.array([*stand, 0, 0, 0, 1.5 * frame.size[0]]), []
    for name, added in MODELS:
        start = np.append(start, np.zeros(len(added)))
        if pixels.size - len(start) < 2:
            break
        fits.append((name, fit(points, pixels, frame, start)))
        start = fits[-1][1]["values"]
    return fits


def step_up(small, large, points, frame):
    """The test of one model against the next larger one."""
    added = len(large["names"]) - len(small["names"])
    ratio = ((small["squares"] - large["squares"]) / added) / (large["squares"] / large["freedom"])
    chance = float(stats.f.sf(ratio, added, large["freedom"]))
    misses = float(stats.chi2.sf(small["squares"] / PICKING_PX**2, small["freedom"]))
    gain = corrected_akaike(small) - corrected_akaike(large)
    better = chance < LEVEL and gain > 0
    return {
        "better": bool(better), "taken": bool(better and misses < LEVEL), "f": round(float(ratio), 3), "p": round(chance, 5),
        "aicc_gain": finite(gain, 3), "smaller_within_picking_p": round(misses, 4), "largest_move_px": round(moved(small, large, points, frame), 3),
    }


def spread_px(points, frame, values, covariance):
    """Standard errors (n,) of projected points from the parameters' covariance: the longer half axis of each ellipse, pixels."""
    values = np.asarray(values, float)
    steps = 1e-5 * np.maximum(np.abs(values), 1.0)
    slopes = np.stack([
        (frame.camera(values + step).project(points) - frame.camera(values - step).project(points)) / (2 * step.sum())
        for step in np.diag(steps)
    ], axis=-1)
    spread = slopes @ covariance @ np.swapaxes(slopes, -1, -2)
    return np.sqrt(np.maximum(np.linalg.eigvalsh(spread)[:, -1], 0))


def fit_pose(points, pixels, frame, names=None):
    """All models, the tests between them, and the chosen camera, as pose.json holds them."""
    fits = fit_models(points, pixels, frame)
    tests = {name: step_up(small, large, points, frame) for (_, small), (name, large) in zip(fits, fits[1:])}
    chosen, described = fits[0], fits[0][0]
    for candidate in fits[1:]:
        if not tests[candidate[0]]["better"]:
            break
        described = candidate[0]
        if tests[candidate[0]]["taken"] and chosen is fits[fits.index(candidate) - 1]:
            chosen = candidate
    models = {name: describe(model, frame) for name, model in fits}
    name, model = chosen
    misses = np.linalg.norm(model["residuals"], axis=1)
    names = names or [f"point {index + 1}" for index in range(len(points))]
    return {
        **{key: models[name][key] for key in (f"position_{frame.unit}", "look", "up", "horizontal_fov_deg", "principal_point_px", "k1", "rms_px")},
        "image_px": list(frame.size),
        "points": len(points),
        "chosen": name,
        "test": {"better_described_by": described, "picking_px": PICKING_PX, "level": LEVEL, "steps": tests},
        "covariance": [[float(f"{value:.6g}") for value in row] for row in model["covariance"]],
        "point_residuals_px": {str(label): round(float(miss), 2) for label, miss in zip(names, misses)},
        "models": models,
    }


def fit_case(case):
    """The pose of a case folder: points.csv fitted from the level view that layout.json names."""
    case = Path(case)
    points, pixels, length, names = read_points(case / "points.csv")
    frame = read_frame(case / "layout.json", length)
    try:
        return {"about": ABOUT, **fit_pose(points, pixels, frame, names)}
    except (np.linalg.LinAlgError, ValueError) as error:
        raise InputError(case / "points.csv", f"fix no camera ({error})", "pick vertices that span the picture and lie in more than one plane") from None


def read_frame(layout, length):
    """The level view that a layout counts angles from."""
    camera = need(read_json(layout, "a case needs a layout.json"), "camera", layout)
    level = need(camera, "level", layout)
    with meaning(layout, "give level.look, level.up and image_px under camera"):
        return Frame(unit(level["look"]), unit(level["up"]), (int(camera["image_px"][0]), int(camera["image_px"][1])), length)


def describe_fit(result):
    """The fit in a few lines for the terminal."""
    model = result["models"][result["chosen"]]
    lines = [f"rms {result['rms_px']} px over {result['points']} points, principal point {result['chosen']}"]
    lines += [f"  {name:20} {entry['value']:10.3f} +- {entry['standard_error']:.3f}" for name, entry in model["parameters"].items()]
    for name, test in result["test"]["steps"].items():
        lines.append(f"{name}: F {test['f']}, p {test['p']}, AICc gain {test['aicc_gain']}; moves points by at most {test['largest_move_px']} px{', taken' if test['taken'] else ''}")
    if "region_corners" in result:
        corners = result["region_corners"]
        lines.append(f"corners of regions: standard error {corners['median_px']} px, worst {corners['worst_px']} px ({corners['worst']})")
    return "\n".join(lines)


def corner_spread(result, layout, frame):
    """How well the pose fixes the projected corners of the patches: median and worst standard error, pixels."""
    values = np.array([entry["value"] for name, entry in result["models"][result["chosen"]]["parameters"].items() if name != "horizontal_fov_deg"])
    covariance = np.array(result["covariance"])
    worst = {}
    for patch in layout.patches:
        corners = layout.points(patch)
        corners = corners[layout.camera.depth(corners) > 0]
        if len(corners):
            worst[patch.name] = float(spread_px(corners, frame, values, covariance).max())
    name = max(worst, key=worst.get)
    return {"median_px": round(float(np.median(list(worst.values()))), 3), "worst_px": round(worst[name], 3), "worst": name}
