"""What nobody measured about a lamp and a camera, as a model with few parameters and its fit.

A photograph's values are modelled as

    value = tone(M (glare(sum_k w_k B_k))),   tone(x) = x^gamma,   glare(x) = (1 - s) x + s mean(x)

with B_k the picture that the lamp makes with the k-th basis function of its profile.
The exposure is always fitted (w's scale); everything else only when it is named, so that
what each unknown buys can be seen. M has 1 for green from green: scale belongs to w.

A picture shows few colours, and three channels cannot be told apart by two: entries of M
off its diagonal are expected within 0.1, as on the ladder, or colours that the fitted
picture does not show would be predicted by mixtures that only its own colours had to suit.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from .ladder import EXPECTED_MIXTURE

NAMES = {
    "gains": "channel gains",
    "matrix": "3x3 matrix",
    "glare": "veiling glare",
    "tone": "tone exponent",
    "lamp": "lamp profile",
}
# Exponents of display encodings and their inverses lie well within.
TONE_BOUNDS = (0.2, 3.0)
# A photograph with more veiling glare than this shows nothing.
GLARE_BOUNDS = (0.0, 0.5)
# The least squares start from a linear photograph and from a display-encoded one: the better end is taken.
TONE_STARTS = (1.0, 0.6)
GREEN = 4


@dataclass(frozen=True)
class Model:
    """Which unknowns are fitted, and their values: weights (k,), matrix (3, 3), glare share, exponent."""

    unknowns: tuple
    weights: np.ndarray
    matrix: np.ndarray
    glare: float
    exponent: float
    parameters: int

    def predict(self, basis, mean):
        """The photograph's values (..., 3) that basis pictures (k, ..., 3) stand for, their means over the picture (k, 3)."""
        light, mean = (np.tensordot(self.weights, part, axes=1) for part in (basis, mean))
        seen = ((1 - self.glare) * light + self.glare * mean) @ self.matrix.T
        return np.sign(seen) * np.abs(seen) ** self.exponent


class Vector:
    """Packs a model's free numbers into one vector and back."""

    def __init__(self, unknowns, count):
        self.unknowns, self.count = tuple(unknowns), count
        self.weights = count if "lamp" in unknowns else 1
        self.colours = 8 if "matrix" in unknowns else 2 if "gains" in unknowns else 0
        self.size = self.weights + self.colours + ("glare" in unknowns) + ("tone" in unknowns)

    def model(self, numbers):
        """The model that a vector stands for."""
        weights = np.zeros(self.count)
        weights[: self.weights] = numbers[: self.weights]
        rest = list(numbers[self.weights :])
        matrix = np.eye(3)
        if self.colours == 2:
            matrix[0, 0], matrix[2, 2] = rest[:2]
        elif self.colours == 8:
            matrix = np.insert(rest[:8], GREEN, 1.0).reshape(3, 3)
        rest = rest[self.colours :]
        glare = rest.pop(0) if "glare" in self.unknowns else 0.0
        exponent = rest.pop(0) if "tone" in self.unknowns else 1.0
        return Model(self.unknowns, weights, matrix, float(glare), float(exponent), self.size)

    def start(self, basis, photo, exponent):
        """A vector to begin with, and bounds: the exposure that suits the mean, no mixture."""
        exposure = (photo.mean() ** (1 / exponent)) / basis[0].mean()
        numbers = [exposure] + [0.0] * (self.weights - 1)
        numbers += list(np.delete(np.eye(3).ravel(), GREEN)) if self.colours == 8 else [1.0] * self.colours
        low, high = [-np.inf] * len(numbers), [np.inf] * len(numbers)
        if "glare" in self.unknowns:
            numbers, low, high = numbers + [0.01], low + [GLARE_BOUNDS[0]], high + [GLARE_BOUNDS[1]]
        if "tone" in self.unknowns:
            numbers, low, high = numbers + [exponent], low + [TONE_BOUNDS[0]], high + [TONE_BOUNDS[1]]
        return np.array(numbers), (np.array(low), np.array(high))


def fit(unknowns, basis, photo, independent, mean):
    """The most probable model for values (n, 3), from basis values (k, n, 3) of pictures with these means (k, 3).

    `independent` is how many of the n values err by themselves: neighbours share what is wrong
    with the scene, and would outvote what is expected of the matrix by their number.
    """
    if "matrix" not in unknowns:
        return least(unknowns, basis, photo, mean, 0.0)
    free = least(unknowns, basis, photo, mean, 0.0)
    freedom = max(3 * independent - free.parameters, 1)
    deviation = np.sqrt(((free.predict(basis, mean) - photo) ** 2).mean() * 3 * independent / freedom)
    return least(unknowns, basis, photo, mean, deviation / EXPECTED_MIXTURE * np.sqrt(len(photo) / independent))


def least(unknowns, basis, photo, mean, stiffness):
    """The model of least squares, entries off the matrix's diagonal weighted with `stiffness`."""
    vector = Vector(unknowns, len(basis))

    def residuals(numbers):
        model = vector.model(numbers)
        misses = (model.predict(basis, mean) - photo).ravel()
        if not stiffness:
            return misses
        # In units of the row's gain, as the ladder has it.
        mixture = model.matrix / np.maximum(np.abs(np.diag(model.matrix)), 1e-3)[:, None]
        return np.append(misses, stiffness * mixture[~np.eye(3, dtype=bool)])

    best = None
    for exponent in TONE_STARTS if "tone" in unknowns else (1.0,):
        start, bounds = vector.start(basis, photo, exponent)
        scale = np.where(start == 0, max(abs(start[0]), 1.0), np.abs(start))
        found = least_squares(residuals, start, bounds=bounds, x_scale=scale, xtol=1e-10, ftol=1e-10, max_nfev=400)
        if best is None or found.cost < best.cost:
            best = found
    return vector.model(best.x)


def nrmse(predicted, photo):
    """Root mean squared error over the photograph's mean value."""
    return float(np.sqrt(((predicted - photo) ** 2).mean()) / photo.mean())
