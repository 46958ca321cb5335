"""A photograph made from a render, with everything known that a camera does to it.

The picture's three channels (X, Y, Z over the saturation luminance) are scaled
by exposure and white-balance gains, darkened towards the corners by cos^4,
counted as electrons with shot and read noise, and quantised over a black level.
"""

from dataclasses import dataclass

import numpy as np

from .lens import grid
from .photograph import LINEAR, Photograph


@dataclass(frozen=True)
class Sensor:
    """The known camera: exposure in stops, gains of the three channels relative to the second, and its electronics."""

    exposure_stops: float = -0.37
    gains: tuple = (0.82, 1.0, 0.64)
    full_well_e: float = 40000.0
    read_noise_e: float = 6.0
    black: int = 512
    bits: int = 14


def cos4(camera):
    """Relative illuminance (h, w, 1) of natural vignetting for a pinhole."""
    radius = np.linalg.norm(camera.straightened(grid(camera.size)), axis=1)
    return (1 / (1 + radius**2) ** 2).reshape(camera.size[1], camera.size[0], 1)


def photographed(channels, camera, sensor, generator):
    """The photograph of linear channels (h, w, 3), 1 at saturation, by a camera with noise from `generator`."""
    light = np.clip(channels, 0, None) * 2**sensor.exposure_stops * np.asarray(sensor.gains) * cos4(camera)
    electrons = generator.poisson(np.minimum(light, 2) * sensor.full_well_e) + sensor.read_noise_e * generator.standard_normal(light.shape)
    white = 2**sensor.bits - 1
    counts = np.clip(np.round(sensor.black + electrons / sensor.full_well_e * (white - sensor.black)), 0, white)
    return Photograph((counts - sensor.black) / (white - sensor.black), "synthetic", "", LINEAR, (counts >= white).any(axis=2))
