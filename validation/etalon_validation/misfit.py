"""Whether a photograph stands where its camera says: accepted, or failed with the reasons.

Four questions are asked. Are the scene's edges there: at least half of those
that the render shows must be found near one common displacement, and half of
those of every thing, a block as well as the room; chance finds a quarter. Is the picture mirrored: its
mirror image must not show clearly more of them. Is the displacement small: a
field of four parameters (shift, scale, turn) is fitted to the offsets along the
edges, and fails where in any tile it is larger than allowed by more than its
error explains. And do the points picked by hand lie where the camera puts them.
The last two are tests: a right registration, displaced by just what is allowed
and picked as well as is stated, fails either with a chance of LEVEL. Edges, not
pixels, are the independent observations.
"""

from dataclasses import dataclass

import numpy as np
from scipy import stats

from .align import LEAST_EDGE_PX, PER_EDGE, edge_weights
from .edges import measure_offsets
from .layout import REGISTRATION_PX

# Search for edges either way, pixels; displacements beyond it are noticed as edges that are not found.
SEARCH_PX = 12.0
# Chance that a registration displaced by just what is allowed is called failed.
LEVEL = 1e-2
# Rounds in which edges that do not agree are left out.
ROUNDS = 8
# Tiles across and down the picture.
TILES = (4, 3)
# An edge agrees with the field within this many pixels, a quarter of the search: by chance one in four does.
AGREEMENT_PX = SEARCH_PX / 4
# Share of the visible edges that must agree, of all and of every thing with so many points in view; and how much more
# the mirror image must show to be the better picture.
LEAST_FOUND = 0.5
LEAST_IN_VIEW = 24
MIRROR_MARGIN = 0.1


@dataclass(frozen=True)
class Field:
    """A displacement field (shift, scale, turn about a middle), its covariance, the deviation of edges from it in pixels, and the degrees of freedom behind that."""

    values: np.ndarray
    covariance: np.ndarray
    middle: np.ndarray
    reach: float
    edge_px: float
    freedom: float

    def basis(self, pixels):
        """Displacements (n, 2, 4) at pixels (n, 2) per unit of each parameter; all parameters are in pixels."""
        x, y = ((np.atleast_2d(pixels) - self.middle) / self.reach).T
        one, zero = np.ones_like(x), np.zeros_like(x)
        return np.stack([np.stack([one, zero, x, -y], axis=1), np.stack([zero, one, y, x], axis=1)], axis=1)

    def at(self, pixels):
        """Displacements (n, 2) and their covariances (n, 2, 2)."""
        basis = self.basis(pixels)
        return basis @ self.values, basis @ self.covariance @ np.swapaxes(basis, 1, 2)


def fit_field(measured):
    """The displacement field that the offsets show: least squares over the edges that agree with it, and the slopes (n, 4) behind it."""
    middle = measured.pixels.mean(axis=0)
    field = Field(np.zeros(4), np.eye(4), middle, float(np.sqrt(((measured.pixels - middle) ** 2).sum(axis=1).mean())), 0.0, 1.0)
    slopes = np.einsum("ni,nip->np", measured.normals, field.basis(measured.pixels))
    weights = edge_weights(measured.edges)
    values = consensus(slopes, measured.offsets, weights)
    for _ in range(ROUNDS):
        near = np.abs(slopes @ values - measured.offsets) < AGREEMENT_PX
        if np.linalg.matrix_rank(slopes[near]) < 4:
            break
        known, wanted = slopes[near] * weights[near, None], measured.offsets[near] * weights[near]
        values = np.linalg.lstsq(known, wanted, rcond=None)[0]
    known, left = slopes[near] * weights[near, None], weights[near] * (slopes @ values - measured.offsets)[near]
    freedom = max(float((weights[near] ** 2).sum()) - 4, 1.0)
    variance = max(float(left @ left) / freedom, LEAST_EDGE_PX**2)
    covariance = np.linalg.pinv(known.T @ known) * variance
    return Field(values, covariance, middle, field.reach, float(np.sqrt(variance)), freedom), slopes


def consensus(slopes, offsets, weights):
    """The shift on a grid of whole pixels with which most edges agree: a start that outliers cannot pull."""
    steps = np.arange(-SEARCH_PX, SEARCH_PX + 1)
    shifts = np.stack([grid.ravel() for grid in np.meshgrid(steps, steps)], axis=1)
    residuals = shifts @ slopes[:, :2].T - offsets
    support = (weights**2 / (1 + residuals**2)).sum(axis=1)
    return np.append(shifts[support.argmax()], [0.0, 0.0])


