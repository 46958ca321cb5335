"""Refines a camera on the photograph itself: edges of the render against edges of the photograph.

Gauss-Newton with a robust loss on the offsets along projected edges, together
with the picked points, which alone see the rims of an open box. Offsets are
measured again at each new pose, over a shorter search. An edge that stands
elsewhere than the scene says moves all its points together, so however many
points it has it counts as two observations, its place and its tilt; how well
edges agree with the scene is estimated from the offsets that the fit leaves.
"""

from dataclasses import dataclass

import numpy as np
from scipy import optimize

from .edges import Offsets, measure_offsets
from .errors import InputError
from .pose import PICKING_PX

# Search along the normal at the first, second, ... pose, pixels.
SEARCH_PX = (12.0, 6.0, 4.0, 3.0, 3.0)
# Observations that one edge stands for.
PER_EDGE = 2
# Deviation of edges at the start, and the least that is believed: profiles are sampled at a quarter of a pixel.
EDGE_PX = 1.0
LEAST_EDGE_PX = 0.02
# Median of |x| over standard deviation, for normal x.
MEDIAN_TO_DEVIATION = 1.4826
# Fewer edges or points than this fix no camera.
LEAST_EDGES = 6
LEAST_POINTS = 40


@dataclass(frozen=True)
class Picked:
    """Points of the scene (n, 3) picked in the photograph at pixels (n, 2) with a deviation of `sigma_px`."""

    points: np.ndarray
    pixels: np.ndarray
    sigma_px: float = PICKING_PX


@dataclass(frozen=True)
class Refined:
    """A refined camera, its parameters with their covariance, the deviation of its edges in pixels, the offsets left at it,
    and how many points on edges could have been found."""

    camera: object
    values: np.ndarray
    covariance: np.ndarray
    edge_px: float
    left: Offsets
    candidates: int


def edge_weights(edges):
    """The weight (n,) of each point, given its edge, so that an edge counts at most PER_EDGE observations."""
    _, place, counts = np.unique(edges, return_inverse=True, return_counts=True)
    return np.sqrt(np.minimum(1.0, PER_EDGE / counts))[place]


def deviation_of_edges(residuals, weights):
    """The standard deviation of edges from the scene: the weighted median of the offsets' size, scaled to normal ones; pixels."""
    order = np.argsort(np.abs(residuals))
    run = np.cumsum(weights[order] ** 2)
    middle = np.abs(residuals)[order][np.searchsorted(run, run[-1] / 2)]
    return max(MEDIAN_TO_DEVIATION * float(middle), LEAST_EDGE_PX)


def solve(measured, picked, frame, values, edge_px):
    """The most probable parameters, and their covariance, for edges of a deviation `edge_px`."""
    base = (measured.pixels * measured.normals).sum(axis=1) + measured.offsets
    weights = edge_weights(measured.edges)

    def edge_residuals(parameters):
        return (frame.camera(parameters).project(measured.points) * measured.normals).sum(axis=1) - base

    def residuals(parameters):
        at_points = (frame.camera(parameters).project(picked.points) - picked.pixels).ravel() / picked.sigma_px
        return np.concatenate([weights * edge_residuals(parameters) / edge_px, at_points])

    # The loss sets in at a residual of one point; soft L1 weighs larger ones down.
    solution = optimize.least_squares(residuals, values, x_scale=np.maximum(np.abs(values), 1.0), loss="soft_l1", f_scale=1.5, xtol=1e-12, ftol=1e-12)
    covariance = np.linalg.inv(solution.jac.T @ solution.jac)
    return solution.x, covariance, deviation_of_edges(edge_residuals(solution.x), weights)


def refine(layout, frame, free, picked, photo, render, render_camera, place):
    """The camera of `layout` refined on pictures as `grey` makes them; `free` counts the parameters.

    `InputError` at `place` where too few edges match.
    """
    camera, edge_px = layout.camera, EDGE_PX
    for search in SEARCH_PX:
        measured, candidates = measure_offsets(layout.seen_by(camera), photo, render, render_camera, search)
        if len(measured.offsets) < LEAST_POINTS or len(np.unique(measured.edges)) < LEAST_EDGES:
            raise InputError(place, f"only {len(measured.offsets)} of {len(candidates.edges)} points on the scene's edges are found in the photograph", "give the photograph of this case, or fit the pose again (fit-pose)")
        values, covariance, edge_px = solve(measured, picked, frame, frame.parameters(camera)[:free], edge_px)
        camera = frame.camera(values)
    left, candidates = measure_offsets(layout.seen_by(camera), photo, render, render_camera, SEARCH_PX[-1])
    return Refined(camera, values, covariance, edge_px, left, len(candidates.edges))
