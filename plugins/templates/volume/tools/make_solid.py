#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a closed mesh with texture coordinates, in millimetres: make_solid.py FILE.obj SHAPE ...

Faces are counter-clockwise from outside. Both sides of a seam have the same positions. The charts
are laid out in one image without overlap, with the same texel pitch, as large as they fit. The
program prints the size of a texel.
"""

import argparse
import math
import random
import sys

MAX_RELAXATION_ROUNDS = 400


class Chart:
    """A piece of a surface: points in space, their places in a plane as seen from outside (x to the
    right, y up), all in mm, and triangles that are counter-clockwise in the plane."""

    def __init__(self):
        self.points, self.plane, self.faces = [], [], []

    def add(self, point, place):
        self.points.append(tuple(point))
        self.plane.append(tuple(place))
        return len(self.points) - 1

    def add_face(self, a, b, c):
        (ax, ay), (bx, by), (cx, cy) = self.plane[a], self.plane[b], self.plane[c]
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        self.faces.append((a, b, c) if area > 0.0 else (a, c, b))

    def turned(self, angle):
        """The same chart, turned in the plane by `angle` rad."""
        cos, sin = math.cos(angle), math.sin(angle)
        chart = Chart()
        chart.points, chart.faces = self.points, self.faces
        chart.plane = [(cos * x - sin * y, sin * x + cos * y) for x, y in self.plane]
        return chart

    def box(self):
        xs, ys = [p[0] for p in self.plane], [p[1] for p in self.plane]
        return min(xs), min(ys), max(xs), max(ys)


def pieces(length, edge):
    return max(1, round(length / edge))


def steps(count):
    return [i / count for i in range(count + 1)]


def grid(columns, rows, to_space, to_plane):
    """A chart of (columns + 1) x (rows + 1) vertices; both functions take shares of 0 to 1."""
    chart = Chart()
    for t in steps(rows):
        for s in steps(columns):
            chart.add(to_space(s, t), to_plane(s, t))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            b, c, d = a + 1, a + columns + 2, a + columns + 1
            if (i + j) % 2 == 0:
                chart.add_face(a, b, c), chart.add_face(a, c, d)
            else:
                chart.add_face(a, b, d), chart.add_face(b, c, d)
    return chart


def join_rings(chart, inner, outer):
    """Triangles between two closed rings of vertices, given with their angles."""
    i = j = 0
    while i < len(inner) or j < len(outer):
        next_inner = (i + 1) / len(inner) if i < len(inner) else math.inf
        next_outer = (j + 1) / len(outer) if j < len(outer) else math.inf
        a, b = inner[i % len(inner)], outer[j % len(outer)]
        if next_outer <= next_inner:
            j += 1
            chart.add_face(a, b, outer[j % len(outer)])
        else:
            i += 1
            chart.add_face(a, b, inner[i % len(inner)])


def disc(count, radius, first, edge, to_space):
    """A filled circle; its first `count` vertices are its border from the angle `first` rad, in
    counter-clockwise order."""
    chart = Chart()

    def ring(size, ring_radius):
        turns = [first + 2.0 * math.pi * k / size for k in range(size)]
        places = [(ring_radius * math.cos(turn), ring_radius * math.sin(turn)) for turn in turns]
        return [chart.add(to_space(*place), place) for place in places]

    outer = ring(count, radius)
    rings = pieces(radius, edge)
    for k in range(rings - 1, 0, -1):
        inner = ring(max(5, round(count * k / rings)), radius * k / rings)
        join_rings(chart, inner, outer)
        outer = inner
    middle = chart.add(to_space(0.0, 0.0), (0.0, 0.0))
    for k, vertex in enumerate(outer):
        chart.add_face(middle, vertex, outer[(k + 1) % len(outer)])
    return chart


def attach(chart, other, a, b):
    """Lays `other` beside the side (a, b) of a chart, which both have, and makes both one chart."""
    def vertex_at(point):
        return min(range(len(other.points)), key=lambda v: math.dist(other.points[v], point))

    ends = vertex_at(chart.points[a]), vertex_at(chart.points[b])
    own, theirs = chart.plane, other.plane
    turn = (math.atan2(own[b][1] - own[a][1], own[b][0] - own[a][0]) -
            math.atan2(theirs[ends[1]][1] - theirs[ends[0]][1],
                       theirs[ends[1]][0] - theirs[ends[0]][0]))
    other = other.turned(turn)
    dx, dy = (own[a][k] - other.plane[ends[0]][k] for k in range(2))
    number = {ends[0]: a, ends[1]: b}
    for v, (x, y) in enumerate(other.plane):
        if v not in number:
            number[v] = chart.add(other.points[v], (x + dx, y + dy))
    chart.faces += [tuple(number[v] for v in face) for face in other.faces]


def relaxed(chart):
    """Moves the places in the plane until edges are about as long as in space."""
    edges = {}
    for face in chart.faces:
        for k in range(3):
            a, b = sorted((face[k], face[(k + 1) % 3]))
            edges[a, b] = math.dist(chart.points[a], chart.points[b])
    plane = [list(place) for place in chart.plane]
    for _ in range(MAX_RELAXATION_ROUNDS):
        moves = [[0.0, 0.0, 0] for _ in plane]
        for (a, b), length in edges.items():
            dx, dy = plane[b][0] - plane[a][0], plane[b][1] - plane[a][1]
            now = math.hypot(dx, dy)
            share = 0.5 * (now - length) / now
            for v, sign in ((a, 1.0), (b, -1.0)):
                moves[v][0] += sign * share * dx
                moves[v][1] += sign * share * dy
                moves[v][2] += 1
        for place, (dx, dy, count) in zip(plane, moves):
            place[0] += dx / count
            place[1] += dy / count
    chart.plane = [tuple(place) for place in plane]
    return chart


def sides_of_box(length, width, height, edge):
    """The six sides of a box about the origin: x is its length, y its width, z its height."""
    half = [0.5 * length, 0.5 * width, 0.5 * height]
    for axis in range(3):
        for sign in (1.0, -1.0):
            right, up = (axis + 1) % 3, (axis + 2) % 3
            if sign < 0.0:
                right, up = up, right
            if up == 0 or (up == 1 and right != 0):  # long sides lie flat in the image
                right, up, turned = up, right, True
            else:
                turned = False

            def to_space(s, t, axis=axis, sign=sign, right=right, up=up, turned=turned):
                point = [0.0, 0.0, 0.0]
                point[axis] = sign * half[axis]
                point[right] = (2.0 * s - 1.0) * half[right] * (-1.0 if turned else 1.0)
                point[up] = (2.0 * t - 1.0) * half[up]
                return point

            def to_plane(s, t, right=right, up=up):
                return 2.0 * s * half[right], 2.0 * t * half[up]

            yield grid(pieces(2.0 * half[right], edge), pieces(2.0 * half[up], edge), to_space,
                       to_plane)


def block(a):
    return list(sides_of_box(a.length, a.width, a.height, a.edge))


class Cylinder:
    """A ring of `count` vertices about the y axis whose chords are unrolled at their length."""

    def __init__(self, radius, count):
        self.radius, self.count = radius, max(3, count)
        self.chord = 2.0 * radius * math.sin(math.pi / self.count)

    def point(self, k, y):
        turn = 2.0 * math.pi * k / self.count
        return self.radius * math.sin(turn), y, self.radius * math.cos(turn)

    def side(self, first, count, height, edge, sign=1):
        """A chart of `count` columns from column `first`, seen from outside (1) or inside (-1)."""
        return grid(count, pieces(height, edge),
                    lambda s, t: self.point(first + sign * round(s * count), (t - 0.5) * height),
                    lambda s, t: (self.chord * round(s * count), t * height))

    def cap(self, y, sign, edge):
        """The upper (1) or the lower end (-1), seen from outside with the x axis to the right."""
        return disc(self.count, self.radius, -0.5 * math.pi * sign, edge,
                    lambda px, py: (px, y, -sign * py))


def can(a):
    sides = 2 if a.charts == 2 else a.charts - 2
    if sides < 1:
        raise ValueError("a can has at least 2 charts")
    columns = max(1, round(2.0 * math.pi * a.radius / a.edge / sides))
    cylinder = Cylinder(a.radius, columns * sides)
    columns = cylinder.count // sides
    charts = [cylinder.side(columns * i, columns, a.height, a.edge) for i in range(sides)]
    caps = [cylinder.cap(0.5 * sign * a.height, sign, a.edge) for sign in (1, -1)]
    if a.charts > 2:
        return charts + caps
    # Two halves of the side with a cap each, joined along the middle chord.
    rows = pieces(a.height, a.edge)
    for chart, cap, row in zip(charts, caps, (rows, 0)):
        left = row * (columns + 1) + columns // 2
        attach(chart, cap, left, left + 1)
    return charts


def tube(a):
    if not 0.0 < a.inner_radius < a.outer_radius:
        raise ValueError("the inner radius must be above 0 and below the outer one")
    outer, inner = (Cylinder(r, round(2.0 * math.pi * r / a.edge))
                    for r in (a.outer_radius, a.inner_radius))
    charts = [outer.side(0, outer.count, a.length, a.edge),
              inner.side(0, inner.count, a.length, a.edge, sign=-1)]
    between = pieces(a.outer_radius - a.inner_radius, a.edge)
    for sign in (1, -1):
        chart = Chart()
        rings = []
        for k in steps(between):
            radius = inner.radius + k * (outer.radius - inner.radius)
            count = round(inner.count + k * (outer.count - inner.count))
            ring = Cylinder(radius, count)
            points = [ring.point(sign * n, 0.5 * sign * a.length) for n in range(count)]
            rings.append([chart.add(p, (p[0], -sign * p[2])) for p in points])
        for within, around in zip(rings, rings[1:]):
            join_rings(chart, within, around)
        charts.append(chart)
    return charts


def cushion(a):
    """Two square sheets, each bulged by a.thickness / 2 and joined along the border."""
    count = pieces(a.size, a.edge)
    charts = []
    for sign in (1.0, -1.0):
        def to_space(s, t, sign=sign):
            x, y = 2.0 * s - 1.0, 2.0 * t - 1.0
            waist = 0.06  # the border is drawn in at the middle of each side
            bulge = math.sqrt((1.0 - x ** 4) * (1.0 - y ** 4))
            return (0.5 * sign * a.size * x * (1.0 - waist * (1.0 - y * y)),
                    0.5 * a.size * y * (1.0 - waist * (1.0 - x * x)),
                    0.5 * sign * a.thickness * bulge)
        chart = grid(count, count, to_space, lambda s, t: (a.size * s, a.size * t))
        charts.append(relaxed(chart))
    return charts


def ellipsoid(a):
    """A cube whose six sides, each cut in k x k squares, are moved to the ellipsoid."""
    cuts = math.isqrt(a.charts // 6)
    if cuts < 1 or 6 * cuts * cuts != a.charts:
        raise ValueError("an ellipsoid has 6, 24, 54 ... charts")
    radii = (a.a, a.b, a.c)
    count = pieces(0.5 * math.pi * sum(radii) / 3.0 / cuts, a.edge)
    charts = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            right, up = (axis + 1) % 3, (axis + 2) % 3
            if sign < 0.0:
                right, up = up, right
            for cell in range(cuts * cuts):
                def to_space(s, t, axis=axis, sign=sign, right=right, up=up, cell=cell):
                    cube = [0.0, 0.0, 0.0]
                    cube[axis] = sign
                    # The tangent gives squares of equal angles.
                    cube[right] = math.tan(0.25 * math.pi * (2.0 * (cell % cuts + s) / cuts - 1.0))
                    cube[up] = math.tan(0.25 * math.pi * (2.0 * (cell // cuts + t) / cuts - 1.0))
                    norm = math.hypot(*cube)
                    return [r * c / norm for r, c in zip(radii, cube)]
                width, height = (0.5 * math.pi * radii[k] / cuts for k in (right, up))
                charts.append(relaxed(grid(count, count, to_space,
                                           lambda s, t, w=width, h=height: (w * s, h * t))))
    return charts


def irregular_parts(chart, count, draw):
    """Cuts a chart in `count` parts around random points: connected, of random outlines."""
    centres = [[sum(chart.plane[v][k] for v in face) / 3.0 for k in range(2)]
               for face in chart.faces]
    x0, y0, x1, y1 = chart.box()
    seeds = [(x0 + (0.25 + 0.5 * (k % 2) + draw.uniform(-0.1, 0.1)) * (x1 - x0),
              y0 + (0.25 + 0.5 * (k // 2) + draw.uniform(-0.1, 0.1)) * (y1 - y0))
             for k in range(count)]
    beside = {}
    for f, face in enumerate(chart.faces):
        for k in range(3):
            beside.setdefault(tuple(sorted((face[k], face[(k + 1) % 3]))), []).append(f)
    part_of = [None] * len(chart.faces)
    for part, seed in enumerate(seeds):
        part_of[min(range(len(centres)), key=lambda f: math.dist(centres[f], seed))] = part
    # Parts grow face by face from their seeds, so that each is connected.
    while None in part_of:
        grown = [(math.dist(centres[g], seeds[part_of[f]]), g, part_of[f])
                 for pair in beside.values() if len(pair) == 2 for f, g in (pair, pair[::-1])
                 if part_of[f] is not None and part_of[g] is None]
        _, face, part = min(grown)
        part_of[face] = part
    for part in range(count):
        piece, number = Chart(), {}
        for face in (f for f, own in zip(chart.faces, part_of) if own == part):
            for v in face:
                if v not in number:
                    number[v] = piece.add(chart.points[v], chart.plane[v])
            piece.faces.append(tuple(number[v] for v in face))
        yield piece


def box(a):
    """A box as a scanner leaves it: charts cut at random, turned and shuffled in the image."""
    if a.charts % 6 != 0 or a.charts < 6:
        raise ValueError("a box has 6, 12, 18 ... charts")
    draw = random.Random(a.seed)
    charts = [part for side in sides_of_box(a.length, a.width, a.height, a.edge)
              for part in irregular_parts(side, a.charts // 6, draw)]
    draw.shuffle(charts)
    return [chart.turned(draw.uniform(0.0, 2.0 * math.pi)) for chart in charts]


def shelves(sizes, width, height, scale, gap):
    """Left upper corners, px, of rectangles in rows; nothing where they do not fit."""
    corners = []
    x, y, row = gap, gap, 0.0
    for w, h in sizes:
        w, h = scale * w, scale * h
        if x + w + gap > width:
            x, y, row = gap, y + row + gap, 0.0
        if x + w + gap > width or y + h + gap > height:
            return None
        corners.append((x, y))
        x, row = x + w + gap, max(row, h)
    return corners


def size_of(chart):
    x0, y0, x1, y1 = chart.box()
    return x1 - x0, y1 - y0


def is_long(chart):
    width, height = size_of(chart)
    return width > height


def lay_out(charts, width, height, gap):
    """The scale, px per mm, charts in the order of the image, and their left upper corners, px.

    Charts are tried as they are and turned by a quarter, all combinations where they are few."""
    MOST_COMBINED = 8
    quarters = [chart.turned(0.5 * math.pi) for chart in charts]
    count = len(charts)
    masks = range(1 << count) if count <= MOST_COMBINED else (
        0, (1 << count) - 1,
        *(sum(1 << i for i, chart in enumerate(charts) if is_long(chart) == wanted)
          for wanted in (False, True)))
    best = (0.0, None, None)
    for mask in masks:
        turned = [quarters[i] if mask >> i & 1 else charts[i] for i in range(count)]
        for order in (turned, sorted(turned, key=lambda chart: -size_of(chart)[1])):
            sizes = [size_of(chart) for chart in order]
            low, high = 0.0, 100.0
            for _ in range(40):
                scale = 0.5 * (low + high)
                if shelves(sizes, width, height, scale, gap) is None:
                    high = scale
                else:
                    low = scale
            if low > best[0] * 1.001:
                best = (low, order, shelves(sizes, width, height, low, gap))
    if best[1] is None:
        raise ValueError("the charts do not fit into the image: give a larger --image")
    return best


class Places:
    """Numbers of points in space; points that differ by rounding are one."""

    STEP_MM = 1e-4

    def __init__(self):
        self.lines, self.number_at = [], {}

    def number(self, point):
        cell = tuple(round(c / self.STEP_MM) for c in point)
        around = [(i, j, k) for i in (0, -1, 1) for j in (0, -1, 1) for k in (0, -1, 1)]
        for i, j, k in around:
            found = self.number_at.get((cell[0] + i, cell[1] + j, cell[2] + k))
            if found is not None:
                return found
        self.lines.append("v " + " ".join(f"{c * self.STEP_MM + 0.0:.4f}" for c in cell))
        self.number_at[cell] = len(self.lines)
        return len(self.lines)


def check_closed(triangles):
    """Each side of a triangle belongs to one other triangle, which walks it the other way."""
    walks = [(face[k], face[(k + 1) % 3]) for face in triangles for k in range(3)]
    if len(set(walks)) != len(walks) or any((b, a) not in set(walks) for a, b in walks):
        raise ValueError("the surface is not closed: choose another --edge")


def as_obj(charts, corners, scale, width, height):
    places, texture, faces, triangles = Places(), [], [], []
    for chart, (left, top) in zip(charts, corners):
        x0, _, _, y1 = chart.box()
        numbers = [places.number(point) for point in chart.points]
        first = len(texture) + 1
        for x, y in chart.plane:
            u, v = left + scale * (x - x0), top + scale * (y1 - y)
            texture.append(f"vt {u / width:.6f} {1.0 - v / height:.6f}")
        for face in chart.faces:
            triangles.append(tuple(numbers[v] for v in face))
            faces.append("f " + " ".join(f"{numbers[v]}/{first + v}" for v in face))
    check_closed(triangles)
    yield "# millimetres; made by plugins/templates/volume/tools/make_solid.py"
    yield from places.lines + texture + faces


SHAPES = {
    "block": (block, "a box of six charts", ("length", "width", "height")),
    "can": (can, "2 charts: two halves with a cap each; else pieces of the side and two caps",
            ("radius", "height", "charts")),
    "tube": (tube, "a thick hose with end rings", ("length", "outer_radius", "inner_radius")),
    "cushion": (cushion, "two bulged sheets", ("size", "thickness")),
    "ellipsoid": (ellipsoid, "6, 24, 54 ... charts", ("a", "b", "c", "charts")),
    "box": (box, "a scanned box: each side in charts / 6 irregular pieces, turned and shuffled",
            ("length", "width", "height", "charts")),
}


def options():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", help="OBJ file to write")
    shapes = parser.add_subparsers(dest="shape", required=True)
    for name, (_, text, sizes) in SHAPES.items():
        shape = shapes.add_parser(name, help=text, description=text)
        for size in sizes:
            shape.add_argument(size, type=int if size == "charts" else float,
                               help="number" if size == "charts" else "mm")
        shape.add_argument("--edge", type=float, default=10.0, help="length of an edge, mm")
        shape.add_argument("--image", default="842x595", help="size of the texture, px")
        shape.add_argument("--gap", type=float, default=6.0, help="gap between charts, px")
        shape.add_argument("--seed", type=int, default=1, help="of the scanned box")
    return parser


def main():
    parser = options()
    a = parser.parse_args()
    try:
        width, height = (int(side) for side in a.image.split("x"))
        numbers = [value for value in vars(a).values() if isinstance(value, (int, float))]
        if not all(math.isfinite(value) for value in numbers):
            raise ValueError("all lengths must be finite")
        if min(getattr(a, size) for size in (*SHAPES[a.shape][2], "edge")) <= 0.0:
            raise ValueError("all lengths must be above 0")
        charts = SHAPES[a.shape][0](a)
        scale, charts, corners = lay_out(charts, width, height, a.gap)
        lines = list(as_obj(charts, corners, scale, width, height))
    except ValueError as error:
        parser.error(str(error))
    with open(a.file, "w", encoding="ascii", newline="\n") as file:
        file.writelines(line + "\n" for line in lines)
    faces = sum(len(chart.faces) for chart in charts)
    print(f"{a.file}: {sum(line.startswith('v ') for line in lines)} points, {faces} faces, "
          f"{len(charts)} charts, {1.0 / scale:.4f} mm per px")
    return 0


if __name__ == "__main__":
    sys.exit(main())
