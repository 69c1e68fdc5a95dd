#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits the confidence of solvers to shapes of which the truth is known: fit_confidence.py RESULTS
or tells how well confidences were kept:                          fit_confidence.py --check RESULTS

RESULTS is a folder of `weft ablate` whose plan has an axis `solver`, such as
pipelines/ablations/solver_confidence.yaml, and keeps its frames. A frame is right when the mean
error of what the camera sees is below 2 % of the template's diagonal.

Fitting prints for each solver the weights of solvers::ConfidenceWeights
(plugins/solvers/common/shape_signs.hpp), as C++: those of greatest likelihood with a penalty of half
their square, in units of the spread of their sign. A sign that would speak the wrong way round, such
as strain that makes surer, is left out. Values of the axis that name variants of one solver are
fitted together. Only frames without a filter count, for what filters say is a factor of its own.

--check prints one line of a table for each value of the axis: frames, right ones, silently wrong
ones (`estimated` and more than 20 mm off), `estimated` ones that are not right, Brier score; and
how often the confidences of all frames of a kind came true.

Exits 1 where a folder has no such frames; exits 2 on wrong usage.
"""

import ast
import json
import math
import struct
import sys
import zipfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

RIGHT_SHARE, WRONG_MM = 0.02, 20.0  # as in framework/lab/metrics/certainty_metrics.hpp
LEAST_OF_A_KIND = 10  # right and wrong frames, or there is nothing to fit
VARIANTS = {"chhatkuli_2014": "chhatkuli_stable", "chhatkuli_2017": "chhatkuli_stable"}
BINS = [0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0]
# Of each weight: what it weighs, of the scalars of a shape, and whether more of it speaks for it.
SIGNS = {
    "strain": (lambda d: math.log(d["strain"] + 1e-3), -1),
    "strain_p95": (lambda d: math.log(d["strain_p95"] + 1e-3), -1),
    "residual": (lambda d: math.log(d["kept_residual_px"] + 0.1), -1),
    "roughness": (lambda d: math.log(d["roughness_rad"] + 0.01), -1),
    "size": (lambda d: math.log(d["size_px"] + 1.0), 1),
    "agreeing": (lambda d: math.log(d["agreeing_matches"] + 1.0), 1),
    "share": (lambda d: math.log((d["agreeing_matches"] + 1.0) / (d["kept_matches"] + 1.0)), 1),
    "coverage": (lambda d: math.log(d["agreeing_coverage"] + 0.05), 1),
}


class Frame(NamedTuple):
    solver: str  # value of the axis
    scene: str
    confidence: float
    estimated: bool
    right: bool
    mean_mm: float
    signs: dict[str, float]  # empty where the solver does not tell them


def array_of(data: bytes) -> list[float]:
    """The numbers of a .npy file of 64-bit floats."""
    length = struct.unpack("<H", data[8:10])[0]
    header = ast.literal_eval(data[10:10 + length].decode())
    if header["descr"] != "<f8":
        raise ValueError(f"holds {header['descr']}, not 64-bit floats")
    body = data[10 + length:]
    return list(struct.unpack(f"<{len(body) // 8}d", body))


def signs_of(scalars: dict[str, float]) -> dict[str, float]:
    try:
        signs = {name: of(scalars) for name, (of, _) in SIGNS.items()}
    except KeyError:
        return {}
    return signs if all(map(math.isfinite, signs.values())) else {}


def diagonal_mm(vertices_m: list[float]) -> float:
    axes = [vertices_m[k::3] for k in range(3)]
    return 1000.0 * math.sqrt(sum((max(axis) - min(axis)) ** 2 for axis in axes))


def frames_of_cell(folder: Path, axes: dict[str, str], metrics: dict) -> Iterator[Frame]:
    if not (folder / "shapes.npz").exists():
        return  # no frame was solved
    with zipfile.ZipFile(folder / "shapes.npz") as file:
        names = file.namelist()
        diagonal = diagonal_mm(array_of(file.read("template/vertices_m.npy")))
        for frame in metrics["frames"]:
            if frame["outcome"] != "solved" or "seen_mm" not in frame or "mean_mm" not in frame["truth"]:
                continue
            start = f"{frame['frame']:06}.shape/diag."
            scalars = {}
            for name in names:
                if name.startswith(start) and file.getinfo(name).file_size <= 256:
                    numbers = array_of(file.read(name))
                    if len(numbers) == 1:
                        scalars[name[len(start):-len(".npy")]] = numbers[0]
            yield Frame(axes["solver"], axes.get("scene", ""), frame["confidence"],
                        frame["state"] == "estimated", frame["seen_mm"] < RIGHT_SHARE * diagonal,
                        frame["truth"]["mean_mm"], signs_of(scalars))


def frames_of(results: Path) -> list[Frame]:
    cells = {cell["key"]: cell["axes"]
             for cell in json.loads((results / "plan.json").read_text())["cells"]}
    frames: list[Frame] = []
    done = set()
    for path in sorted((results / "results").glob("*.jsonl")):
        for text in path.read_text().splitlines():
            line = json.loads(text)
            key = line.get("key")
            if line.get("outcome") != "done" or key not in cells or key in done:
                continue
            done.add(key)
            frames += frames_of_cell(results / "cells" / key, cells[key], line["metrics"])
    return frames


def logistic(logit: float) -> float:
    return 1.0 / (1.0 + math.exp(-logit)) if logit > -700.0 else 0.0


def solved(matrix: list[list[float]], right: list[float]) -> list[float]:
    """x of matrix x = right, a symmetric positive definite matrix, by elimination."""
    rows = [[*row, value] for row, value in zip(matrix, right)]
    for k, pivot in enumerate(rows):
        for row in rows[k + 1:]:
            factor = row[k] / pivot[k]
            for j in range(k, len(pivot)):
                row[j] -= factor * pivot[j]
    x = [0.0] * len(rows)
    for k in reversed(range(len(rows))):
        known = sum(rows[k][j] * x[j] for j in range(k + 1, len(rows)))
        x[k] = (rows[k][-1] - known) / rows[k][k]
    return x


def likeliest(inputs: list[list[float]], right: list[bool]) -> list[float]:
    """Weights [bias, ...] of a logistic of standardised inputs, by Newton's method."""
    rows = [[1.0, *row] for row in inputs]
    weights = [0.0] * len(rows[0])
    for _ in range(100):
        slope = [0.0 if k == 0 else -w for k, w in enumerate(weights)]
        curve = [[float(i == j) if i else 1e-9 * (j == 0) for j in range(len(weights))]
                 for i in range(len(weights))]
        for row, is_right in zip(rows, right):
            p = logistic(sum(w * x for w, x in zip(weights, row)))
            for i, x in enumerate(row):
                slope[i] += (is_right - p) * x
                for j in range(i + 1):
                    curve[i][j] += p * (1.0 - p) * x * row[j]
        for i, row in enumerate(curve):
            row[i + 1:] = [below[i] for below in curve[i + 1:]]
        step = solved(curve, slope)
        largest = max(map(abs, step))
        shrink = min(1.0, 2.0 / largest) if largest else 1.0
        weights = [w + shrink * s for w, s in zip(weights, step)]
        if largest < 1e-9:
            break
    return weights


