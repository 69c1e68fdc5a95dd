#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how far the border of recovered meshes is from the annotated border of photographed paper.

usage: scripts/border_distance.py RUN... [--borders DIR] [--document NAME] [--csv FILE]

RUN is the folder of `weft run` on photographs that tests/data/inv3d_borders annotates. Each image of a
run must fill its frame: run photographs of different sizes one by one. The template must end where the
paper ends (the README beside the annotation describes how). The document is found in the path of the
source in pipeline.yaml, unless --document names it.

The mesh border is the longest loop of edges with one face, projected into the image. The distance is
the mean of two means: over the annotated border to the nearest point of the mesh border, and over the
mesh border to the nearest annotated point. Parts of the mesh border that no annotation faces do not
count. In mm, the sight ray of the annotated point is followed to the depth Z of the mesh border point,
where the two points are Z sqrt((dx / fx)^2 + (dy / fy)^2) apart. In px, the unit is the pixel of the
photograph as stored.

Prints a line for each photograph and the means of each kind. A photograph without a solved shape has
no distance and is counted as failed. Exits 2 with place and fix if an input is wrong.
"""

import argparse
import csv
import json
import re
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
BORDERS = ROOT / "tests/data/inv3d_borders"
SOLVED = ("estimated", "weak")
STEP_PX = 1.0  # between samples of a border, in px of the photograph
COLUMNS = ["document", "photograph", "kind", "state", "mean_mm", "mean_px", "p95_mm", "worst_mm"]


class WrongInput(Exception):
    """An input that cannot be used: its place, what is wrong and what to do."""


class Photograph(NamedTuple):
    kind: str
    size_px: tuple[int, int]   # width and height as stored
    polylines: list[np.ndarray]  # each [N,2] px of the photograph; closed ones repeat their first point


class Camera(NamedTuple):
    focal_px: np.ndarray   # [2] fx, fy
    centre_px: np.ndarray  # [2] cx, cy
    size_px: tuple[int, int]


class Border(NamedTuple):
    """A closed loop in the image: segment i leads from point i to point i + 1, the last to the first."""
    points_px: np.ndarray  # [N,2] px of the photograph
    depth_m: np.ndarray    # [N] m


class Distances(NamedTuple):
    mm: np.ndarray  # [M]
    px: np.ndarray  # [M]


def rows_of(file: Path, columns: list[str]) -> list[dict[str, str]]:
    try:
        with file.open(newline="") as lines:
            reader = csv.DictReader(lines)
            if reader.fieldnames != columns:
                raise WrongInput(f"{file}:1: columns {reader.fieldnames}; write {','.join(columns)}")
            return list(reader)
    except OSError as error:
        raise WrongInput(f"{file}: {error.strerror}; name a folder of annotated borders with --borders")


def number(text: str, place: str) -> float:
    try:
        value = float(text)
    except (TypeError, ValueError):
        value = np.nan
    if not np.isfinite(value):
        raise WrongInput(f"{place}: '{text}' is no finite number; correct the line")
    return value


def photographs_of(folder: Path) -> dict[tuple[str, str], Photograph]:
    """The annotated photographs by document and name."""
    found = {}
    file = folder / "photographs.csv"
    for line, row in enumerate(rows_of(file, ["document", "photograph", "kind", "width_px", "height_px"]), 2):
        place = f"{file}:{line}"
        size = (int(number(row["width_px"], place)), int(number(row["height_px"], place)))
        if min(size) < 1:
            raise WrongInput(f"{place}: an image of {size[0]} x {size[1]} px; correct the line")
        found[row["document"], row["photograph"]] = Photograph(row["kind"], size, [])
    points: dict[tuple[str, str, str], list[list[float]]] = {}
    for line, row in enumerate(rows_of(folder / "borders.csv",
                                       ["document", "photograph", "polyline", "x_px", "y_px"]), 2):
        place = f"{folder / 'borders.csv'}:{line}"
        if (row["document"], row["photograph"]) not in found:
            raise WrongInput(f"{place}: photographs.csv has no {row['document']}, {row['photograph']}; "
                             "add its line")
        points.setdefault((row["document"], row["photograph"], row["polyline"]), []).append(
            [number(row["x_px"], place), number(row["y_px"], place)])
    for (document, photograph, polyline), each in points.items():
        if len(each) < 2:
            raise WrongInput(f"{folder / 'borders.csv'}: polyline {polyline} of {document}, {photograph} has "
                             "one point; a polyline needs two")
        found[document, photograph].polylines.append(np.array(each))
    return {key: each for key, each in found.items() if each.polylines}


def document_of(run: Path, documents: set[str]) -> str:
    """The document whose folder is in the path of the run's source."""
    file = run / "pipeline.yaml"
    try:
        source = file.read_text().split("source:", 1)[-1].split("\ntemplate:", 1)[0]
    except OSError as error:
        raise WrongInput(f"{file}: {error.strerror}; name the folder of a run")
    named = {part for path in re.findall(r"path: *(\S+)", source) for part in path.strip("\"'").split("/")}
    if len(named & documents) != 1:
        raise WrongInput(f"{file}: the path of the source names no annotated document, or several; "
                         f"use --document with one of {', '.join(sorted(documents))}")
    return (named & documents).pop()


