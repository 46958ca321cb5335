"""Writes every curve set of this folder that can be written by a command, and the provenance table.

    python spectra/export.py            write the CSV files and README.md
    python spectra/export.py --check    exit 1 when a file on disk differs or is unsound

Three origins: curves of colour-science (exported), tables in `by_hand` (entered from papers), and
measured tables whose CSV is itself the source (only validated). Needs `spectra/requirements.txt`.
"""

import argparse
import re
import sys
import warnings
from pathlib import Path

import numpy as np

from by_hand.glasses import SELLMEIER, TABULATED
from by_hand.lines import LINES
from by_hand.metals import METALS
from csv_format import Unsound, compose, parse
from readme import provenance_table

with warnings.catch_warnings():
    warnings.simplefilter("ignore")  # colour-science warns about optional packages that nothing here uses
    import colour

FOLDER = Path(__file__).resolve().parent
COLOUR_SCIENCE = "0.4.7"

OBSERVER = "CIE 1931 2 Degree Standard Observer"
# Column sums of the CIE table at 1 nm, 360-830 nm.
OBSERVER_SUMS = (106.86547, 106.85692, 106.89225)
OBSERVER_SUM_TOLERANCE = 1e-4

CIE_ILLUMINANTS = (
    ["A", "C", "E", "D50", "D55", "D65", "D75"]
    + [f"FL{i}" for i in range(1, 13)]
    + [f"HP{i}" for i in range(1, 6)]
    + [f"LED-B{i}" for i in range(1, 6)]
    + ["LED-BH1", "LED-RGB1", "LED-V1", "LED-V2"]
)
CAMERAS = {"nikon-5100": "Nikon 5100 (NPL)", "sigma-sdmerill": "Sigma SDMerill (NPL)"}
CAMERA_TITLES = {"nikon-5100": "Nikon D5100 camera", "sigma-sdmerill": "Sigma SD Merrill camera"}
COLOUR_CHECKER = "ISO 17321-1"


def number(value):
    """The shortest decimal text that reads back as the same float, never in exponent form."""
    return np.format_float_positional(float(value), trim="-")


def distribution_rows(distribution):
    """Rows of a colour-science spectral distribution, one or several columns."""
    columns = np.atleast_2d(np.asarray(distribution.values).T).T
    return [[number(nm), *map(number, row)] for nm, row in zip(distribution.wavelengths, columns)]


def exported(table, key):
    return f"colour-science {COLOUR_SCIENCE} {table}['{key}']"


def observer():
    """The one observer by which everything is judged."""
    header = {
        "title": "CIE 1931 2 degree standard observer",
        "quantity": "observer",
        "unit": "colour-matching functions, relative; y is the photopic luminous efficiency V",
        "source": f"CIE 1931 1 nm table as distributed by CVRL / {exported('MSDS_CMFS', OBSERVER)}",
        "conditions": "2 degree field; 1 nm",
    }
    yield "observer/cie-1931-2deg.csv", compose(header, distribution_rows(colour.MSDS_CMFS[OBSERVER]))


def illuminant_name(cie_name):
    """The name users write: single letters get a prefix, since `a` says nothing in a scene file."""
    return f"cie-{cie_name.lower()}" if len(cie_name) == 1 else cie_name.lower()


def illuminants():
    """The illuminants of CIE 015:2018."""
    for cie_name in CIE_ILLUMINANTS:
        standard = "standard illuminant" if cie_name in ("A", "D65") else "illuminant"
        header = {
            "title": f"CIE {standard} {cie_name}",
            "quantity": "illuminant",
            "unit": "relative power per nm",
            "source": f"CIE 015:2018 / {exported('SDS_ILLUMINANTS', cie_name)}",
            "conditions": "relative scale only",
        }
        rows = distribution_rows(colour.SDS_ILLUMINANTS[cie_name])
        yield f"illuminant/{illuminant_name(cie_name)}.csv", compose(header, rows)


def cameras():
    """Camera sensitivities measured by the National Physical Laboratory."""
    for name, key in CAMERAS.items():
        header = {
            "title": CAMERA_TITLES[name],
            "quantity": "sensitivity",
            "unit": "relative response per power, largest value of the camera 1",
            "source": "M. M. Darrodi et al., J. Opt. Soc. Am. A 32, 381-391 (2015), doi:10.1364/JOSAA.32.000381 / "
            + exported("MSDS_CAMERA_SENSITIVITIES", key),
            "conditions": "measured at the National Physical Laboratory",
        }
        yield f"sensitivity/{name}.csv", compose(header, distribution_rows(colour.MSDS_CAMERA_SENSITIVITIES[key]))


