# SPDX-License-Identifier: Apache-2.0
"""A pipeline in a program: images go in, shapes come out."""

from __future__ import annotations

import dataclasses
import functools
import json
import os
import pathlib
from collections.abc import Iterable, Mapping
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray
from weft.programs import notebooks
from weft.programs.errors import Error
from weft.programs.geometry import Camera, Template
from weft.programs.inputs import KnownPoints, Lens, Matches

# `lib` of the tree in which this package stands, installed or built.
LIB = pathlib.Path(os.path.abspath(__file__)).parents[4]


@dataclasses.dataclass(frozen=True)
class Stage:
    """What a stage came to: its `name` (`as`, else its role), its `status` ("ok", "degenerate", "no_result",
    "error" or "skipped"), the `reason` of anything but ok, and `ms`, the time that it took."""

    name: str
    status: str
    reason: str
    ms: float


@dataclasses.dataclass(frozen=True, eq=False)
class Frame:
    """What came of one image.

    `index` counts images from 0. `state` is "estimated", "weak", "predicted", "lost" or "none"; `confidence` is
    0 to 1. Of the latest shape: `vertices_m` [V,3] m, camera frame, and `faces` [F,3]; `age_frames` since it was
    measured;
    `source` uint8 [V], 1 measured, 0 filled in by the prior; `covariance_m2` [V,3,3] m², or None;
    `diagnostics`, numbers and arrays by name. Before the first shape `vertices_m` and `source` are None.
    `failed`: a stage had an error. `stages` and `warnings` say what each came to, and what it warned of.
    The arrays are the frame's own: nothing writes into them again.
    """

    index: int
    state: str
    confidence: float
    failed: bool
    stages: list[Stage]
    warnings: list[str]
    report_json: str = dataclasses.field(repr=False)
    age_frames: int = 0
    vertices_m: NDArray[np.float64] | None = dataclasses.field(default=None, repr=False)
    source: NDArray[np.uint8] | None = dataclasses.field(default=None, repr=False)
    covariance_m2: NDArray[np.float64] | None = dataclasses.field(default=None, repr=False)
    diagnostics: dict[str, Any] = dataclasses.field(default_factory=dict, repr=False)
    faces: NDArray[np.int32] | None = dataclasses.field(default=None, repr=False)

    def _repr_html_(self) -> str:
        stages = [(each.name, each.status, notebooks.milliseconds(each.ms), each.reason) for each in self.stages]
        return notebooks.frame(f"Frame {self.index}", self, stages, self.faces)

    @functools.cached_property
    def report(self) -> dict[str, Any]:
        """All counts and times of the stages: the line that `weft run` would write into frames.jsonl, as a
        dict."""
        found: dict[str, Any] = json.loads(self.report_json)
        return found