def arrays_of(file: Path, names: list[str]) -> list[np.ndarray]:
    try:
        with np.load(file) as records:
            return [records[name] for name in names]
    except (OSError, ValueError, KeyError) as error:
        raise WrongInput(f"{file}: {error}; run the pipeline again")


def camera_of(run: Path) -> Camera:
    fx, fy, cx, cy, width, height = arrays_of(
        run / "template.npz", [f"camera/{name}" for name in ("fx", "fy", "cx", "cy", "width", "height")])
    return Camera(np.array([fx, fy], float), np.array([cx, cy], float), (int(width), int(height)))


def edges_of_border(faces: np.ndarray, welded_vertex: np.ndarray | None) -> np.ndarray:
    """[E,2] directed edges with one face. The two sides of a seam in the texture are one edge."""
    faces = faces if welded_vertex is None else welded_vertex[faces]
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    _, place, count = np.unique(np.sort(directed, axis=1), axis=0, return_inverse=True, return_counts=True)
    return directed[count[place.ravel()] == 1]


def longest_loop(edges: np.ndarray, vertices_m: np.ndarray) -> list[int]:
    """The vertices of the longest closed loop that directed edges form on the template at rest."""
    following = dict(edges.tolist())
    loops = []
    while following:
        first, at = following.popitem()
        loop = [first]
        while at != first and at in following:
            loop.append(at)
            at = following.pop(at)
        loops.append(loop)
    return max(loops, default=[], key=lambda loop: np.linalg.norm(
        vertices_m[loop] - vertices_m[np.roll(loop, -1)], axis=1).sum())


def loop_of_template(file: Path) -> list[int]:
    faces, rest_m = arrays_of(file, ["template/faces", "template/vertices_m"])
    with np.load(file) as records:
        welded = records["template/welded_vertex"] if "template/welded_vertex" in records else None
    return longest_loop(edges_of_border(faces, welded), rest_m)


def border_of(vertices_m: np.ndarray, camera: Camera, size_px: tuple[int, int]) -> Border:
    """The border with vertices [N,3] m in order, in px of the photograph."""
    if not np.isfinite(vertices_m).all() or vertices_m[:, 2].min() <= 0:
        raise ValueError("the mesh border is not in front of the camera")
    image_px = vertices_m[:, :2] / vertices_m[:, 2:] * camera.focal_px + camera.centre_px
    scale = np.array(camera.size_px) / np.array(size_px)
    return Border((image_px + 0.5) / scale - 0.5, vertices_m[:, 2])


def sampled(points: np.ndarray, closed: bool) -> tuple[np.ndarray, np.ndarray]:
    """[M,2] samples in the middle of equal pieces of a polyline, and [M] places in units of segments."""
    corners = np.concatenate([points, points[:1]]) if closed else points
    arc = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(corners, axis=0), axis=1))])
    count = max(1, round(arc[-1] / STEP_PX))
    at = (np.arange(count) + 0.5) * arc[-1] / count
    place = np.interp(at, arc, np.arange(len(arc)))
    return np.stack([np.interp(at, arc, corners[:, axis]) for axis in (0, 1)], axis=1), place


