# SPDX-License-Identifier: Apache-2.0
"""The results folder of an ablation; docs/results.md says what it holds and which lines count."""

from __future__ import annotations

import dataclasses
import json
import os
import pathlib
from collections import Counter
from collections.abc import Iterator
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray
from weft.programs import notebooks
from weft.programs.errors import Error
from weft.programs.metrics import metric_at, read_json, whole_lines

KEY_DIGITS = 32
MOST_ROWS = 12  # of means in a notebook
CHECK = (b',"check":"', b'"}')


def open_results(path: str | os.PathLike[str]) -> Results:
    """The Results in a folder that `weft ablate` wrote, finished or not. Raises Error where it is none."""
    return Results(path)


@dataclasses.dataclass(frozen=True)
class Cell:
    """One cell of an ablation.

    `axes` has its value of each axis, a dict; `sequence` and `seed` say on what it ran. `outcome` is "done",
    "failed" or "missing", where it has not been run; `reason` that of a failure. `metrics` is what `weft eval
    --json` says of a run, None where there is nothing. `line` is its whole line, `folder` that of its files.
    """

    axes: dict[str, str]
    sequence: str
    seed: int
    key: str
    outcome: str
    reason: str = ""
    metrics: dict[str, Any] | None = dataclasses.field(default=None, repr=False)
    line: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)
    folder: pathlib.Path | None = dataclasses.field(default=None, repr=False)

    def metric(self, path: str) -> float:
        """The number of this path (`weft metrics` lists them); NaN where it is unknown, and of a cell that is
        not done, which enters no mean."""
        if self.outcome != "done" or self.metrics is None:
            return float("nan")
        return metric_at(self.metrics, path)


