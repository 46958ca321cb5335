"""Spectra of a scene file as tables that any renderer can take.

A table is linear between its samples; beyond its ends a reflectance or an index
goes on as it ended, and light is zero. Levels of lamps become spectral radiance
here, with the CIE 1931 observer times 683 lm/W on the observer's 1 nm grid, so
that no peer needs photometry of its own.
"""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .errors import InputError, need

# Luminous efficacy of monochromatic light at 540 THz, lm/W.
EFFICACY = 683.0
FIRST_NM, LAST_NM = 360.0, 830.0
# Step of the tables of black bodies, which bend slowly.
STEP_NM = 5.0
# Second radiation constant in nm K (SI 2019).
C2_NM_K = 1.438776877e7
# The sodium D lines, for which the index of a glass is commonly given.
INDEX_NM = 589.3


@dataclass(frozen=True)
class Table:
    """A spectrum: rising wavelengths in nm and a value at each. `holds`: whether it goes on beyond its ends, else zero."""

    nm: tuple
    values: tuple
    holds: bool = True

    def at(self, nm):
        """Values at wavelengths in nm."""
        ends = {} if self.holds else {"left": 0.0, "right": 0.0}
        return np.interp(nm, self.nm, self.values, **ends)

    def scaled(self, factor):
        """The table times a factor."""
        return Table(self.nm, tuple(float(factor) * value for value in self.values), self.holds)


def table(nm, values, holds=True):
    """A `Table` of anything that numpy takes."""
    return Table(tuple(np.asarray(nm, float).tolist()), tuple(np.asarray(values, float).tolist()), holds)


def read_columns(path):
    """The numbers of a spectral table (n, columns), comments and header left out."""
    path = Path(path)
    try:
        lines = [line for line in path.read_text(encoding="utf-8").splitlines() if line and not line.startswith("#")]
        return np.array([[float(cell) for cell in row] for row in csv.reader(lines[1:])])
    except OSError as error:
        raise InputError(path, f"cannot be read ({error.strerror})", "name a table of the spectra folder") from None
    except ValueError as error:
        raise InputError(path, f"not a table of numbers ({error})", "correct it") from None


