"""Fits the camera of a photograph to published vertices picked in it.

Two models are compared: principal point in the middle of the image, and free.
An F-test and the corrected Akaike criterion say which describes the picked
points better. The camera is the centred one unless the free one is better and
the centred one misses the points by more than they can be picked (chi-squared
at 1 %): below that, two more parameters describe the picking, not the camera.
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
    "the image's right is look x up. principal_point_px is the shift from the image centre, right and down. "
    "Standard errors are one sigma, from the residuals."
)
# Standard deviation of a picked coordinate, pixels: corners are blurred over three.
PICKING_PX = 1.5
UNITS = ("mm", "cm", "m")
CENTRED = ("yaw_deg", "pitch_deg", "roll_deg", "focal_px")
SHIFTED = CENTRED + ("shift_u_px", "shift_v_px")


def read_points(path):
    """World points (n, 3), their pixels (n, 2) and the unit of length from a picked-points CSV."""
    path = Path(path)
    remedy = "write the columns x_mm,y_mm,z_mm,u_px,v_px (or _cm, _m)"
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
    if len(table) < 6:
        raise InputError(path, f"{len(table)} points are too few", "pick six or more vertices")
    return table[:, :3], table[:, 3:], unit


@dataclass(frozen=True)
class Frame:
    """The level view that angles are counted from, the image size, and the unit of length."""

    look: np.ndarray
    up: np.ndarray
    size: tuple
    unit: str

    def names(self, free):
        """Parameter names in the order of the parameter vector."""
        return tuple(f"{axis}_{self.unit}" for axis in "xyz") + (SHIFTED if free else CENTRED)

    def camera(self, parameters):
        """The pinhole that a parameter vector stands for."""
        parameters = np.asarray(parameters, float)
        look, up = turned(self.look, self.up, *np.radians(parameters[3:6]))
        shift = parameters[7:9] if len(parameters) > 7 else np.zeros(2)
        centre = (self.size[0] / 2 + shift[0], self.size[1] / 2 + shift[1])
        return Pinhole(parameters[:3], look, up, float(parameters[6]), centre, tuple(self.size))


def fit(points, pixels, frame, start):
    """Least squares of reprojection; returns the values, their deviations, and the residuals."""
    def residuals(parameters):
        return (frame.camera(parameters).project(points) - pixels).ravel()

    solution = optimize.least_squares(residuals, start, x_scale=np.maximum(np.abs(start), 1.0), xtol=1e-14, ftol=1e-14)
    freedom = solution.fun.size - len(start)
    variance = solution.fun @ solution.fun / freedom
    covariance = variance * np.linalg.inv(solution.jac.T @ solution.jac)
    return {
        "names": frame.names(len(start) > 7),
        "values": solution.x,
        "deviations": np.sqrt(np.diag(covariance)),
        "residuals": solution.fun.reshape(-1, 2),
        "freedom": freedom,
        "squares": float(solution.fun @ solution.fun),
    }


def corrected_akaike(model):
    """Akaike's criterion with the small-sample correction; the variance counts as a parameter."""
    count = model["residuals"].size
    parameters = len(model["names"]) + 1
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
        "rms_px": round(float(rms), 3),
        "worst_px": round(float(np.sqrt(np.max(np.sum(model["residuals"] ** 2, axis=1)))), 3),
        "parameters": {
            name: {"value": round(float(value), 4), "standard_error": round(float(deviation), 4)}
            for name, value, deviation in zip(model["names"], model["values"], model["deviations"])
        } | {"horizontal_fov_deg": {"value": round(camera.hfov_deg, 4), "standard_error": round(float(hfov_deviation), 4)}},
        "aicc": round(float(corrected_akaike(model)), 3),
    }


def moved(first, second, points, frame):
    """The largest distance between the two models' images of the points, pixels."""
    steps = frame.camera(first["values"]).project(points) - frame.camera(second["values"]).project(points)
    return float(np.sqrt(np.max(np.sum(steps**2, axis=1))))


def fit_pose(points, pixels, frame):
    """Both models, the test between them, and the chosen camera, as pose.json holds them."""
    stand = points.mean(axis=0) - 2 * np.ptp(points, axis=0).max() * frame.look
    centred = fit(points, pixels, frame, np.array([*stand, 0, 0, 0, 1.5 * frame.size[0]]))
    shifted = fit(points, pixels, frame, np.append(centred["values"], [0.0, 0.0]))
    ratio = ((centred["squares"] - shifted["squares"]) / 2) / (shifted["squares"] / shifted["freedom"])
    chance = float(stats.f.sf(ratio, 2, shifted["freedom"]))
    misses = float(stats.chi2.sf(centred["squares"] / PICKING_PX**2, centred["freedom"]))
    better = chance < 0.01 and corrected_akaike(shifted) < corrected_akaike(centred)
    free = better and misses < 0.01
    models = {"centred": describe(centred, frame), "shifted": describe(shifted, frame)}
    chosen = models["shifted" if free else "centred"]
    return {
        **{key: chosen[key] for key in (f"position_{frame.unit}", "look", "up", "horizontal_fov_deg", "principal_point_px", "rms_px")},
        "image_px": list(frame.size),
        "points": len(points),
        "chosen": "shifted" if free else "centred",
        "test": {
            "better_described_by": "shifted" if better else "centred",
            "f": round(float(ratio), 3),
            "p": round(chance, 5),
            "aicc_gain_of_shift": round(models["centred"]["aicc"] - models["shifted"]["aicc"], 3),
            "centred_within_picking_p": round(misses, 4),
            "picking_px": PICKING_PX,
            "largest_move_px": round(moved(centred, shifted, points, frame), 3),
        },
        "models": models,
    }


def fit_case(case):
    """The pose of a case folder: points.csv fitted from the level view that layout.json names."""
    case = Path(case)
    points, pixels, length = read_points(case / "points.csv")
    layout = case / "layout.json"
    camera = need(read_json(layout, "a case needs a layout.json"), "camera", layout)
    level = need(camera, "level", layout)
    with meaning(layout, "give level.look, level.up and image_px under camera"):
        frame = Frame(unit(level["look"]), unit(level["up"]), (int(camera["image_px"][0]), int(camera["image_px"][1])), length)
    try:
        return {"about": ABOUT, **fit_pose(points, pixels, frame)}
    except (np.linalg.LinAlgError, ValueError) as error:
        raise InputError(case / "points.csv", f"fix no camera ({error})", "pick vertices that span the picture and lie in more than one plane") from None


def describe_fit(result):
    """The fit in a few lines for the terminal."""
    model = result["models"][result["chosen"]]
    lines = [f"rms {result['rms_px']} px over {result['points']} points, principal point {result['chosen']}"]
    lines += [f"  {name:20} {entry['value']:10.3f} +- {entry['standard_error']:.3f}" for name, entry in model["parameters"].items()]
    test = result["test"]
    lines.append(f"free principal point: F {test['f']}, p {test['p']}, AICc gain {test['aicc_gain_of_shift']}; moves points by at most {test['largest_move_px']} px")
    return "\n".join(lines)
