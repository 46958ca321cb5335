"""A pinhole camera with square pixels and one term of radial distortion.

Lengths in the image plane are in focal lengths; a point at the distance r from
the axis appears at r (1 + k1 r^2). Pixel coordinates start at the top left corner of the image; the centre of the
first pixel is (0.5, 0.5). The image's right is look x up, as in a right-handed
world seen from inside.
"""

from dataclasses import dataclass, replace

import numpy as np


def unit(vector):
    """`vector` scaled to length one."""
    vector = np.asarray(vector, dtype=float)
    return vector / np.linalg.norm(vector)


@dataclass(frozen=True)
class Pinhole:
    """Where the camera stands, how it is turned, its focal length in pixels, and its distortion k1."""

    position: np.ndarray
    look: np.ndarray
    up: np.ndarray
    focal_px: float
    centre_px: tuple
    size: tuple
    k1: float = 0.0

    @classmethod
    def looking(cls, position, look, up, hfov_deg, size, centre_shift_px=(0.0, 0.0), k1=0.0):
        """A camera from its horizontal field of view; `size` is (width, height).

        `ValueError` when the numbers describe no camera.
        """
        vectors = [np.array(vector, float) for vector in (position, look, up)]
        if any(vector.shape != (3,) or not np.isfinite(vector).all() for vector in vectors):
            raise ValueError("position, look and up need three numbers each")
        if not 0 < hfov_deg < 180 or min(size) < 1 or np.linalg.norm(np.cross(vectors[1], vectors[2])) < 1e-9:
            raise ValueError("field of view, image size, or look along up")
        width, height = size
        focal_px = width / 2 / np.tan(np.radians(hfov_deg) / 2)
        look = unit(look)
        right = unit(np.cross(look, up))
        centre = (width / 2 + centre_shift_px[0], height / 2 + centre_shift_px[1])
        return cls(np.asarray(position, float), look, np.cross(right, look), focal_px, centre, tuple(size), float(k1))

    @property
    def right(self):
        """The direction in which u grows."""
        return np.cross(self.look, self.up)

    @property
    def hfov_deg(self):
        """Horizontal field of view of the whole image, degrees."""
        return float(2 * np.degrees(np.arctan(self.size[0] / 2 / self.focal_px)))

    @property
    def undistorted(self):
        """The same camera without radial distortion."""
        return replace(self, k1=0.0)

    def resized(self, size):
        """The same view in an image of another `size` (width, height); scaled by the width."""
        scale = size[0] / self.size[0]
        shift = [scale * (centre - side / 2) for centre, side in zip(self.centre_px, self.size)]
        centre = (size[0] / 2 + shift[0], size[1] / 2 + shift[1])
        return replace(self, focal_px=scale * self.focal_px, centre_px=centre, size=tuple(size))

    def depth(self, points):
        """Distance of world points (n, 3) along the axis; negative behind the camera."""
        return (np.atleast_2d(np.asarray(points, float)) - self.position) @ self.look

    def project(self, points):
        """Pixel coordinates (n, 2) of world points (n, 3) in front of the camera."""
        offset = np.atleast_2d(np.asarray(points, float)) - self.position
        plane = np.stack([offset @ self.right, -(offset @ self.up)], axis=1) / (offset @ self.look)[:, None]
        bent = plane * (1 + self.k1 * (plane**2).sum(axis=1, keepdims=True))
        return np.asarray(self.centre_px) + self.focal_px * bent

    def straightened(self, pixels):
        """Where pixels (n, 2) would lie without distortion, in focal lengths right and down of the axis."""
        bent = (np.atleast_2d(np.asarray(pixels, float)) - self.centre_px) / self.focal_px
        if self.k1 == 0:
            return bent
        plane, radius = bent.copy(), np.linalg.norm(bent, axis=1)
        true = radius.copy()
        # Newton's method on true (1 + k1 true^2) = radius; eight steps reach rounding for |k1 r^2| below 0.2.
        for _ in range(8):
            true = true - (true * (1 + self.k1 * true**2) - radius) / (1 + 3 * self.k1 * true**2)
        within = radius > 0
        plane[within] *= (true[within] / radius[within])[:, None]
        return plane

    def rays(self, pixels):
        """Unit directions (n, 3) through pixel coordinates (n, 2)."""
        x, y = self.straightened(pixels).T
        rays = self.look + x[:, None] * self.right - y[:, None] * self.up
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)


def turned(look, up, yaw, pitch, roll):
    """A level camera's look and up, turned by angles in radians.

    Positive yaw turns the view towards the image's right, positive pitch raises
    it, positive roll turns the camera clockwise as seen from behind it.
    """
    right = unit(np.cross(look, up))
    up = np.cross(right, unit(look))
    level, across = np.cos(yaw) * unit(look) + np.sin(yaw) * right, np.cos(yaw) * right - np.sin(yaw) * unit(look)
    aimed, upright = np.cos(pitch) * level + np.sin(pitch) * up, np.cos(pitch) * up - np.sin(pitch) * level
    return aimed, np.cos(roll) * upright + np.sin(roll) * across