class Spectra:
    """Spectral tables by name, as the scene file refers to them; `own` are those of the scene itself."""

    def __init__(self, folder, own=None):
        self.folder = Path(folder)
        self.own = own or {}
        self.observer = read_columns(self.folder / "observer" / "cie-1931-2deg.csv")

    def of_scene(self, scene):
        """The same with the spectra that a scene file brings."""
        return Spectra(self.folder, scene.get("spectra"))

    def table(self, spectrum, place, holds=True):
        """A number, a name or a description as a `Table`."""
        if isinstance(spectrum, (int, float)):
            return table([FIRST_NM, LAST_NM], np.full(2, spectrum), holds)
        if isinstance(spectrum, str) and spectrum in self.own:
            return self.table(self.own[spectrum], place, holds)
        if isinstance(spectrum, dict) and "table" in spectrum:
            return table(spectrum["table"]["wavelengths_nm"], spectrum["table"]["values"], holds)
        if isinstance(spectrum, dict) and "blackbody" in spectrum:
            return black_body(spectrum["blackbody"]["temperature_k"])
        if isinstance(spectrum, dict) and "scaled" in spectrum:
            return self.table(spectrum["scaled"]["spectrum"], place, holds).scaled(spectrum["scaled"]["factor"])
        found = self.named(spectrum)
        if found is None or found.parent.name == "line":
            raise InputError(place, f"spectrum {spectrum!r} is not understood by the peers", "give a number, a table, a black body or a name of the spectra folder")
        columns = read_columns(found)
        return table(columns[:, 0], columns[:, 1], holds)

    def named(self, name, kind="*"):
        """The file of a built-in table, or `None`."""
        found = sorted(self.folder.glob(f"{kind}/{name}.csv")) if isinstance(name, str) else []
        return found[0] if found else None

    def metal(self, metal, place):
        """Tables of n and k of a built-in metal, or of the description `table`."""
        if isinstance(metal, dict) and "table" in metal:
            nm = metal["table"]["wavelengths_nm"]
            return table(nm, metal["table"]["n"]), table(nm, metal["table"]["k"])
        found = self.named(metal, "metal")
        if found is None:
            raise InputError(place, f"metal {metal!r} is not understood by the peers", "name one of the spectra folder")
        columns = read_columns(found)
        return table(columns[:, 0], columns[:, 1]), table(columns[:, 0], columns[:, 2])

    def index(self, index, place):
        """The refractive index of a glass at 589.3 nm."""
        if isinstance(index, (int, float)):
            return float(index)
        if isinstance(index, dict):
            return described_index(index, place)
        found = self.named(index, "glass")
        if found is None:
            raise InputError(place, f"index {index!r} is not understood by the peers", "give a number or a name of the spectra folder")
        columns = read_columns(found)
        # Most glasses are kept as coefficients of Sellmeier's formula, which are not in the hundreds.
        return sellmeier(*columns.T) if columns[0, 0] < 100 else float(np.interp(INDEX_NM, columns[:, 0], columns[:, 1]))

    def luminance(self, spectrum):
        """Luminance in cd/m2 of a table of spectral radiance in W sr^-1 m^-2 nm^-1, on the observer's 1 nm grid."""
        grid = self.observer[:, 0]
        return EFFICACY * float(np.trapezoid(spectrum.at(grid) * self.observer[:, 2], grid))

    def radiance(self, emission, area_m2, place):
        """Spectral radiance of a lamp with this shining area, absolute."""
        shape = self.table(need(emission, "spectrum", place), place, holds=False)
        level = need(emission, "level", place)
        if emission.get("two_sided"):
            raise InputError(place, "two-sided lamps are not understood by the peers", "use a one-sided lamp")
        return shape.scaled(self.factor(level, shape, area_m2, place))

    def factor(self, level, shape, area_m2, place):
        """What the shape of a lamp's spectrum is to be multiplied by."""
        if "spectral_radiance_factor" in level:
            return level["spectral_radiance_factor"]
        if "luminance_cd_m2" in level:
            return level["luminance_cd_m2"] / self.luminance(shape)
        if "flux_lm" in level:
            flux_lm = level["flux_lm"]
        elif "electrical_power" in level:
            flux_lm = level["electrical_power"]["power_w"] * level["electrical_power"]["efficacy_lm_per_w"]
        else:
            raise InputError(place, f"level {sorted(level)} is not understood by the peers", "give luminance_cd_m2, flux_lm, electrical_power or spectral_radiance_factor")
        return flux_lm / (np.pi * area_m2) / self.luminance(shape)


def black_body(temperature_k):
    """The shape of Planck's law, 1 at 560 nm."""
    nm = np.arange(FIRST_NM, LAST_NM + STEP_NM, STEP_NM)
    planck = nm**-5.0 / np.expm1(C2_NM_K / (nm * temperature_k))
    return table(nm, planck / (560.0**-5 / np.expm1(C2_NM_K / (560.0 * temperature_k))), holds=False)


def sellmeier(b, c_um2):
    """The index at 589.3 nm by coefficients of Sellmeier's formula."""
    um2 = (INDEX_NM * 1e-3) ** 2
    return float(np.sqrt(1 + np.sum(np.asarray(b, float) * um2 / (um2 - np.asarray(c_um2, float)))))


def described_index(index, place):
    """The index at 589.3 nm by a dispersion formula or a table."""
    if "cauchy" in index:
        return index["cauchy"]["a"] + index["cauchy"]["b_um2"] / (INDEX_NM * 1e-3) ** 2
    if "sellmeier" in index:
        return sellmeier(index["sellmeier"]["b"], index["sellmeier"]["c_um2"])
    if "table" in index:
        return float(np.interp(INDEX_NM, index["table"]["wavelengths_nm"], index["table"]["n"]))
    raise InputError(place, f"index {sorted(index)} is not understood by the peers", "give a number, cauchy, sellmeier or a table")
