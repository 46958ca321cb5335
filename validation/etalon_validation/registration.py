"""How a case's cameras stand to its photograph: the account of it in the report.

Three cameras are compared: that of the scene, which the render shows; that of
pose.json, which places the regions on the photograph; and the one that the
photograph itself asks for when its edges are laid on those of the render. A
photograph that does not stand where pose.json says is refused.
"""

from pathlib import Path

import numpy as np

from .align import Picked, refine
from .camera import Pinhole
from .difference import XYZ_TO_SRGB
from .edges import grey
from .layout import REGISTRATION_PX, Layout
from .errors import InputError, meaning, read_json
from .misfit import judge_photograph
from .pose import read_frame, read_points, spread_px
from .regions import through_the_render
from .scene_faces import METERS


def image_distance_mm(camera, unit_m):
    """How far behind the lens the picture is: a lens focused at a distance d has it at v, 1/v = 1/f - 1/d."""
    focal_mm, focus = camera["focal_length_mm"], camera.get("focus_distance")
    return focal_mm if focus is None else 1 / (1 / focal_mm - 1 / (1000 * unit_m * focus))


def scene_camera(scene, length, size):
    """The scene's pinhole in `length` units for an image of `size`; None when the scene has no camera."""
    camera = scene.get("camera")
    if not camera:
        return None
    scale = METERS[scene["length_unit"]] / METERS[length]
    position = scale * np.array(camera["position"], float)
    look = np.array(camera["direction"], float) if camera.get("direction") else scale * np.array(camera["look_at"], float) - position
    hfov_deg = 2 * np.degrees(np.arctan(camera["sensor_mm"][0] / 2 / image_distance_mm(camera, METERS[scene["length_unit"]])))
    shift = np.array(camera.get("principal_point_px", (0, 0)), float) * size[0] / camera["resolution"][0]
    return Pinhole.looking(position, look, camera["up"], hfov_deg, size, tuple(shift))


def registration(case):
    """Mean and largest distance in pixels between face corners seen by both cameras; None without both."""
    case = Path(case)
    if not all((case / name).is_file() for name in ("scene.json", "layout.json", "pose.json")):
        return None
    layout = Layout(case / "layout.json")
    layout = layout.seen_by(layout.camera.undistorted)
    pose = read_json(case / "pose.json", "run fit-pose")
    length = next(key.removeprefix("position_") for key in pose if key.startswith("position_"))
    scene = read_json(case / "scene.json", "correct it")
    with meaning(case / "scene.json", "correct the camera"):
        camera = scene_camera(scene, length, layout.camera.size)
    if camera is None:
        return None
    corners = np.unique(np.concatenate([face.quad for face in layout.faces.values()]), axis=0)
    fitted = layout.camera.project(corners)
    seen = ((fitted >= 0) & (fitted <= layout.camera.size)).all(axis=1) & ((corners - layout.camera.position) @ layout.camera.look > 0)
    if not seen.any():
        raise InputError(case / "pose.json", "its camera sees no corner of the box", "run fit-pose again")
    distance = np.linalg.norm(camera.project(corners[seen]) - fitted[seen], axis=1)
    return {"mean_px": round(float(distance.mean()), 2), "largest_px": round(float(distance.max()), 2), "corners": int(seen.sum()), "allowed_px": REGISTRATION_PX}


def registration_warning(found):
    """The warning that a badly registered scene deserves, or None."""
    if found is None or found["largest_px"] <= found["allowed_px"]:
        return None
    return (
        f"scene.json: its camera puts corners of the box up to {found['largest_px']:.1f} px from where pose.json finds them in the photograph; "
        "take the camera from pose.json, or regions show other surfaces than the photograph"
    )


def render_camera(case, layout, size):
    """The camera of a case's scene for a render of `size`, in the layout's unit; None without one."""
    scene = read_json(Path(case) / "scene.json", "correct it")
    with meaning(Path(case) / "scene.json", "correct the camera"):
        camera = scene_camera(scene, layout.length_unit, layout.camera.size)
    return camera and camera.resized(size)


def picture(render):
    """A render's linear RGB (h, w, 3): the camera's channels where it has them."""
    return render.sensor if render.sensor is not None else render.xyz @ XYZ_TO_SRGB.T


def register(case, photograph, render):
    """What the photograph says of its own registration: the verdict at pose.json's camera, and the camera refined on it.

    None where the case has no scene, layout and pose to lay over it.
    """
    case = Path(case)
    if not all((case / name).is_file() for name in ("scene.json", "layout.json", "pose.json")):
        return None
    layout = Layout(case / "layout.json")
    camera = render_camera(case, layout, render.size)
    if camera is None:
        return None
    if photograph.size != layout.camera.size:
        raise InputError(photograph.file, f"is {photograph.size} pixels, the camera has {layout.camera.size}", "give the photograph that the pose was fitted on")
    # The photograph has been resampled to its pinhole where the pose has distortion.
    layout = layout.seen_by(layout.camera.undistorted)
    picked = read_picked(case)
    photo, made = grey(photograph.rgb), grey(picture(render))
    verdict = judge_photograph(layout, photo, made, camera, picked)
    try:
        verdict["refined"] = refined_pose(case, layout, photo, made, camera, picked)
    except InputError as error:
        verdict["refined"] = None
        if verdict["verdict"] == "accepted":
            verdict |= {"verdict": "failed", "reasons": [str(error)]}
    return verdict


