"""Writes water.ply: the body of water of this scene, closed, its top a sum of sine waves.

python reference/pool/water.py
"""

import math
import struct
from pathlib import Path

# Half the extent along x and z in m: 5 mm into the pool's walls, so that no gap is left.
HALF_X_M, HALF_Z_M = 1.005, 0.755
# Depth in m, 5 mm into the pool's floor; the undisturbed surface is at 0.
DEPTH_M = 0.605
# Cells of the surface along x and z.
CELLS_X, CELLS_Z = 96, 72
# Amplitude in m, wavelength in m, direction of travel in degrees from x to z, phase in degrees.
WAVES = [
    (0.0050, 0.52, 25, 0),
    (0.0040, 0.37, 78, 140),
    (0.0032, 0.31, 131, 250),
    (0.0022, 0.23, 52, 35),
    (0.0014, 0.17, 160, 310),
    (0.0010, 0.14, 103, 80),
]


def surface(x, z):
    """Height, and the normal (up), from the waves and their slopes."""
    height = slope_x = slope_z = 0.0
    for amplitude, wavelength, direction, phase in WAVES:
        k = 2 * math.pi / wavelength
        k_x, k_z = k * math.cos(math.radians(direction)), k * math.sin(math.radians(direction))
        angle = k_x * x + k_z * z + math.radians(phase)
        height += amplitude * math.sin(angle)
        slope_x += amplitude * k_x * math.cos(angle)
        slope_z += amplitude * k_z * math.cos(angle)
    length = math.hypot(slope_x, 1, slope_z)
    return height, (-slope_x / length, 1 / length, -slope_z / length)


def mesh():
    """Vertices as (x, y, z, nx, ny, nz), and faces as lists of vertex numbers."""
    vertices, faces = [], []

    def row_of(points):
        first = len(vertices)
        vertices.extend(points)
        return range(first, len(vertices))

    def grid_point(column, row):
        x = HALF_X_M * (2 * column / CELLS_X - 1)
        z = HALF_Z_M * (2 * row / CELLS_Z - 1)
        height, normal = surface(x, z)
        return (x, height, z, *normal)

    rows = [row_of(grid_point(column, row) for column in range(CELLS_X + 1)) for row in range(CELLS_Z + 1)]
    for near, far in zip(rows, rows[1:]):
        for i in range(CELLS_X):
            faces.append((near[i], far[i], far[i + 1], near[i + 1]))

    # The rim of the surface, counter-clockwise in the order of the cells from the corner (-x, -z).
    front = [(i, 0) for i in range(CELLS_X + 1)]
    right = [(CELLS_X, i) for i in range(CELLS_Z + 1)]
    back = [(i, CELLS_Z) for i in range(CELLS_X, -1, -1)]
    left = [(0, i) for i in range(CELLS_Z, -1, -1)]
    down = (0, -1, 0)
    middle = row_of([(0, -DEPTH_M, 0, *down)])[0]
    for cells, normal in ((front, (0, 0, -1)), (right, (1, 0, 0)), (back, (0, 0, 1)), (left, (-1, 0, 0))):
        tops = [grid_point(*cell)[:3] for cell in cells]
        upper = row_of((*top, *normal) for top in tops)
        lower = row_of((x, -DEPTH_M, z, *normal) for x, _, z in tops)
        bottom = row_of((x, -DEPTH_M, z, *down) for x, _, z in tops)
        for i in range(len(tops) - 1):
            faces.append((upper[i], upper[i + 1], lower[i + 1], lower[i]))
            faces.append((bottom[i], bottom[i + 1], middle))
    return vertices, faces


def write(path):
    """The mesh as a binary PLY."""
    vertices, faces = mesh()
    header = ["ply", "format binary_little_endian 1.0", "comment made by reference/pool/water.py", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
    header += [f"element face {len(faces)}", "property list uchar ushort vertex_indices", "end_header"]
    with open(path, "wb") as file:
        file.write(("\n".join(header) + "\n").encode())
        for vertex in vertices:
            file.write(struct.pack("<6f", *vertex))
        for face in faces:
            file.write(struct.pack(f"<B{len(face)}H", len(face), *face))


if __name__ == "__main__":
    write(Path(__file__).with_name("water.ply"))
