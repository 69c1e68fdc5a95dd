# SPDX-License-Identifier: Apache-2.0
"""The folder of a run, as `weft run` leaves it; docs/concepts.md says what it holds."""

from __future__ import annotations

import dataclasses
import functools
import json
import os
import pathlib
from collections.abc import Iterator
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray
from weft.programs import notebooks
from weft.programs.errors import Error
from weft.programs.geometry import Camera, Template
from weft.programs.metrics import metric_at, read_json, whole_lines


def open_run(path: str | os.PathLike[str]) -> Run:
    """The Run in a folder that `weft run` wrote. Raises Error where it is none, or its files are damaged."""
    return Run(path)


class RunFrame:
    """One frame of a run: its line in frames.jsonl, and its arrays, read when they are first asked for.

    `frame["matchers.correspondences/image_px"]` is any array, by the names of `names`.
    """

    def __init__(self, line: dict[str, Any], file: pathlib.Path, run: Run) -> None:
        self._line, self._file, self._run = line, file, run

    def __repr__(self) -> str:
        return f"RunFrame({self.index}, '{self.stem}', {self.state})"

    def _repr_html_(self) -> str:
        stages = [(each["stage"], each["status"], notebooks.milliseconds(each.get("ms", np.nan)),
                   each.get("reason", "")) for each in self._line["stages"]]
        faces = self._run.template.faces if self.vertices_m is not None else None
        return notebooks.frame(f"Frame {self.index} {self.stem}", self, stages, faces)

    @property
    def index(self) -> int:
        """Its number in the source, from 0."""
        return int(self._line["frame"])

    @property
    def stem(self) -> str:
        """Name of its image, without folder and extension."""
        return str(self._line["stem"])

    @property
    def state(self) -> str:
        """ "estimated", "weak", "predicted", "lost" or "none"."""
        return str(self._line["state"])

    @property
    def age_frames(self) -> int:
        """Frames since its shape was measured."""
        return int(self._line["age"])

    @property
    def confidence(self) -> float:
        """0 to 1; 0 without a shape."""
        return float(self._line["confidence"] or 0.0)

    @property
    def failed(self) -> bool:
        """Whether a stage had an error."""
        return bool(self._line["failed"])

    @property
    def report(self) -> dict[str, Any]:
        """Its line in frames.jsonl, a dict."""
        return self._line

    @property
    def names(self) -> list[str]:
        """Names of the arrays that were kept of it, "RECORD/ARRAY"."""
        return list(self._arrays)

    @property
    def vertices_m(self) -> NDArray[np.float64] | None:
        """The shape's vertices [V,3] m, camera frame; None without a shape."""
        return self._arrays.get("shape/vertices_m")

    @property
    def source(self) -> NDArray[np.uint8] | None:
        """uint8 [V], 1 for vertices that were measured, 0 for those filled in by the prior; or None."""
        return self._arrays.get("shape/source")

    @property
    def covariance_m2(self) -> NDArray[np.float64] | None:
        """[V,3,3] m², camera frame, of each vertex; or None."""
        return self._arrays.get("shape/covariance_m2")

    @property
    def true_points_m(self) -> NDArray[np.float64] | None:
        """Points of the truth [P,3] m, camera frame; or None."""
        return self._arrays.get("ground_truth/points_m")

    def __contains__(self, name: object) -> bool:
        return name in self._arrays

    def __getitem__(self, name: str) -> NDArray[Any]:
        if name not in self._arrays:
            raise KeyError(f"frame {self.index} has no array '{name}'; it has: {', '.join(self.names)}")
        return self._arrays[name]

    @functools.cached_property
    def _arrays(self) -> dict[str, NDArray[Any]]:
        return arrays_in(self._file) if self._file.exists() else {}


