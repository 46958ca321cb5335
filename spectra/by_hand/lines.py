"""Spectral lines of lamps, as compiled: wavelengths in air, in nanometres, and relative powers."""

NIST = "A. Kramida, Yu. Ralchenko, J. Reader and NIST ASD Team, NIST Atomic Spectra Database, doi:10.18434/T4W30F, {}"

# name: (title, source, conditions, lines)
LINES = {
    "sodium-low-pressure": (
        "Low-pressure sodium lamp",
        NIST.format("Na I (wavelengths)"),
        "the D lines; in air; powers 2 to 1 as the statistical weights of the upper levels, without self-absorption",
        [("588.995095", "2"), ("589.592424", "1")],
    ),
    "mercury-low-pressure": (
        "Low-pressure mercury lamp",
        NIST.format("Hg I (wavelengths and relative intensities)"),
        "the five strongest lines from 400 to 600 nm; in air; the intensities of the compilation give the order of size, not a radiometric measurement",
        [("404.6565", "12000"), ("435.8335", "12000"), ("546.075", "6000"), ("576.961", "1000"), ("579.067", "900")],
    ),
}