def judge(measured, in_view, size):
    """The verdict on offsets measured at a camera: a JSON object with `verdict`, `reasons` and the figures behind them."""
    head = {"allowed_px": REGISTRATION_PX, "false_alarm_rate": LEVEL, "search_px": SEARCH_PX}
    if len(np.unique(measured.edges)) < 3:
        return head | {"verdict": "failed", "reasons": [f"{len(np.unique(measured.edges))} edges of the scene are found within {SEARCH_PX:g} px"], "found": 0.0, "tiles": [], "things": []}
    field, slopes = fit_field(measured)
    residuals = slopes @ field.values - measured.offsets
    near = np.abs(residuals) < AGREEMENT_PX
    found = share_found(measured.edges[near], in_view.edges)
    tiles = judge_tiles(field, measured.pixels[near], residuals[near], measured.normals[near], in_view.pixels, size)
    worst = max((tile for tile in tiles if "z" in tile), key=lambda tile: tile["z"], default=None)
    reasons = []
    if found < LEAST_FOUND:
        reasons.append(f"{100 * found:.0f} % of the scene's visible edges are found in the photograph, {100 * LEAST_FOUND:.0f} % are needed")
    things = judge_things(measured.edges[near], in_view)
    for thing in things:
        if thing["found"] < LEAST_FOUND and thing["in_view"] >= LEAST_IN_VIEW and found >= LEAST_FOUND:
            reasons.append(f"the thing around {thing['at_px']} is not there: {100 * thing['found']:.0f} % of its edges are found")
    critical = float(stats.t.isf(LEVEL / max(len(tiles), 1), field.freedom))
    if worst and worst["z"] > critical:
        reasons.append(f"the picture is displaced by {worst['size_px']:.1f} +- {worst['standard_error_px']:.1f} px at {worst['at_px']}, {REGISTRATION_PX:g} px are allowed")
    return head | {
        "verdict": "failed" if reasons else "accepted", "reasons": reasons, "found": round(found, 3),
        "edge_deviation_px": round(field.edge_px, 3), "critical_z": round(critical, 2),
        "displacement_px": {"shift": [round(float(v), 3) for v in field.values[:2]], "scale_percent": round(100 * float(field.values[2]) / field.reach, 3), "turn_deg": round(float(np.degrees(field.values[3] / field.reach)), 3)},
        "tiles": tiles, "things": things,
    }


def judge_things(agreeing, in_view):
    """Per thing: the middle of its points in view, how many there are, and the share of its edges found."""
    things = []
    for name in np.unique(in_view.things):
        here = in_view.things == name
        found = share_found(agreeing, in_view.edges[here])
        things.append({"at_px": [round(float(v)) for v in in_view.pixels[here].mean(axis=0)], "in_view": int(here.sum()), "found": round(found, 3)})
    return things


def judge_photograph(layout, photo, render, render_camera, picked=None):
    """All four questions asked of a photograph at the camera of `layout`; pictures as `grey` makes them."""
    measured, in_view = measure_offsets(layout, photo, render, render_camera, SEARCH_PX)
    verdict = judge(measured, in_view, layout.camera.size)
    mirrored = judge(*measure_offsets(layout, photo[:, ::-1], render, render_camera, SEARCH_PX), layout.camera.size)
    reasons, verdict["found_mirrored"] = verdict["reasons"], mirrored["found"]
    if mirrored["found"] > verdict["found"] + MIRROR_MARGIN:
        reasons.append(f"its mirror image shows {100 * mirrored['found']:.0f} % of the scene's visible edges, itself {100 * verdict['found']:.0f} %")
    if picked is not None:
        misses = layout.camera.project(picked.points) - picked.pixels
        chance = float(stats.chi2.sf((misses**2).sum() / picked.sigma_px**2, misses.size))
        rms = float(np.sqrt((misses**2).sum(axis=1).mean()))
        verdict["points"] = {"rms_px": round(rms, 3), "picking_px": picked.sigma_px, "p": float(f"{chance:.3g}")}
        if chance < LEVEL:
            reasons.append(f"the camera misses the picked points by {rms:.1f} px rms, picking by {picked.sigma_px:g} px each way")
    return verdict | {"verdict": "failed" if reasons else "accepted"}


def share_found(agreeing, in_view):
    """The share of edges in view of which points agree, an edge counting as the share of its points."""
    names, counts = np.unique(in_view, return_counts=True)
    weights = np.minimum(counts, PER_EDGE)
    shares = np.array([(agreeing == name).sum() / count for name, count in zip(names, counts)])
    return float(np.minimum(shares, 1) @ weights / weights.sum()) if len(names) else 0.0


def tile_of(pixels, size):
    """The tile (n, 2), column and row, of every pixel."""
    return np.minimum((pixels / np.asarray(size) * TILES).astype(int), np.array(TILES) - 1)


def judge_tiles(field, pixels, residuals, normals, seen, size):
    """Per tile with edges in view: how many points are found, the field's displacement with its error, and what edges show beyond the field."""
    place, view = tile_of(pixels, size), tile_of(seen, size)
    tiles = []
    for column, row in np.unique(view, axis=0):
        here, in_view = (place == (column, row)).all(axis=1), (view == (column, row)).all(axis=1)
        centre = seen[in_view].mean(axis=0)
        tile = {"at_px": [round(float(v)) for v in centre], "in_view": int(in_view.sum()), "points": int(here.sum())}
        if here.sum() >= PER_EDGE:
            moved, spread = (part[0] for part in field.at(centre))
            length = float(np.linalg.norm(moved))
            towards = moved / max(length, 1e-12)
            error = float(np.sqrt(towards @ spread @ towards))
            local = np.linalg.lstsq(normals[here], -residuals[here], rcond=0.1)[0]
            tile |= {
                "shift_px": [round(float(v), 2) for v in moved], "size_px": round(length, 3), "standard_error_px": round(error, 3),
                "z": round((length - REGISTRATION_PX) / max(error, 1e-9), 2), "beyond_px": [round(float(v), 2) for v in local],
            }
        tiles.append(tile)
    return tiles