class Run:
    """A run: `len(run)` frames, `run[i]`, `for frame in run`. It reads the lines of the frames once, when it is
    opened; a run that goes on is read as far as it had come.

    `path` is its folder; `manifest` what manifest.json says (versions, seed, machine), `end` what end.json says,
    None where the run was killed or goes on.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = pathlib.Path(path)
        file = self.path / "frames.jsonl"
        if not file.is_file():
            raise Error("is no folder of a run: it has no frames.jsonl", str(self.path), "not_found")
        self.manifest = read_json(self.path / "manifest.json")
        end = self.path / "end.json"
        self.end = read_json(end) if end.exists() else None
        self._lines: list[dict[str, Any]] = []
        for number, line in enumerate(whole_lines(file), 1):
            try:
                self._lines.append(json.loads(line))
            except ValueError as mistake:
                raise Error(f"is no JSON: {mistake}", f"{file}:{number}", "syntax") from None

    def __repr__(self) -> str:
        return f"Run('{self.path}', {len(self)} frames)"

    def _repr_html_(self) -> str:
        names = [each["stage"] for each in self._lines[0]["stages"]] if self._lines else []
        times = [(name, float(np.nanmedian(ms))) for name in names if not np.isnan(ms := self.stage(name)).all()]
        with_shape = self.confidences[self.confidences > 0]
        try:
            errors = self.errors_mm
        except Error:  # it has not been measured, or has no truth
            errors = np.array([])
        rows = [("frames", len(self)), ("states", notebooks.states(self.states.tolist())),
                ("confidence", f"{np.median(with_shape):.2f} in the median" if len(with_shape) else ""),
                ("3D error", "" if np.isnan(errors).all() else
                 f"{np.nanmean(errors):.3g} mm in the mean, {np.nanmax(errors):.3g} mm at most"),
                ("median times", ", ".join(f"{name} {notebooks.milliseconds(ms)}" for name, ms in times))]
        return notebooks.titled(f"Run {self.path}", notebooks.facts(rows))

    def __len__(self) -> int:
        return len(self._lines)

    @overload
    def __getitem__(self, index: int) -> RunFrame: ...
    @overload
    def __getitem__(self, index: slice) -> list[RunFrame]: ...

    def __getitem__(self, index: int | slice) -> RunFrame | list[RunFrame]:
        if isinstance(index, slice):
            return [self[i] for i in range(*index.indices(len(self)))]
        line = self._lines[index]
        return RunFrame(line, self.path / "frames" / f"{line['frame']:06d}.npz", self)

    def __iter__(self) -> Iterator[RunFrame]:
        return (self[i] for i in range(len(self)))

    @property
    def states(self) -> NDArray[np.str_]:
        """State of each frame, an array of texts [N]."""
        return np.array([each["state"] for each in self._lines], dtype=str)

    @property
    def confidences(self) -> NDArray[np.float64]:
        """Confidence of each frame, [N], 0 to 1; 0 without a shape."""
        return np.array([each["confidence"] or 0.0 for each in self._lines], np.float64)

    def stage(self, name: str, number: str = "ms") -> NDArray[np.float64]:
        """A number of a stage in each frame, [N]: `ms` that it took, or a count that it gives in frames.jsonl,
        such as "matches" or "diag.rounds". NaN where it gave none."""
        if self._lines and not any(each["stage"] == name for line in self._lines for each in line["stages"]):
            known = [each["stage"] for each in self._lines[0]["stages"]]
            raise Error(f"has no stage '{name}'; it has: {', '.join(known)}", str(self.path), "not_found")
        none: dict[str, Any] = {}
        found = [next((each for each in line["stages"] if each["stage"] == name), none) for line in self._lines]
        return np.array([np.nan if each.get(number) is None else each[number] for each in found], np.float64)

    @functools.cached_property
    def metrics(self) -> dict[str, Any]:
        """What `weft eval` measured, a dict: metrics.json. Raises Error where it has not been run."""
        file = self.path / "metrics.json"
        if not file.exists():
            raise Error(f"has not been measured: run `weft eval {self.path}`", str(self.path), "not_found")
        return read_json(file)

    def metric(self, path: str) -> NDArray[np.float64]:
        """A number that `weft eval` measured in each frame, [N], by its path in an entry of
        `run.metrics["frames"]`: "truth.mean_mm", "reprojection_px". NaN where there is none."""
        measured = {each["frame"]: each for each in self.metrics["frames"]}
        values = np.full(len(self), np.nan)
        is_known = False
        for i, line in enumerate(self._lines):
            try:
                values[i] = metric_at(measured.get(line["frame"], {}), path)
                is_known = True
            except Error:  # a frame without truth has no numbers of it
                continue
        if len(self) and not is_known:
            raise Error(f"no frame has the number '{path}'", str(self.path / "metrics.json"), "not_found")
        return values

    @property
    def errors_mm(self) -> NDArray[np.float64]:
        """Mean 3D error of each frame in mm, [N]; NaN for frames without a shape of their own, or without truth."""
        solved = {each["frame"] for each in self.metrics["frames"] if each["outcome"] == "solved"}
        own = [line["frame"] in solved for line in self._lines]
        return np.where(own, self.metric("truth.mean_mm"), np.nan)

    @functools.cached_property
    def template(self) -> Template:
        """The object at rest, a Template."""
        names = [field.name for field in dataclasses.fields(Template)]
        arrays: dict[str, Any] = {name: self._template_arrays.get(f"template/{name}") for name in names}
        return Template(**arrays)

    @functools.cached_property
    def camera(self) -> Camera:
        """The camera of its images, a Camera."""
        numbers = [self._template_arrays[f"camera/{name}"].item()
                   for name in ("fx", "fy", "cx", "cy", "width", "height")]
        return Camera(*numbers)

    @functools.cached_property
    def _template_arrays(self) -> dict[str, NDArray[Any]]:
        return arrays_in(self.path / "template.npz")


def arrays_in(file: pathlib.Path) -> dict[str, NDArray[Any]]:
    """All arrays of a file, by name."""
    try:
        with np.load(os.fspath(file), allow_pickle=False) as arrays:
            return dict(arrays)
    except Exception as mistake:  # whatever a damaged archive makes of it
        code = "not_found" if isinstance(mistake, FileNotFoundError) else "io"
        raise Error(f"cannot be read: {mistake}", str(file), code) from None
