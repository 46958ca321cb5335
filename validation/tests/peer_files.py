"""EXRs and tables as another renderer's user would make them."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio

SIZE = (24, 32)


def truth():
    """Luminance (height, width) over a factor of four."""
    return np.linspace(50.0, 200.0, SIZE[0] * SIZE[1]).reshape(SIZE)


def write_exr(path, channels, **attributes):
    """An EXR of channels by name; `chromaticities` are eight numbers."""
    pixels = np.ascontiguousarray(np.stack(list(channels.values()), axis=-1), np.float32)
    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], "float")
    spec.channelnames = tuple(channels)
    for name, value in attributes.items():
        spec.attribute(name, *(("float[8]", value) if name == "chromaticities" else (value,)))
    file = oiio.ImageOutput.create(str(path))
    file.open(str(path), spec)
    file.write_image(pixels)
    file.close()


def noisy(generator, relative, scale=1.0):
    """The truth with normal noise that is a share of each pixel."""
    return scale * truth() * (1 + relative * generator.standard_normal(SIZE))


def write_peer(folder, relative=0.3, scale=1.0, points=4, repeats=5, reference=None, cpu_s=1.0, **attributes):
    """A table of doubling budgets whose relative noise is `relative` at the first; pictures hold Y times `scale`."""
    generator = np.random.default_rng(5)
    lines = ["cpu_seconds,file"]
    for point in range(points):
        for repeat in range(repeats):
            name = f"{point}-{repeat}.exr"
            write_exr(Path(folder) / name, {"Y": noisy(generator, relative / 2 ** (point / 2), scale)}, **attributes)
            lines.append(f"{cpu_s * 2**point * (1 + 0.02 * repeat):.3f},{name}")
    if reference is not None:
        write_exr(Path(folder) / "own.exr", {"Y": scale * reference, "stderr.Y": np.zeros(SIZE)}, **attributes)
        lines.append("reference,own.exr")
    table = Path(folder) / "peer.csv"
    table.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return table
