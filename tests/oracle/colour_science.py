"""Colorimetry of the measured curves by colour-science, for the Rust tests to compare against.

    python tests/oracle/colour_science.py           write colour_science.json beside this file
    python tests/oracle/colour_science.py --check   exit 1 when it differs by more than rounding

Needs `spectra/requirements.txt`. Reads the same `spectra/*/*.csv` as the renderer and never the renderer.
"""

import argparse
import json
import sys
import warnings
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
SPECTRA = HERE.parents[1] / "spectra"
sys.path.insert(0, str(SPECTRA))

from csv_format import parse  # noqa: E402

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # colour-science warns about optional packages that nothing here uses
    import colour

CONVENTIONS = {
    "library": f"colour-science {colour.__version__}",
    "integration": "every curve linearly interpolated onto 360-830 nm by 1 nm, then plain sums",
    "outside_the_table": "emission and illuminant zero; reflectance holds its end values",
    "observer": "CIE 1931 2 degree",
    "cct_k": "nearest blackbody in CIE 1960 uv, minimised over the same sums, c2 of the SI of 2019; "
    "duv is positive above the locus",
    "cct_ohno2013_k": "colour.temperature.uv_to_CCT_Ohno2013 as it comes: c2 = 1.4388e-2 m K",
    "luminous_efficacy_lm_per_w": "683 sum(y S) / sum(S), both over 360-830 nm",
    "luminance_cd_per_m2": "683 sum(y S) of curves tabulated in W sr-1 m-2 nm-1, and of blackbodies",
    "covered_share_of_luminous_weight": "sum of y over the 1 nm samples inside the table / sum of y over 360-830 nm",
    "lab": "CIELAB 1976, reference white is the light itself",
    "index": "tables linear between samples; F, d, C = 486.1327, 587.5618, 656.2725 nm",
}

FIRST_NM, LAST_NM = 360, 830
WAVELENGTHS_NM = np.arange(FIRST_NM, LAST_NM + 1, dtype=float)
OBSERVER = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"]

# SI of 2019, exact.
PLANCK_J_S, LIGHT_M_PER_S, BOLTZMANN_J_PER_K = 6.62607015e-34, 299792458.0, 1.380649e-23
C1_W_M2 = 2 * np.pi * PLANCK_J_S * LIGHT_M_PER_S**2
C2_M_K = PLANCK_J_S * LIGHT_M_PER_S / BOLTZMANN_J_PER_K

MAXIMUM_EFFICACY_LM_PER_W = 683.0
SCENE_LIGHT = "cornell-lamp"
PATCHES = ["cornell-white", "cornell-green", "cornell-red", "cornell-lamp-plate", "colorchecker-neutral-5"]
METAL_WAVELENGTHS_NM = (450, 550, 650)
FRAUNHOFER_NM = {"f": 486.1327, "d": 587.5618, "c": 656.2725}
# Digits that the tests need; more would only differ from machine to machine. Below the floor is rounding noise.
SIGNIFICANT_DIGITS = 12
NOISE_FLOOR = 1e-12


def curves_of(*kinds):
    """Name -> curve set of every file of these kinds."""
    files = (file for kind in kinds for file in sorted((SPECTRA / kind).glob("*.csv")))
    return {file.stem: parse(file.read_text(), f"{file.parent.name}/{file.name}") for file in files}


def linear(curve, column=1, outside=None):
    """A curve as a function of wavelength in nanometres; `outside` None holds the end values."""
    rows = np.asarray(curve.rows)
    interpolator = colour.LinearInterpolator(rows[:, 0], rows[:, column])
    return colour.Extrapolator(interpolator, method="Constant", left=outside, right=outside)


def tristimulus(power):
    """XYZ as plain sums over 1 nm."""
    distribution = colour.SpectralDistribution(power, WAVELENGTHS_NM)
    return colour.sd_to_XYZ(distribution, OBSERVER, k=1, method="Integration")


def blackbody_power(temperature_k):
    """Spectral radiance in W sr-1 m-2 nm-1."""
    return colour.colorimetry.planck_law(WAVELENGTHS_NM * 1e-9, temperature_k, C1_W_M2, C2_M_K) * 1e-9


def uv_of(xyz):
    return colour.UCS_to_uv(colour.XYZ_to_UCS(xyz))


def nearest_blackbody(uv):
    """CCT in kelvin and signed distance to the locus, by golden section in reciprocal temperature."""

    def distance(mired):
        return np.linalg.norm(uv - uv_of(tristimulus(blackbody_power(1e6 / mired))))

    mireds = np.linspace(20, 1000, 246)
    best = mireds[np.argmin([distance(mired) for mired in mireds])]
    low, high = best - 8, best + 8
    golden = (np.sqrt(5) - 1) / 2
    while high - low > 1e-7:
        left, right = high - golden * (high - low), low + golden * (high - low)
        low, high = (low, right) if distance(left) < distance(right) else (left, high)
    mired = (low + high) / 2
    nearest = uv_of(tristimulus(blackbody_power(1e6 / mired)))
    return 1e6 / mired, np.copysign(np.linalg.norm(uv - nearest), uv[1] - nearest[1])


def ratios(xyz):
    x, y = colour.XYZ_to_xy(xyz)
    return {
        "chromaticity_x": x,
        "chromaticity_y": y,
        "tristimulus_x_over_y": xyz[0] / xyz[1],
        "tristimulus_z_over_y": xyz[2] / xyz[1],
    }


