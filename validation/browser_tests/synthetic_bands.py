"""A report of seven bands with known factors, for the browser: `python -m browser_tests.synthetic_bands FOLDER`.

The band images may not be part of the project; these are of the same box, each
face of one level, behind a camera of few pixels.
"""

import sys
import tempfile
from pathlib import Path

from etalon_validation.band_report import band_report
from tests.band_case import camera_of, picture, write_band_case, write_band_images, write_band_render

# Factors of the bands, in stops.
FACTORS_STOPS = (3.0, -1.0, 0.3, -0.1, 0.25, -0.45, 4.0)


def main(target):
    """Writes the report into a folder."""
    with tempfile.TemporaryDirectory() as holder:
        case = Path(holder)
        write_band_case(case)
        image = picture(case, camera_of(case))
        write_band_render(case / "out.exr", image)
        write_band_images(case / "bands", image, [2**stops for stops in FACTORS_STOPS])
        band_report(case, case / "out.exr", case / "bands", None, target)


if __name__ == "__main__":
    main(*sys.argv[1:])