def nearest(points: np.ndarray, begins: np.ndarray,
            ends: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """For each point the nearest one on segments: [M,2] itself, [M] its segment and its share of it."""
    along = ends - begins
    squared = np.maximum((along ** 2).sum(axis=1), 1e-12)
    foot, segment, share = np.empty_like(points), np.empty(len(points), int), np.empty(len(points))
    for first in range(0, len(points), 1000):  # bounds the memory
        part = points[first:first + 1000]
        shares = np.clip(((part[:, None] - begins) * along).sum(axis=2) / squared, 0, 1)
        feet = begins + shares[:, :, None] * along
        best = ((part[:, None] - feet) ** 2).sum(axis=2).argmin(axis=1)
        rows = np.arange(len(part))
        foot[first:first + 1000], segment[first:first + 1000] = feet[rows, best], best
        share[first:first + 1000] = shares[rows, best]
    return foot, segment, share


def depth_at(border: Border, segment: np.ndarray, share: np.ndarray) -> np.ndarray:
    """[M] m. Along a straight edge in space the inverse depth is linear in the image."""
    inverse = 1 / border.depth_m
    return 1 / ((1 - share) * inverse[segment] + share * np.roll(inverse, -1)[segment])


def distances(offset_px: np.ndarray, depth_m: np.ndarray, photo_px_by_rad: np.ndarray) -> Distances:
    return Distances(1000 * depth_m * np.linalg.norm(offset_px / photo_px_by_rad, axis=1),
                     np.linalg.norm(offset_px, axis=1))


def is_faced(count: int, places: list[np.ndarray], at: np.ndarray) -> np.ndarray:
    """[M] whether a place on a loop of `count` segments is between what consecutive samples meet."""
    faced = np.zeros(len(at), bool)
    for along in places:
        for begin, end in zip(along, along[1:]):
            turn = (end - begin + count / 2) % count - count / 2  # the shorter way around
            faced |= (at - min(begin, begin + turn)) % count <= abs(turn)
    return faced


def compare(border: Border, photograph: Photograph, camera: Camera) -> tuple[Distances, Distances]:
    """From the annotated border to that of the mesh, and from that of the mesh to the annotated one."""
    photo_px_by_rad = camera.focal_px * np.array(photograph.size_px) / np.array(camera.size_px)
    begins, ends = border.points_px, np.roll(border.points_px, -1, 0)
    offsets, depths, places = [], [], []
    for polyline in photograph.polylines:
        samples, _ = sampled(polyline, closed=False)
        foot, segment, share = nearest(samples, begins, ends)
        offsets.append(foot - samples)
        depths.append(depth_at(border, segment, share))
        places.append(segment + share)
    there = distances(np.concatenate(offsets), np.concatenate(depths), photo_px_by_rad)

    samples, at = sampled(border.points_px, closed=True)
    if not all(np.array_equal(each[0], each[-1]) for each in photograph.polylines):
        faced = is_faced(len(begins), places, at)
        samples, at = samples[faced], at[faced]
    foot, _, _ = nearest(samples, np.concatenate([each[:-1] for each in photograph.polylines]),
                         np.concatenate([each[1:] for each in photograph.polylines]))
    segment = np.minimum(at.astype(int), len(begins) - 1)
    back = distances(foot - samples, depth_at(border, segment, at - segment), photo_px_by_rad)
    return there, back


def row_of(there: Distances, back: Distances) -> dict[str, float]:
    both = np.concatenate([there.mm, back.mm])
    return {"mean_mm": (there.mm.mean() + back.mm.mean()) / 2,
            "mean_px": (there.px.mean() + back.px.mean()) / 2, "p95_mm": float(np.percentile(both, 95)),
            "worst_mm": float(both.max())}


def lines_of(run: Path) -> list[dict]:
    file = run / "frames.jsonl"
    try:
        return [json.loads(line) for line in file.read_text().splitlines()]
    except OSError as error:
        raise WrongInput(f"{file}: {error.strerror}; name the folder of a run")
    except json.JSONDecodeError as error:
        raise WrongInput(f"{file}: {error}; run the pipeline again")


def check_size(run: Path, stem: str, camera: Camera, size_px: tuple[int, int]) -> None:
    scale = max(camera.size_px) / max(size_px)
    if any(abs(side * scale - scaled) > 1 for side, scaled in zip(size_px, camera.size_px)):
        raise WrongInput(f"{run}: frames of {camera.size_px[0]} x {camera.size_px[1]} px, but {stem} has "
                         f"{size_px[0]} x {size_px[1]} px; run photographs of different sizes one by one")


def measure(run: Path, borders: dict[tuple[str, str], Photograph], document: str | None) -> list[dict]:
    """A row for each annotated photograph of the run."""
    document = document or document_of(run, {each for each, _ in borders})
    names = [name for each, name in borders if each == document]
    loop = loop_of_template(run / "template.npz")
    if not loop:
        raise WrongInput(f"{run}: its template is a closed surface without a border; use another template")
    camera = camera_of(run)
    rows = []
    for line in lines_of(run):
        name = next((each for each in names if f"_{line['stem']}".endswith(f"_{each}")), None)
        if name is None:
            continue
        photograph = borders[document, name]
        check_size(run, line["stem"], camera, photograph.size_px)
        row = {"document": document, "photograph": name, "kind": photograph.kind, "state": line["state"]}
        rows.append(row)
        if line["state"] not in SOLVED:
            continue
        vertices, = arrays_of(run / "frames" / f"{line['frame']:06}.npz", ["shape/vertices_m"])
        try:
            border = border_of(vertices[loop], camera, photograph.size_px)
        except ValueError as error:
            print(f"warning: {run}: {name}: {error}; it counts as failed", file=sys.stderr)
            continue
        row.update(row_of(*compare(border, photograph, camera)))
    if not rows:
        raise WrongInput(f"{run}: no frame is an annotated photograph of {document}; annotated are "
                         f"{', '.join(sorted(names)) or 'none'}")
    return rows


def texts_of(row: dict) -> list[str]:
    return [f"{row[name]:.2f}" if isinstance(row.get(name), float) else str(row.get(name, "-"))
            for name in COLUMNS]


def report(rows: list[dict]) -> None:
    print("  ".join(f"{name:>18}" if name == "photograph" else f"{name:>11}" for name in COLUMNS))
    for row in rows:
        print("  ".join(f"{text:>18}" if name == "photograph" else f"{text:>11}"
                        for name, text in zip(COLUMNS, texts_of(row))))
    for kind in sorted({row["kind"] for row in rows}):
        of_kind = [row for row in rows if row["kind"] == kind]
        solved = [row for row in of_kind if "mean_mm" in row]
        means = "" if not solved else (f", mean {np.mean([row['mean_mm'] for row in solved]):.2f} mm, "
                                       f"{np.mean([row['mean_px'] for row in solved]):.1f} px")
        print(f"{kind}: {len(of_kind)} photographs, {len(of_kind) - len(solved)} failed{means}")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="+", type=Path, help="folder of a run")
    parser.add_argument("--borders", type=Path, default=BORDERS, help="folder with the annotated borders")
    parser.add_argument("--document", help="annotated document that the runs show")
    parser.add_argument("--csv", type=Path, help="file for the lines of the photographs")
    options = parser.parse_args(arguments)
    try:
        borders = photographs_of(options.borders)
        rows = [row for run in options.run for row in measure(run, borders, options.document)]
        if options.csv:
            with options.csv.open("w", newline="") as file:
                writer = csv.writer(file)
                writer.writerows([COLUMNS, *map(texts_of, rows)])
    except WrongInput as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror}; name another file with --csv", file=sys.stderr)
        return 2
    report(rows)
    return 0


if __name__ == "__main__":
    sys.exit(main())