def light(curve):
    """Everything said about one illuminant or lamp."""
    power = linear(curve, outside=0)(WAVELENGTHS_NM)
    xyz = tristimulus(power)
    cct_k, duv = nearest_blackbody(uv_of(xyz))
    ohno_cct_k, ohno_duv = colour.temperature.uv_to_CCT_Ohno2013(uv_of(xyz))
    said = ratios(xyz) | {
        "cct_k": cct_k,
        "duv": duv,
        "cct_ohno2013_k": ohno_cct_k,
        "duv_ohno2013": ohno_duv,
        "luminous_efficacy_lm_per_w": MAXIMUM_EFFICACY_LM_PER_W * xyz[1] / power.sum(),
    }
    if curve.header["unit"].startswith("W sr-1 m-2 nm-1"):
        said["luminance_cd_per_m2"] = MAXIMUM_EFFICACY_LM_PER_W * xyz[1]
    return said


def blackbody(temperature_k):
    power = blackbody_power(temperature_k)
    xyz = tristimulus(power)
    return {
        "temperature_k": temperature_k,
        **ratios(xyz),
        "luminous_efficacy_lm_per_w": MAXIMUM_EFFICACY_LM_PER_W * xyz[1] / power.sum(),
        "luminance_cd_per_m2": MAXIMUM_EFFICACY_LM_PER_W * xyz[1],
    }


def patches():
    """Colours of surfaces under the Cornell lamp, the perfect diffuser being Y = 100."""
    power = linear(curves_of("emission")[SCENE_LIGHT], outside=0)(WAVELENGTHS_NM)
    white = tristimulus(power)
    reflectances = {name: linear(curves_of("reflectance")[name])(WAVELENGTHS_NM) for name in PATCHES}
    reflectances["perfect-diffuser"] = np.ones_like(WAVELENGTHS_NM)
    said = {}
    for name, reflectance in reflectances.items():
        relative = tristimulus(power * reflectance) / white[1]
        lab = colour.XYZ_to_Lab(relative, colour.XYZ_to_xy(white))
        said[name] = {"xyz_diffuser_y_100": list(100 * relative), "lab": list(lab)}
    return said


def metal(curve):
    n, k = linear(curve, 1), linear(curve, 2)
    return {f"n_k_at_{nm}_nm": [float(n(nm)), float(k(nm))] for nm in METAL_WAVELENGTHS_NM}


def glass(curve):
    """Index at F, d, C and the Abbe number."""
    if curve.quantity == "sellmeier":

        def index(nm):
            l2 = (nm * 1e-3) ** 2
            return np.sqrt(1 + sum(b * l2 / (l2 - c) for b, c in curve.rows))
    else:
        index = linear(curve)
    n = {line: float(index(nm)) for line, nm in FRAUNHOFER_NM.items()}
    return {f"n_{line}": value for line, value in n.items()} | {"abbe_number": (n["d"] - 1) / (n["f"] - n["c"])}


def covered_share(first_nm, last_nm):
    y = OBSERVER.values[:, 1]
    return y[(WAVELENGTHS_NM >= first_nm) & (WAVELENGTHS_NM <= last_nm)].sum() / y.sum()


def rounded(value):
    """Numbers at the stated digits, through lists and dictionaries."""
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [rounded(inner) for inner in value]
    if isinstance(value, (str, int)):
        return value
    return 0.0 if abs(value) < NOISE_FLOOR else float(f"{float(value):.{SIGNIFICANT_DIGITS}g}")


def everything():
    tables = curves_of("illuminant", "emission", "reflectance", "transmission", "sensitivity")
    return rounded(
        {
            "conventions": CONVENTIONS,
            "observer_sums_360_830_nm": dict(zip("xyz", OBSERVER.values.sum(axis=0))),
            "share_of_luminous_weight_380_780_nm": covered_share(380, 780),
            "lights": {name: light(curve) for name, curve in curves_of("illuminant", "emission").items()},
            "blackbodies": [blackbody(temperature_k) for temperature_k in range(1000, 20001, 500)],
            f"patches_under_{SCENE_LIGHT.replace('-', '_')}": patches(),
            "metals": {name: metal(curve) for name, curve in curves_of("metal").items()},
            "glasses": {name: glass(curve) for name, curve in curves_of("glass").items()},
            "covered_share_of_luminous_weight": {
                name: covered_share(*curve.range_nm()) for name, curve in tables.items()
            },
        }
    )


def same(ours, theirs):
    """Equal but for the last digits, which differ between processors."""
    if isinstance(ours, dict):
        return ours.keys() == theirs.keys() and all(same(ours[key], theirs[key]) for key in ours)
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))
    return ours == theirs if isinstance(ours, str) else bool(np.isclose(ours, theirs, rtol=1e-8, atol=1e-10))


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--check", action="store_true", help="write nothing; exit 1 when the figures differ")
    figures = everything()
    file = HERE / "colour_science.json"
    if arguments.parse_args().check:
        sys.exit("colour_science.json differs" if not same(figures, json.loads(file.read_text())) else 0)
    file.write_text(json.dumps(figures, indent=1) + "\n")


if __name__ == "__main__":
    main()