def read_picked(case):
    """The picked points of a case; None without points.csv. They see the pinhole where the pose has distortion."""
    if not (case / "points.csv").is_file():
        return None
    points, pixels, *_ = read_points(case / "points.csv")
    camera = Layout(case / "layout.json").camera
    return Picked(points, camera.undistorted.project(camera.position + camera.rays(pixels)))


def refined_pose(case, layout, photo, made, camera, picked):
    """The camera refined on the photograph: parameters with errors, its move against pose.json, and the verdict at it."""
    frame = read_frame(case / "layout.json", layout.length_unit)
    free = 7 if np.allclose(layout.camera.centre_px, np.asarray(layout.camera.size) / 2) else 9
    if picked is None:
        picked = Picked(np.zeros((0, 3)), np.zeros((0, 2)))
    found = refine(layout, frame, free, picked, photo, made, camera, case / "layout.json")
    corners = visible_corners(layout)
    moves = np.linalg.norm(found.camera.project(corners) - layout.camera.project(corners), axis=1)
    spread = spread_px(corners, frame, found.values, found.covariance)
    left = judge_photograph(layout.seen_by(found.camera), photo, made, camera)
    return {
        "parameters": {
            name: {"value": round(float(value), 4), "standard_error": round(float(error), 4)}
            for name, value, error in zip(frame.names(free), found.values, np.sqrt(np.diag(found.covariance)))
        },
        "moved_px": {"mean": round(float(moves.mean()), 3), "largest": round(float(moves.max()), 3)},
        "corner_standard_error_px": {"median": round(float(np.median(spread)), 3), "largest": round(float(spread.max()), 3)},
        "edge_deviation_px": round(found.edge_px, 3), "edge_points": len(found.left.offsets), "edge_points_in_view": found.candidates,
        "rms_px": round(float(np.sqrt((found.left.offsets**2).mean())), 3),
        "verdict": left["verdict"], "tiles": left["tiles"],
    }


def visible_corners(layout):
    """Corners (n, 3) of the layout's patches inside its picture."""
    corners = np.concatenate([layout.points(patch) for patch in layout.patches])
    corners = corners[layout.camera.depth(corners) > 0]
    pixels = layout.camera.project(corners)
    return corners[((pixels >= 0) & (pixels <= np.asarray(layout.camera.size))).all(axis=1)]


def refuse_unless_registered(found, photograph, forced):
    """Ends with one error where the registration failed, unless it is `forced`; then returns the warning to report."""
    if found is None or found["verdict"] == "accepted":
        return None
    problem = "registration failed: " + "; ".join(found["reasons"])
    if not forced:
        raise InputError(photograph.file, problem, "give the photograph of this case, render more samples, fit the pose again (fit-pose, measure-regions), or score anyway with --force-registration")
    return f"{photograph.file}: {problem}; scored because of --force-registration, no figure is to be believed"


def mark_failed(report):
    """Writes over every level, region, finding and figure of the whole that the registration failed."""
    report["registration_failed"] = True
    report["calibration_error"]["registration_failed"] = True
    report["findings"].insert(0, {"topic": "registration", "settled": False, "text": "The registration failed and was overruled: no figure of this report is to be believed."})
    for level in report["levels"].values():
        level["title"] += " (REGISTRATION FAILED)"
        level["registration_failed"] = True
        for row in level["regions"]:
            row["flag"] = "registration failed"


def regions_in_render(case, regions, render):
    """The regions with their polygons seen through the scene's camera; unchanged where it has none."""
    layout = Layout(Path(case) / "layout.json")
    layout = layout.seen_by(layout.camera.undistorted)
    camera = render_camera(case, layout, render.size)
    return regions if camera is None else through_the_render(regions, layout, camera)


def describe_registration(found):
    """The verdict and the refined pose in a few lines for the terminal."""
    lines = [f"registration {found['verdict']}: {100 * found['found']:.0f} % of the scene's edges found"]
    lines += [f"  {reason}" for reason in found["reasons"]]
    if found.get("displacement_px"):
        moved = found["displacement_px"]
        lines.append(f"displaced by {moved['shift'][0]:.2f}, {moved['shift'][1]:.2f} px, scale {moved['scale_percent']:.2f} %, turn {moved['turn_deg']:.2f} deg; edges deviate by {found['edge_deviation_px']:.2f} px")
    refined = found.get("refined")
    if refined:
        moved, error = refined["moved_px"], refined["corner_standard_error_px"]
        lines.append(f"refined pose: corners of regions move by {moved['mean']:.2f} px, at most {moved['largest']:.2f}; standard error {error['median']:.2f} px, at most {error['largest']:.2f}; rms of edges left {refined['rms_px']:.2f} px")
    return "\n".join(lines)