def fit(frames: list[Frame]) -> dict[str, float]:
    """The bias and the weight of each sign, 0 for those that are left out."""
    names = list(SIGNS)
    right = [frame.right for frame in frames]
    while True:
        columns = [[frame.signs[name] for frame in frames] for name in names]
        means = [sum(column) / len(column) for column in columns]
        spreads = [math.sqrt(sum((x - m) ** 2 for x in column) / len(column)) or 1.0
                   for column, m in zip(columns, means)]
        inputs = [[(frame.signs[name] - m) / s for name, m, s in zip(names, means, spreads)]
                  for frame in frames]
        bias, *scaled = likeliest(inputs, right)
        wrong = {name: w * SIGNS[name][1] for name, w in zip(names, scaled)
                 if w * SIGNS[name][1] < 0.0}
        if not wrong:
            break
        names.remove(min(wrong, key=lambda name: wrong[name]))
    weights = {name: w / s for name, w, s in zip(names, scaled, spreads)}
    bias -= sum(weights[name] * m for name, m in zip(names, means))
    return {"bias": bias, **{name: weights.get(name, 0.0) for name in SIGNS}}


def confidence_by(weights: dict[str, float], frame: Frame) -> float:
    return logistic(weights["bias"] + sum(weights[name] * x for name, x in frame.signs.items()))