def colour_checker():
    """The 24 patches of the ColorChecker Classic."""
    for patch, distribution in colour.SDS_COLOURCHECKERS[COLOUR_CHECKER].items():
        name = re.sub(r"[^a-z0-9]+", "-", patch.split(" (")[0].lower())
        header = {
            "title": f"ColorChecker patch {patch}",
            "quantity": "reflectance",
            "unit": "reflectance factor, 0..1",
            "source": "ISO 17321-1:2012, equal to N. Ohta, The Basis of Color Reproduction Engineering (1997) / "
            + exported("SDS_COLOURCHECKERS", COLOUR_CHECKER),
            "conditions": "ColorChecker Classic; 5 nm",
        }
        yield f"reflectance/colorchecker-{name}.csv", compose(header, distribution_rows(distribution))


def glasses():
    """Refractive indices: Sellmeier terms, or a table where the paper's formula has another form."""
    for name, (title, source, conditions, range_nm, terms) in SELLMEIER.items():
        header = {
            "title": title,
            "quantity": "sellmeier",
            "unit": "b dimensionless, c in um^2: n^2 = 1 + sum b l^2 / (l^2 - c)",
            "source": source,
            "conditions": conditions,
            "range_nm": range_nm,
        }
        yield f"glass/{name}.csv", compose(header, terms)
    for name, (title, source, conditions, rows) in TABULATED.items():
        header = {
            "title": title,
            "quantity": "refractive_index",
            "unit": "dimensionless",
            "source": source,
            "conditions": conditions,
        }
        yield f"glass/{name}.csv", compose(header, rows)


def metals():
    """Complex refractive indices."""
    for name, (title, source, conditions, table) in METALS.items():
        header = {
            "title": title,
            "quantity": "complex_refractive_index",
            "unit": "dimensionless, n + ik, k positive",
            "source": source,
            "conditions": conditions,
        }
        yield f"metal/{name}.csv", compose(header, [row.split() for row in table.split(";")])


def lines():
    """Lamps made of spectral lines."""
    for name, (title, source, conditions, rows) in LINES.items():
        header = {
            "title": title,
            "quantity": "lines",
            "unit": "relative power of each line",
            "source": source,
            "conditions": conditions,
        }
        yield f"line/{name}.csv", compose(header, rows)


def made():
    """Path -> text of every file that this script makes, besides README.md."""
    families = (observer, illuminants, cameras, colour_checker, glasses, lines, metals)
    return {path: text for family in families for path, text in family()}


def fraunhofer_indices(curve):
    """n at the F, d and C lines of a Sellmeier curve, for the check of N-BK7."""
    return [
        (1 + sum(b * l2 / (l2 - c) for b, c in curve.rows)) ** 0.5
        for l2 in ((line_nm * 1e-3) ** 2 for line_nm in (486.1327, 587.5618, 656.2725))
    ]


def known_figures(curves):
    """Faults found by comparing curves with figures printed elsewhere."""
    sums = np.sum(curves["observer/cie-1931-2deg.csv"].rows, axis=0)[1:]
    if np.max(np.abs(sums - OBSERVER_SUMS)) > OBSERVER_SUM_TOLERANCE:
        yield f"observer/cie-1931-2deg.csv: column sums {sums} should be {OBSERVER_SUMS}"
    indices = fraunhofer_indices(curves["glass/n-bk7.csv"])
    if np.max(np.abs(np.subtract(indices, (1.522376, 1.516800, 1.514322)))) > 1e-6:
        yield f"glass/n-bk7.csv: indices at F, d, C are {indices}"
    names = [path.split("/")[1] for path in curves]
    for name in {name for name in names if names.count(name) > 1}:
        yield f"{name}: the same name in two folders"


def collect():
    """All texts (made, then measured from disk) and all faults."""
    texts, faults, curves = made(), [], {}
    made_paths = set(texts)
    for file in FOLDER.glob("*/*.csv"):
        texts.setdefault(file.relative_to(FOLDER).as_posix(), file.read_bytes().decode())
    for path in sorted(texts):
        try:
            curves[path] = parse(texts[path], path)
        except (Unsound, ValueError, IndexError, KeyError) as fault:
            faults.append(str(fault) if isinstance(fault, Unsound) else f"{path}: {fault!r}")
    if not faults:
        faults += known_figures(curves)
        texts["README.md"] = provenance_table(curves, made_paths)
    return texts, faults


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--check", action="store_true", help="write nothing; exit 1 when a file differs")
    check = arguments.parse_args().check
    if colour.__version__ != COLOUR_SCIENCE:
        sys.exit(f"colour-science is {colour.__version__}; the files come from {COLOUR_SCIENCE}")
    texts, faults = collect()
    for path, text in texts.items():
        file = FOLDER / path
        if check and (not file.exists() or file.read_bytes() != text.encode()):
            faults.append(f"{path}: differs from what this script makes")
        elif not check:
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(text.encode())
    for fault in faults:
        print(fault, file=sys.stderr)
    print(f"{len(texts)} files, {len(faults)} faults")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
