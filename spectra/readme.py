"""The text of README.md: how to use the curves, and one row of provenance for each."""

INTRODUCTION = """\
# Measured spectra

One CSV per measured curve set, `<kind>/<name>.csv`. A scene file refers to a curve by its name, which is
unique over all kinds. A new curve is a new CSV and no code.

```text
# title: CIE standard illuminant D65
# quantity: illuminant
# unit: relative power per nm
# source: ...
# conditions: ...
wavelength_nm,value
300,0.0341
```

| quantity | columns | outside the table |
|---|---|---|
| observer | wavelength_nm,x,y,z | zero |
| illuminant, emission | wavelength_nm,value | zero |
| lines | wavelength_nm,power | nothing beside the lines |
| reflectance, transmission | wavelength_nm,value | the end values go on |
| sensitivity | wavelength_nm,r,g,b | zero |
| refractive_index | wavelength_nm,n | an error |
| complex_refractive_index | wavelength_nm,n,k | an error |
| sellmeier | b,c_um2 | `# range_nm` says where the formula was measured |

Between samples a table is linear; lines have no width, and their powers are relative to one another. Single-letter CIE illuminants are `cie-a`, `cie-c`, `cie-e`; the others
carry their CIE name in lower case.

`python spectra/export.py` writes this page and every file whose origin is *exported* (from colour-science,
pinned in `requirements.txt`) or *entered* (typed in from the paper, in `by_hand/`). A *measured* file is
itself the source. `python spectra/export.py --check` exits 1 when a file differs or is unsound.

Facts worth knowing before use:

- The illuminants end at 780 nm and so does their light; the photopic weight beyond is 1.9e-6 of the whole.
- The ColorChecker is the ISO 17321-1 data set, equal to Ohta 1997; single charts differ by a few percent.
- `cornell-lamp` is published at four wavelengths on a relative scale; `yale-lamp` is the shape of the lamp's
  spectrum, read off a panel. The Stanford lamps are absolute readings, but the back wall of the box
  reads 0.80 to 0.94 of them, more than any wall beside so small a lamp: take them as shapes too.
- The lamps of lines hold the lines alone, without the gas that starts them. Mercury's powers are the
  intensities of NIST's compilation, which are no radiometric measurement.
- `google-pixel-4a` is a quantum efficiency, a response per photon. The other sensitivities are per power.
- The Cornell filters and lens are read from a plot, +-0.003. Values of 0.0110 stand where the curve was
  hidden at the plot's floor: they bound the leak and do not measure it.
- Indices of glasses are relative to air; multiply by 1.00027 for vacuum.
- N-SF10, N-SF11 and N-F2 are stated from 380, 370 and 365 nm up, diamond up to 760 nm.

| name | title | quantity | range (nm) | step (nm) | origin | source |
|---|---|---|---|---|---|---|
"""


def origin(path, made_paths):
    """Exported, entered or measured: who may change the file."""
    if path not in made_paths:
        return "measured"
    return "entered" if path.split("/")[0] in ("glass", "line", "metal") else "exported"


def provenance_table(curves, made_paths):
    """README.md as a whole."""
    rows = []
    for path, curve in sorted(curves.items()):
        first, last = curve.range_nm()
        cells = [
            f"[`{path.split('/')[1].removesuffix('.csv')}`]({path})",
            curve.header["title"],
            curve.quantity,
            f"{first:g}-{last:g}",
            curve.step(),
            origin(path, made_paths),
            curve.header["source"].replace("|", "\\|"),
        ]
        rows.append("| " + " | ".join(cells) + " |\n")
    return INTRODUCTION + "".join(rows)
