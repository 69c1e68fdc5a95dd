#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the shapes of a run with outlines that were marked by hand: outline_overlap.py RUN OUTLINES.csv

RUN is a folder of `weft run` or `weft track`. OUTLINES.csv has the columns frame, point, u_px, v_px,
next: the border of the object in the image, clockwise, with pixel centres at whole numbers. `next`
says what the stretch from this point to the next one is:
  visible  the border is seen there
  hidden   it is not, behind a hand or in glare, and the points are a guess
  image    the object goes on beyond the image, and the stretch is the border of the image

Of each frame that has an outline and a shape, the program prints the state and the confidence, then
  outside    % of the mesh's area in the image that lies outside of the outline
  uncovered  % of the outline's area that no mesh covers
  median, p95, worst
             px from vertices of the mesh's border to the outline. A vertex counts where it is in
             the image and the nearest stretch is visible.
The last lines have the same over all those frames that are `estimated`, and over all frames.

Exits 1 where a file cannot be read; exits 2 on wrong usage.
"""

import ast
import csv
import json
import math
import struct
import sys
import zipfile
from collections import Counter, defaultdict
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

KINDS = ("visible", "hidden", "image")
COLUMNS = ["frame", "point", "u_px", "v_px", "next"]
CODES = {"<f8": "d", "<i8": "q", "<i4": "i", "<f4": "f", "|u1": "B"}

Point = tuple[float, float]  # u, v in px


class OutlinePoint(NamedTuple):
    u_px: float
    v_px: float
    next: str  # kind of the stretch to the point behind it


class Camera(NamedTuple):
    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int


class Overlap(NamedTuple):
    mesh_px: int       # pixels of the image that the mesh covers
    outside_px: int    # of these, outside of the outline
    outline_px: int    # pixels within the outline
    uncovered_px: int  # of these, without mesh
    distances_px: list[float]


def array_of(data: bytes) -> list:
    """The numbers of a .npy file, in order."""
    length = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + length].decode())
    code = CODES.get(header["descr"])
    if code is None or header["fortran_order"]:
        raise ValueError(f"holds {header['descr']}, which this program does not read")
    body = data[10 + length:]
    return list(struct.unpack(f"<{len(body) // struct.calcsize(code)}{code}", body))


def rows_of(numbers: list, width: int) -> list[tuple]:
    return list(zip(*[iter(numbers)] * width))


def read_outlines(path: Path) -> dict[int, list[OutlinePoint]]:
    outlines: dict[int, list[OutlinePoint]] = defaultdict(list)
    with path.open(newline="") as file:
        reader = csv.DictReader(file)
        if reader.fieldnames != COLUMNS:
            raise ValueError(f"{path}:1: the columns must be {','.join(COLUMNS)}")
        for row in reader:
            place = f"{path}:{reader.line_num}"
            try:
                frame, point = int(row["frame"]), int(row["point"])
                u_px, v_px = float(row["u_px"]), float(row["v_px"])
            except (TypeError, ValueError):
                raise ValueError(f"{place}: frame and point must be whole numbers, u_px and v_px numbers") from None
            if not (math.isfinite(u_px) and math.isfinite(v_px)):
                raise ValueError(f"{place}: u_px and v_px must be finite")
            if row["next"] not in KINDS:
                raise ValueError(f"{place}: next is '{row['next']}', must be one of {', '.join(KINDS)}")
            if point != len(outlines[frame]):
                raise ValueError(f"{place}: point {point} follows {len(outlines[frame]) - 1} of frame {frame}")
            outlines[frame].append(OutlinePoint(u_px, v_px, row["next"]))
    for frame, outline in outlines.items():
        if len(outline) < 3:
            raise ValueError(f"{path}: frame {frame} has {len(outline)} points, an outline needs 3")
    return dict(outlines)


def fill(polygon: list[Point], rows: list[bytearray]) -> None:
    """Sets the pixels whose centres are within the polygon (even-odd rule) to 1."""
    edges = list(zip(polygon, polygon[1:] + polygon[:1]))
    first = max(0, math.ceil(min(v for _, v in polygon)))
    last = min(len(rows) - 1, math.floor(max(v for _, v in polygon)))
    width = len(rows[0])
    for y in range(first, last + 1):
        crossings = sorted(a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
                           for a, b in edges if (a[1] <= y) != (b[1] <= y))
        for left, right in zip(crossings[::2], crossings[1::2]):
            start, end = max(0, math.ceil(left)), min(width, math.floor(right) + 1)
            if start < end:
                rows[y][start:end] = b"\x01" * (end - start)


def mask_of(polygons: Iterable[list[Point]], camera: Camera) -> int:
    """One bit for each pixel of the image that any of the polygons covers."""
    rows = [bytearray(camera.width) for _ in range(camera.height)]
    for polygon in polygons:
        fill(polygon, rows)
    bits = b"".join(rows).translate(bytes([48, 49]) + bytes(254))
    return int(bits, 2)


def nearest(place: Point, outline: list[OutlinePoint]) -> tuple[float, str]:
    """The distance in px to the nearest stretch of the outline, and the kind of that stretch."""
    best = (math.inf, "image")
    for a, b in zip(outline, outline[1:] + outline[:1]):
        du, dv = b.u_px - a.u_px, b.v_px - a.v_px
        squared = du * du + dv * dv
        s = ((place[0] - a.u_px) * du + (place[1] - a.v_px) * dv) / squared if squared > 0.0 else 0.0
        s = min(1.0, max(0.0, s))
        distance = math.hypot(a.u_px + s * du - place[0], a.v_px + s * dv - place[1])
        if distance < best[0]:
            best = (distance, a.next)
    return best


def border_vertices(faces: list[tuple]) -> list[int]:
    """Vertices of edges that belong to one face only."""
    count = Counter(tuple(sorted((face[k], face[(k + 1) % 3]))) for face in faces for k in range(3))
    return sorted({vertex for edge, times in count.items() if times == 1 for vertex in edge})


def overlap_of(vertices_m: list[tuple], faces: list[tuple], camera: Camera,
               outline: list[OutlinePoint]) -> Overlap:
    image_px = [(camera.fx * x / z + camera.cx, camera.fy * y / z + camera.cy) if z > 0.0 else None
                for x, y, z in vertices_m]
    triangles = [[image_px[v] for v in face] for face in faces]
    mesh = mask_of((t for t in triangles if None not in t), camera)
    within = mask_of([[(p.u_px, p.v_px) for p in outline]], camera)
    distances = []
    for vertex in border_vertices(faces):
        place = image_px[vertex]
        if place is None or not (-0.5 <= place[0] <= camera.width - 0.5 and
                                 -0.5 <= place[1] <= camera.height - 0.5):
            continue
        distance, kind = nearest(place, outline)
        if kind == "visible":
            distances.append(distance)
    return Overlap(mesh.bit_count(), (mesh & ~within).bit_count(), within.bit_count(),
                   (within & ~mesh).bit_count(), distances)


def quantile(values: list[float], share: float) -> float:
    """Linear between the order statistics, as the tables of `weft eval`; NaN of none."""
    if not values:
        return math.nan
    values = sorted(values)
    at = share * (len(values) - 1)
    low = math.floor(at)
    high = min(low + 1, len(values) - 1)
    return values[low] + (at - low) * (values[high] - values[low])


def text_of(overlaps: list[Overlap]) -> str:
    """The columns of one line of the table; areas and distances of several frames are pooled."""
    def percent(part: int, whole: int) -> float:
        return 100.0 * part / whole if whole else math.nan
    outside = percent(sum(o.outside_px for o in overlaps), sum(o.mesh_px for o in overlaps))
    uncovered = percent(sum(o.uncovered_px for o in overlaps), sum(o.outline_px for o in overlaps))
    distances = [d for o in overlaps for d in o.distances_px]
    numbers = [outside, uncovered, *(quantile(distances, share) for share in (0.5, 0.95, 1.0))]
    return " ".join(f"{number:9.1f}" for number in numbers)


def report(run: Path, outlines: dict[int, list[OutlinePoint]]) -> None:
    with zipfile.ZipFile(run / "template.npz") as file:
        faces = rows_of(array_of(file.read("template/faces.npy")), 3)
        camera = Camera(*(array_of(file.read(f"camera/{name}.npy"))[0] for name in Camera._fields))
    lines = {}
    for text in (run / "frames.jsonl").read_text().splitlines():
        line = json.loads(text)
        lines[line["frame"]] = line
    print(f"{'frame':>9} {'state':>10} {'confidence':>10} {'outside':>9} {'uncovered':>9} "
          f"{'median':>9} {'p95':>9} {'worst':>9}")
    everything, estimated, without = [], [], []
    for frame, outline in sorted(outlines.items()):
        line = lines.get(frame, {})
        archive = run / "frames" / f"{frame:06}.npz"
        vertices_m = []
        if archive.exists():
            with zipfile.ZipFile(archive) as file:
                if "shape/vertices_m.npy" in file.namelist():
                    vertices_m = rows_of(array_of(file.read("shape/vertices_m.npy")), 3)
        if not vertices_m:
            without.append(frame)
            continue
        overlap = overlap_of(vertices_m, faces, camera, outline)
        everything.append(overlap)
        if line.get("state") == "estimated":
            estimated.append(overlap)
        confidence = line.get("confidence")
        print(f"{frame:9} {line.get('state', ''):>10} "
              f"{'' if confidence is None else format(confidence, '.2f'):>10} {text_of([overlap])}")
    for name, overlaps in (("estimated", estimated), ("all", everything)):
        worst = max((100.0 * o.outside_px / o.mesh_px for o in overlaps if o.mesh_px), default=math.nan)
        print(f"{name:>9} {len(overlaps):7} of {len(outlines):<10} {text_of(overlaps)}   "
              f"worst frame: {worst:.1f} % outside")
    if without:
        print(f"without a shape: {', '.join(map(str, without))}")


def main(words: list[str]) -> int:
    if len(words) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        report(Path(words[0]), read_outlines(Path(words[1])))
    except (OSError, KeyError, ValueError, zipfile.BadZipFile) as error:
        print(f"outline_overlap.py: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