class Pipeline:
    """A pipeline, from the file that `weft run` takes; what that says of source and sinks is not looked at.

        with weft.Pipeline("pipeline.yaml", camera, set={"solvers.iterations": 100}) as pipeline:
            for image in images:
                frame = pipeline.process(image)

    `camera` took the images: a Camera, undistorted, or a Lens, as they come. `inputs` names what process() gets
    beside images, "matches" and "known_points"; stages read only what is named. `set` is laid over the file, as by `weft run --set`. Plugins are
    looked for in the folders `plugin_path`, then in WEFT_PLUGIN_PATH, then where Weft is installed; `worker`
    is the program weft-worker, where it is not the installed one. Image n is taken to be of the time n / `fps`, in
    s, unless process() is told its own.

    Opening takes seconds, for detectors look at the texture. Raises Error with the place of each mistake.
    One thread at a time may use it; different pipelines work at the same time in threads of their own.
    """

    def __init__(self, file: str | os.PathLike[str], camera: Camera | Lens, *, set: Mapping[str, Any] | None = None,
                 inputs: Iterable[str] = (),
                 plugin_path: str | os.PathLike[str] | Iterable[str | os.PathLike[str]] = (),
                 worker: str | os.PathLike[str] | None = None, fps: float = 30.0) -> None:
        self._lens = camera if isinstance(camera, Lens) else None
        camera = camera.camera if isinstance(camera, Lens) else camera
        if not isinstance(camera, Camera):
            raise TypeError(f"camera must be a weft.Camera or a weft.Lens, not {type(camera).__name__}; "
                            "make one of a camera matrix with weft.Camera.of_matrix()")
        if not fps > 0:
            raise ValueError(f"fps must be above 0, not {fps}")
        self._camera, self._fps, self._images = camera, float(fps), 0
        folders = [plugin_path] if isinstance(plugin_path, (str, os.PathLike)) else plugin_path
        self._opened = compiled().OpenedPipeline(
            os.fspath(file), dataclasses.astuple(camera), settings_of(set or {}),
            [*(os.fspath(each) for each in folders), *installed_plugins()], slots_of(inputs),
            os.fspath(worker or installed_worker()))
        self._template = Template(**self._opened.template())

    @property
    def camera(self) -> Camera:
        """The camera that took the images."""
        return self._camera

    @property
    def template(self) -> Template:
        """The object at rest, whose faces are those of every shape; it stays when the pipeline is closed."""
        return self._template

    def process(self, image: NDArray[np.uint8] | None = None, t_s: float | None = None, *,
                matches: Matches | None = None, known_points: KnownPoints | None = None) -> Frame:
        """Runs all stages on an image of the camera's size, uint8 [H,W] grey levels or [H,W,3] BGR, and answers its
        Frame. `t_s`: seconds since the first image. `matches` and `known_points` need their names in `inputs`; with
        one of them there need be no image. A stage without a required input is skipped.

        The image is read while other threads of Python go on: leave it alone until process() returns, then it is
        yours again. An image that cannot be one of the camera raises TypeError or Error, and counts for nothing.
        What stages do not find, or do not manage, is a Frame that says so. Ctrl-C acts when the image is done.
        """
        has_others = matches is not None or known_points is not None
        pixels = None if image is None and has_others else pixels_of(image)
        for name, given, kind in (("matches", matches, Matches), ("known_points", known_points, KnownPoints)):
            if given is not None and not isinstance(given, kind):
                raise TypeError(f"{name} must be a weft.{kind.__name__}, not {type(given).__name__}")
        frame = self._opened.process(pixels, self._images / self._fps if t_s is None else float(t_s),
                                     matches.arrays if matches is not None else None,
                                     known_points.arrays if known_points is not None else None,
                                     self._lens.made if self._lens is not None else None)
        self._images += 1
        frame["stages"] = [Stage(*each) for each in frame["stages"]]
        return Frame(**frame, faces=self._template.faces)

    def close(self) -> None:
        """Ends its threads and processes; waits for an image that another thread has in work. Frames stay."""
        self._opened.close()

    def __enter__(self) -> Pipeline:
        return self

    def __exit__(self, thrown: type[BaseException] | None, value: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


def compiled() -> Any:
    """The compiled part of the package."""
    try:
        from weft.programs import _pipeline
    except ImportError as missing:
        raise ImportError(
            "weft.Pipeline needs the compiled part of this package, which is not there for this Python: build Weft "
            f"with pybind11 (Debian: pybind11-dev), or use the Python that it was built for ({missing})") from None
    return _pipeline


def slots_of(inputs: Iterable[str]) -> list[str]:
    """The names of the library for those of process()."""
    names = {"matches": "correspondences", "known_points": "known_points"}
    given = [inputs] if isinstance(inputs, str) else list(inputs)
    for each in given:
        if each not in names:
            raise Error(f"{each!r} is no input; there are " + " and ".join(map(repr, names)), "inputs", "invalid_value")
    return [names[each] for each in given]


def pixels_of(image: Any) -> NDArray[np.uint8]:
    """The image as the library reads it: a copy only where elements of a row lie apart."""
    if image is None:
        raise TypeError("the image is None: where it was to be read, it was not found")
    pixels = np.asarray(image)
    if pixels.dtype != np.uint8:
        raise TypeError(f"an image has grey levels of uint8, 0 to 255, this one {pixels.dtype}; "
                        "scale it, then .astype(np.uint8)")
    if pixels.ndim == 0 or not pixels[:1].flags.c_contiguous or pixels.strides[0] < pixels[:1].nbytes:
        pixels = np.ascontiguousarray(pixels)
    return pixels


def settings_of(settings: Mapping[str, Any]) -> list[str]:
    """`path=value` with the value as YAML, which JSON is."""
    return [f"{path}={value_text(path, value)}" for path, value in settings.items()]


def value_text(path: str, value: Any) -> str:
    if isinstance(value, (np.generic, np.ndarray)):
        value = value.tolist()
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    try:
        return json.dumps(value, allow_nan=False)
    except (TypeError, ValueError):
        raise Error(f"cannot be {value!r}: a value is a finite number, text, True or False, or a list or dict of "
                    "these", f"set {path}", "invalid_value") from None


def installed_plugins() -> list[str]:
    """Folders of plugins behind those that were named."""
    named = [each for each in os.environ.get("WEFT_PLUGIN_PATH", "").split(os.pathsep) if each]
    own = LIB / "weft" / "plugins"
    return named + ([str(own)] if own.is_dir() else [])


def installed_worker() -> str:
    own = LIB.parent / "bin" / "weft-worker"
    return str(own) if own.is_file() else ""