class Results:
    """The results of an ablation: `len(results)` cells in the order of the plan, `for cell in results`.

    `path` is the folder, `manifest` and `plan` what its files say, `cells` the list of all cells, `axes` the
    values of each axis by its name. `damaged` names lines that were changed after they were written: their
    cells are missing. `unchecked` counts lines of which nobody can tell: those of old programs, and all where
    Python lacks xxhash (Debian: python3-xxhash).
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)
        if not (self.path / "manifest.json").is_file() or not (self.path / "results").is_dir():
            raise Error("is no results folder: it has no manifest.json or no folder results", str(self.path),
                        "not_found")
        self.manifest = read_json(self.path / "manifest.json")
        if self.manifest.get("schema") != "weft.results/1":
            raise Error(f"has the schema '{self.manifest.get('schema')}', not weft.results/1",
                        str(self.path / "manifest.json"), "incompatible")
        self.plan = read_json(self.path / "plan.json")
        self.damaged: list[str] = []
        self.unchecked = 0
        lines = self._lines()
        self.cells = [self._cell(each, lines.get(each["key"])) for each in self.plan["cells"]]

    def __repr__(self) -> str:
        return f"Results('{self.path}', {len(self)} cells)"

    def _repr_html_(self) -> str:
        counts = Counter(each.outcome for each in self.cells)
        rows = [("cells", ", ".join(f"{count} {outcome}" for outcome, count in counts.items())),
                *((name, ", ".join(values)) for name, values in self.axes.items()),
                ("damaged", len(self.damaged) or "")]
        paths = self.plan["show"]
        means = [(f"{axis} = {value}", *(self._mean(path, axis, value) for path in paths))
                 for axis, values in self.axes.items() for value in values]
        more = [[f"and {len(means) - MOST_ROWS} more"]] if len(means) > MOST_ROWS else []
        table = notebooks.table(["mean of cells", *paths], [*means[:MOST_ROWS], *more]) if paths and means else ""
        return notebooks.titled(f"Results {self.path}", notebooks.facts(rows) + table)

    def _mean(self, path: str, axis: str, value: str) -> str:
        found = [each.metric(path) for each in self.cells if each.axes[axis] == value]
        known = [each for each in found if not np.isnan(each)]
        return f"{np.mean(known):.4g}" if known else ""

    def __len__(self) -> int:
        return len(self.cells)

    @overload
    def __getitem__(self, index: int) -> Cell: ...
    @overload
    def __getitem__(self, index: slice) -> list[Cell]: ...

    def __getitem__(self, index: int | slice) -> Cell | list[Cell]:
        return self.cells[index]

    def __iter__(self) -> Iterator[Cell]:
        return iter(self.cells)

    @property
    def axes(self) -> dict[str, list[str]]:
        """Values of each axis by its name, in the order of the plan."""
        return {each["name"]: list(each["values"]) for each in self.plan["axes"]}

    def where(self, **axes: str | int) -> list[Cell]:
        """The cells with these values: `where(filter="aem", seed=1)`; `sequence` and `seed` count as axes."""
        known = {*self.axes, "sequence", "seed"}
        for name in axes:
            if name not in known:
                raise Error(f"has no axis '{name}'; it has: {', '.join(sorted(known))}", str(self.path), "not_found")
        return [each for each in self.cells
                if all({**each.axes, "sequence": each.sequence, "seed": each.seed}[name] == value
                       for name, value in axes.items())]

    def metric(self, path: str, **axes: str | int) -> NDArray[np.float64]:
        """A number of all cells, or of those with these values, [N]: "all.error_solved.mean_mm". NaN where it is
        unknown, and of cells that are not done."""
        return np.array([each.metric(path) for each in self.where(**axes)], np.float64)

    def table(self, *paths: str) -> list[dict[str, Any]]:
        """A dict for each cell: its axes, `sequence`, `seed`, `outcome` and the metrics of these paths, by
        default those that the plan wants in its table. `pandas.DataFrame(results.table())` takes it as it is."""
        return [{**each.axes, "sequence": each.sequence, "seed": each.seed, "outcome": each.outcome,
                 **{path: each.metric(path) for path in paths or self.plan["show"]}} for each in self.cells]

    def _cell(self, planned: dict[str, Any], line: dict[str, Any] | None) -> Cell:
        common = (dict(planned["axes"]), planned["sequence"], planned["seed"], planned["key"])
        if line is None:
            return Cell(*common, "missing")
        return Cell(*common, outcome_of(line), line["reason"], line["metrics"], line,
                    self.path / "cells" / planned["key"])

    def _lines(self) -> dict[str, dict[str, Any]]:
        """The line that counts of each key: the first one that was not withdrawn and is what was written."""
        files = sorted((self.path / "results").glob("*.jsonl"), key=lambda file: file.name)
        withdrawals = [each for each in files if each.name.startswith("withdrawn-")]
        withdrawn: set[tuple[str, int]] = set()
        lines: dict[str, dict[str, Any]] = {}
        for file in withdrawals:
            for _, line in self._trusted(file, set()):
                withdrawn.add((line["file"], line["line"]))
        for file in files:
            if file in withdrawals:
                continue
            for place, line in self._trusted(file, withdrawn):
                if line.get("schema") not in ("weft.cell/1", "weft.cell/2"):
                    raise Error(f"has the schema '{line.get('schema')}', which this Weft does not know", place,
                                "incompatible")
                lines.setdefault(line["key"], line)
        return lines

    def _trusted(self, file: pathlib.Path, withdrawn: set[tuple[str, int]]
                 ) -> Iterator[tuple[str, dict[str, Any]]]:
        for number, text in enumerate(whole_lines(file), 1):
            if (file.name, number) in withdrawn:
                continue
            place, check = f"{file}:{number}", check_of(text)
            if check is False:
                self.damaged.append(f"{place}: it was changed after it was written")
                continue
            try:
                line = json.loads(text)
            except ValueError as mistake:
                self.damaged.append(f"{place}: it is no JSON: {mistake}")
                continue
            self.unchecked += check is None
            yield place, line


def outcome_of(line: dict[str, Any]) -> str:
    """Old programs called a cell done although frames had an error."""
    counts = (line["metrics"] or {}).get("counts", {})
    if line["schema"] == "weft.cell/1" and line["outcome"] == "done" and counts.get("failed", 0) > 0:
        return "failed"
    return str(line["outcome"])


def check_of(text: bytes) -> bool | None:
    """Whether a line is what was written; None where that cannot be told."""
    start, end = CHECK
    size = len(start) + KEY_DIGITS + len(end)
    tail = text[-size:]
    if len(text) <= size or not tail.startswith(start) or not tail.endswith(end):
        return None
    try:
        import xxhash
    except ImportError:
        return None
    return bool(xxhash.xxh3_128_hexdigest(text[:-size] + b"}").encode() == tail[len(start):-len(end)])
