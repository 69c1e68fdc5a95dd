#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the label of a bottle as a mesh: make_label.py FILE.obj|FILE.ply COLUMNS ROWS [DEGREES]

A rectangle of 150 x 106 mm bent around a cylinder about the y axis by DEGREES (120; 180 is half a
cylinder), printed on its outside, in millimetres, y up, seen from +z. The chords of a column are as
long as its arcs, so that meshes of any number of columns unroll to the same rectangle and have the
same texture coordinates.
"""

import math
import sys

WIDTH_MM, HEIGHT_MM = 150.0, 106.0


def vertices(columns, rows, angle):
    """(x, y, z, s, t) row by row from the top left."""
    step = angle / (columns - 1)
    radius = WIDTH_MM / (columns - 1) / (2.0 * math.sin(step / 2.0))
    for j in range(rows):
        for i in range(columns):
            turn = -angle / 2.0 + i * step
            s, t = i / (columns - 1), 1.0 - j / (rows - 1)
            yield (radius * math.sin(turn), HEIGHT_MM * (t - 0.5),
                   radius * (math.cos(turn) - 1.0), s, t)


def faces(columns, rows):
    """Counter-clockwise from outside, with diagonals that alternate."""
    for j in range(rows - 1):
        for i in range(columns - 1):
            a = j * columns + i
            b, c, d = a + columns, a + columns + 1, a + 1
            yield from ((a, b, c), (a, c, d)) if (i + j) % 2 == 0 else ((a, b, d), (d, b, c))


def as_obj(points, triangles):
    yield "# millimetres; made by plugins/templates/mesh/tools/make_label.py"
    yield from (f"v {x:.4f} {y:.4f} {z:.4f}" for x, y, z, _, _ in points)
    yield from (f"vt {s:.6f} {t:.6f}" for _, _, _, s, t in points)
    yield from ("f " + " ".join(f"{v + 1}/{v + 1}" for v in face) for face in triangles)


def as_ply(points, triangles):
    yield from ("ply", "format ascii 1.0",
                "comment millimetres; made by plugins/templates/mesh/tools/make_label.py",
                f"element vertex {len(points)}")
    yield from (f"property double {name}" for name in "xyzst")
    yield from (f"element face {len(triangles)}", "property list uchar int vertex_indices",
                "end_header")
    yield from (f"{x:.4f} {y:.4f} {z:.4f} {s:.6f} {t:.6f}" for x, y, z, s, t in points)
    yield from ("3 " + " ".join(map(str, face)) for face in triangles)


def main(arguments):
    if len(arguments) not in (3, 4) or not arguments[0].endswith((".obj", ".ply")):
        print(__doc__, file=sys.stderr)
        return 2
    columns, rows = int(arguments[1]), int(arguments[2])
    angle = math.radians(float(arguments[3]) if len(arguments) == 4 else 120.0)
    points = list(vertices(columns, rows, angle))
    triangles = list(faces(columns, rows))
    lines = as_obj if arguments[0].endswith(".obj") else as_ply
    with open(arguments[0], "w", encoding="ascii", newline="\n") as file:
        file.writelines(line + "\n" for line in lines(points, triangles))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
