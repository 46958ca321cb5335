"""What a renderer of three channels makes of spectra: luminance in three bands of wavelengths.

The channels of such a renderer are three numbers that never mix, whatever their
names, so they may be luminance in any three bands, and bands that do not
overlap say most about light that is reflected often. A reflectance in a band is
the share of the lamps' luminance in it that is given back: exact for light
reflected once, while each further reflection changes the spectrum within a band
in truth, but not here. Colour is lost; pictures are judged by luminance.

Channels are divided by the renderer's weights of red, green and blue, the
longest wavelengths first, so that what it takes for luminance, as in mutating
its paths, is luminance.
"""

from dataclasses import dataclass

import numpy as np

from .peer_scene import EFFICACY

# Of all bands, by steps of 10 nm, those that are nearly the best for light reflected twice and three times
# among the colours of the ColorChecker and of Cornell's box under its lamp and black bodies of 4000 and 6500 K:
# the luminance of such light is 0.17 to 0.28 off (rms over the pairs), 0.40 to 0.81 with X, Y and Z as channels
# and 0.53 to 1.80 with the primaries of sRGB.
CUTS_NM = (540.0, 600.0)
# Luminance of red, green and blue in the renderer.
WEIGHTS = np.array([0.212671, 0.715160, 0.072169])


@dataclass(frozen=True)
class Bands:
    """Wavelengths in nm, the observer's luminance function in each channel (3, n), and the spectral flux of the lamps."""

    nm: np.ndarray
    functions: np.ndarray
    light: np.ndarray

    def radiance(self, table):
        """Channels of a spectral radiance, whose weighted sum is cd/m2."""
        return EFFICACY * self.luminances(table.at(self.nm)) / WEIGHTS

    def share(self, values):
        """The share of the lamps' luminance in each band that a reflectance, by wavelength, gives back."""
        return self.luminances(values * self.light) / self.luminances(self.light)

    def luminances(self, values):
        """The integrals with the luminance function, channel by channel."""
        return np.trapezoid(values * self.functions, self.nm, axis=1)


def bands_of(scene, observer):
    """The `Bands` of a scene for the CIE 1931 observer (wavelength and its three functions in columns).

    A scene without lamps is dark, under light that is even.
    """
    nm = observer[:, 0]
    light = sum((thing.radiance.at(nm) * thing.shape.area for thing in scene.things if thing.radiance is not None), np.zeros(len(nm)))
    short, long = (nm < CUTS_NM[0]), (nm >= CUTS_NM[1])
    functions = np.stack([long, ~short & ~long, short]) * observer[:, 2]
    bands = Bands(nm, functions, light)
    return bands if (bands.luminances(light) > 0).all() else Bands(nm, functions, np.ones(len(nm)))


def luminance(pixels):
    """Luminance in cd/m2 of channels along the last axis."""
    return pixels @ WEIGHTS


def normal_reflectance(n, k):
    """Reflectance of a metal of index n - ik at normal incidence."""
    return ((n - 1) ** 2 + k**2) / ((n + 1) ** 2 + k**2)