def brier(frames: list[Frame]) -> float:
    return sum((frame.confidence - frame.right) ** 2 for frame in frames) / len(frames)


def as_cpp(weights: dict[str, float]) -> str:
    return ", ".join(f".{name} = {w:.3f}" for name, w in weights.items() if w != 0.0)


def line_of(name: str, frames: list[Frame]) -> str:
    estimated = [frame for frame in frames if frame.estimated]
    silent = sum(frame.mean_mm > WRONG_MM for frame in estimated)
    cells = [f"`{name}`", len(frames), sum(frame.right for frame in frames), len(estimated), silent,
             sum(not frame.right for frame in estimated), f"{brier(frames):.3f}"]
    return "| " + " | ".join(map(str, cells)) + " |"


def bins_of(frames: list[Frame]) -> Iterator[str]:
    yield "| confidence | frames | mean said | came true |"
    yield "|---|---|---|---|"
    for low, high in zip(BINS, BINS[1:]):
        there = [f for f in frames if low <= f.confidence < high or f.confidence == high == 1.0]
        if not there:
            continue
        said = 100.0 * sum(frame.confidence for frame in there) / len(there)
        true = 100.0 * sum(frame.right for frame in there) / len(there)
        yield f"| {100 * low:.0f} to {100 * high:.0f} % | {len(there)} | {said:.0f} % | {true:.0f} % |"


def grouped(frames: list[Frame], variants: dict[str, str]) -> dict[str, list[Frame]]:
    groups = defaultdict(list)
    for frame in frames:
        groups[variants.get(frame.solver, frame.solver)].append(frame)
    return groups


def check(frames: list[Frame]) -> Iterator[str]:
    yield "| solver | frames | right | estimated | silently wrong | estimated, not right | Brier score |"
    yield "|---|---|---|---|---|---|---|"
    for name, group in grouped(frames, {}).items():
        yield line_of(name, group)
    for name, group in grouped(frames, VARIANTS).items():
        yield from ["", f"`{name}`", "", *bins_of(group)]


def fitted(frames: list[Frame]) -> Iterator[str]:
    told = [frame for frame in frames if frame.signs]
    for name, group in grouped(told, VARIANTS).items():
        right = sum(frame.right for frame in group)
        if min(right, len(group) - right) < LEAST_OF_A_KIND:
            yield f"{name}: {right} of {len(group)} frames are right, too few of a kind to fit"
            continue
        weights = fit(group)
        after = [f._replace(confidence=confidence_by(weights, f)) for f in group]
        yield f"{name}: {{{as_cpp(weights)}}}"
        yield (f"  {len(group)} frames, {right} right; Brier score {brier(after):.3f}, "
               f"{brier(group):.3f} as it was")


def main() -> int:
    arguments = sys.argv[1:]
    checks = "--check" in arguments
    folders = [argument for argument in arguments if argument != "--check"]
    if len(folders) != 1 or folders[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    try:
        frames = frames_of(Path(folders[0]))
    except OSError as error:
        print(f"fit_confidence.py: {error}: name a folder of weft ablate", file=sys.stderr)
        return 1
    lines = list(check(frames) if checks else fitted(frames))
    if not frames or not lines:
        print(f"fit_confidence.py: {folders[0]} has no solved frames with a truth and signs",
              file=sys.stderr)
        return 1
    print("\n".join(lines))
    return 0


if __name__ == "__main__":
    sys.exit(main())
