"""A minimal DNG: one uncompressed Bayer image with the tags that a decoder needs."""

import struct

import numpy as np

SHORT, LONG, RATIONAL, ASCII, BYTE, SRATIONAL = 3, 4, 5, 2, 1, 10
SIZES = {BYTE: 1, ASCII: 1, SHORT: 2, LONG: 4, RATIONAL: 8, SRATIONAL: 8}


def packed(kind, values):
    """The bytes of a tag's values."""
    if kind == ASCII:
        return values.encode() + b"\0"
    if kind in (RATIONAL, SRATIONAL):
        form = "<II" if kind == RATIONAL else "<ii"
        return b"".join(struct.pack(form, round(value * 10000), 10000) for value in values)
    return struct.pack("<" + {BYTE: "B", SHORT: "H", LONG: "I"}[kind] * len(values), *values)


def directory(tags, start, after):
    """An IFD at byte `start`; values that do not fit stand from byte `after` on. Returns both blocks."""
    head, tail = struct.pack("<H", len(tags)), b""
    for code, kind, values in sorted(tags):
        data = packed(kind, values)
        count = len(data) // SIZES[kind]
        if len(data) <= 4:
            head += struct.pack("<HHI", code, kind, count) + data.ljust(4, b"\0")
        else:
            head += struct.pack("<HHII", code, kind, count, after + len(tail))
            tail += data + b"\0" * (len(data) % 2)
    return head + struct.pack("<I", 0), tail


def write_dng(path, counts, black, white, orientation=1):
    """Writes an RGGB mosaic of `counts` (h, w), 1/60 s, f/5.6, ISO 400, 35 mm."""
    height, width = counts.shape
    pixels = np.ascontiguousarray(counts, "<u2").tobytes()
    start = 8 + len(pixels)
    exif_tags = [(33434, RATIONAL, [1 / 60]), (33437, RATIONAL, [5.6]), (34855, SHORT, [400]), (37386, RATIONAL, [35.0])]
    exif_length = 2 + 12 * len(exif_tags) + 4
    exif, exif_tail = directory(exif_tags, start, start + exif_length)
    main = start + len(exif) + len(exif_tail)
    tags = [
        (254, LONG, [0]), (256, LONG, [width]), (257, LONG, [height]), (258, SHORT, [16]), (259, SHORT, [1]), (262, SHORT, [32803]),
        (271, ASCII, "Maker"), (272, ASCII, "Model"), (273, LONG, [8]), (274, SHORT, [orientation]), (277, SHORT, [1]), (278, LONG, [height]),
        (279, LONG, [len(pixels)]), (284, SHORT, [1]), (33421, SHORT, [2, 2]), (33422, BYTE, [0, 1, 1, 2]), (34665, LONG, [start]),
        (50706, BYTE, [1, 4, 0, 0]), (50707, BYTE, [1, 1, 0, 0]), (50708, ASCII, "Maker Model"), (50714, SHORT, [black]), (50717, LONG, [white]),
        (50721, SRATIONAL, [0.9, -0.2, -0.1, -0.4, 1.2, 0.2, -0.1, 0.2, 0.6]), (50728, RATIONAL, [0.5, 1.0, 0.7]), (50778, SHORT, [21]),
    ]
    head, tail = directory(tags, main, main + 2 + 12 * len(tags) + 4)
    path.write_bytes(b"II*\0" + struct.pack("<I", main) + pixels + exif + exif_tail + head + tail)
