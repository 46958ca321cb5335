"""Dispersion of transparent materials, as published.

Sellmeier terms are pairs (b, c) of n^2 = 1 + sum b l^2 / (l^2 - c), l in micrometres. Papers that print
the resonance wavelength itself are entered with `squared`, which squares it in decimal arithmetic.
All indices are relative to air, as measured, unless the conditions say otherwise.
"""

from decimal import Decimal

SCHOTT = "SCHOTT optical glass catalogue of 2017-01-20 (Zemax file 2017-01-20b), {}"
SCHOTT_CONDITIONS = "relative to air at 101325 Pa; 20 C"


def squared(*pairs):
    """Terms whose second number is a wavelength, as terms whose second number is its square."""
    return [(b, format(Decimal(wavelength_um) ** 2, "f")) for b, wavelength_um in pairs]


# name: (title, source, conditions, range_nm, terms)
SELLMEIER = {
    "n-bk7": (
        "Borosilicate crown glass N-BK7", SCHOTT.format("N-BK7"), SCHOTT_CONDITIONS, "300-2500",
        [("1.03961212", "0.00600069867"), ("0.231792344", "0.0200179144"), ("1.01046945", "103.560653")],
    ),
    "f2": (
        "Lead flint glass F2", SCHOTT.format("F2"), SCHOTT_CONDITIONS, "320-2500",
        [("1.34533359", "0.00997743871"), ("0.209073176", "0.0470450767"), ("0.937357162", "111.886764")],
    ),
    "n-f2": (
        "Flint glass N-F2", SCHOTT.format("N-F2"), SCHOTT_CONDITIONS, "365-2500",
        [("1.39757037", "0.00995906143"), ("0.159201403", "0.0546931752"), ("1.2686543", "119.248346")],
    ),
    "n-sf10": (
        "Dense flint glass N-SF10", SCHOTT.format("N-SF10"), SCHOTT_CONDITIONS, "380-2500",
        [("1.62153902", "0.0122241457"), ("0.256287842", "0.0595736775"), ("1.64447552", "147.468793")],
    ),
    "n-sf11": (
        "Dense flint glass N-SF11", SCHOTT.format("N-SF11"), SCHOTT_CONDITIONS, "370-2500",
        [("1.73759695", "0.013188707"), ("0.313747346", "0.0623068142"), ("1.89878101", "155.23629")],
    ),
    "fused-silica": (
        "Fused silica", "I. H. Malitson, J. Opt. Soc. Am. 55, 1205-1208 (1965), doi:10.1364/JOSA.55.001205",
        "relative to air; 20 C", "210-3710",
        squared(("0.6961663", "0.0684043"), ("0.4079426", "0.1162414"), ("0.8974794", "9.896161")),
    ),
    "calcium-fluoride": (
        "Calcium fluoride", "I. H. Malitson, Appl. Opt. 2, 1103-1107 (1963), doi:10.1364/AO.2.001103",
        "relative to air; 24 C", "230-9700",
        squared(("0.5675888", "0.050263605"), ("0.4710914", "0.1003909"), ("3.8484723", "34.649040")),
    ),
    "sapphire-o": (
        "Synthetic sapphire, ordinary ray",
        "I. H. Malitson and M. J. Dodge, J. Opt. Soc. Am. 62, 1405 (1972); formula in M. J. Dodge, Handbook of Laser "
        "Science and Technology IV, CRC Press (1986), p. 30",
        "relative to air; 20 C; the crystal is birefringent and this is one of its two indices", "200-5000",
        squared(("1.4313493", "0.0726631"), ("0.65054713", "0.1193242"), ("5.3414021", "18.028251")),
    ),
    "diamond": (
        "Diamond", "F. Peter, Z. Phys. 15, 358-368 (1923), doi:10.1007/BF01330487",
        "room temperature; measured 226-644 nm, formula stated to 760 nm", "226-760",
        squared(("0.3306", "0.1750"), ("4.3356", "0.1060")),
    ),
    "water": (
        "Distilled water", "M. Daimon and A. Masumura, Appl. Opt. 46, 3811-3820 (2007), doi:10.1364/AO.46.003811",
        "relative to air; 20.0 C; HPLC grade", "182-1129",
        [
            ("0.5684027565", "0.005101829712"), ("0.1726177391", "0.01821153936"),
            ("0.02086189578", "0.02620722293"), ("0.1130748688", "10.69792721"),
        ],
    ),
}


def rubin_soda_lime():
    """Rubin's formula for the index of window glass, l in micrometres: 1.5130 - 0.003169 l^2 + 0.003962 / l^2."""
    for nm in range(310, 1001, 10):
        l2 = (Decimal(nm) / 1000) ** 2
        index = Decimal("1.5130") - Decimal("0.003169") * l2 + Decimal("0.003962") / l2
        yield [str(nm), format(index.quantize(Decimal("0.000001")), "f")]


# name: (title, source, conditions, rows)
TABULATED = {
    "soda-lime-window": (
        "Clear soda lime window glass",
        "M. Rubin, Sol. Energy Mater. 12, 275-288 (1985), doi:10.1016/0165-1633(85)90052-8",
        "the paper's formula sampled every 10 nm; the formula is stated for 310-4600 nm", list(rubin_soda_lime()),
    ),
}
