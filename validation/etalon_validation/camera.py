"""A pinhole camera with square pixels: points to pixels and pixels to rays.

Pixel coordinates start at the top left corner of the image; the centre of the
first pixel is (0.5, 0.5). The image's right is look x up, as in a right-handed
world seen from inside.
"""

from dataclasses import dataclass

import numpy as np


def unit(vector):
    """`vector` scaled to length one."""
    vector = np.asarray(vector, dtype=float)
    return vector / np.linalg.norm(vector)


@dataclass(frozen=True)
class Pinhole:
    """Where the camera stands, how it is turned, and its focal length in pixels."""

    position: np.ndarray
    look: np.ndarray
    up: np.ndarray
    focal_px: float
    centre_px: tuple
    size: tuple

    @classmethod
    def looking(cls, position, look, up, hfov_deg, size, centre_shift_px=(0.0, 0.0)):
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
        return cls(np.asarray(position, float), look, np.cross(right, look), focal_px, centre, tuple(size))

    @property
    def right(self):
        """The direction in which u grows."""
        return np.cross(self.look, self.up)

    @property
    def hfov_deg(self):
        """Horizontal field of view of the whole image, degrees."""
        return float(2 * np.degrees(np.arctan(self.size[0] / 2 / self.focal_px)))

    def project(self, points):
        """Pixel coordinates (n, 2) of world points (n, 3) in front of the camera."""
        offset = np.atleast_2d(np.asarray(points, float)) - self.position
        depth = offset @ self.look
        u = self.centre_px[0] + self.focal_px * (offset @ self.right) / depth
        v = self.centre_px[1] - self.focal_px * (offset @ self.up) / depth
        return np.stack([u, v], axis=1)

    def rays(self, pixels):
        """Unit directions (n, 3) through pixel coordinates (n, 2)."""
        pixels = np.atleast_2d(np.asarray(pixels, float))
        x = (pixels[:, 0] - self.centre_px[0]) / self.focal_px
        y = (self.centre_px[1] - pixels[:, 1]) / self.focal_px
        rays = self.look + x[:, None] * self.right + y[:, None] * self.up
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
