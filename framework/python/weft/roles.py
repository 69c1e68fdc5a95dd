# SPDX-License-Identifier: Apache-2.0
"""One class a role. A component derives from one, has an `id` and a `version`, and its docstring begins
with one sentence that says what it does.

Methods are called with `given`: its attributes are the inputs of the method (`given.correspondences`,
`given.previous_shape`), None where they are absent, and `given.call`.
"""

from __future__ import annotations

from typing import Any

from weft.parameters import parameters_of


class Component:
    """What a class may say of itself, as `kAbout` does in C++."""

    id = ""
    version = ""
    reference = ""  # paper or standard
    licence = "Apache-2.0"
    determinism = "exact"  # or "tolerance": the same up to rounding
    needs = ""  # inputs that are required beyond those of the role, separated by blanks
    reads = ""  # inputs that are used when present
    produces = ""  # sources and passes: which outputs of the role they make
    random = False  # draws from the seed
    uses_truth = False  # may read ground_truth
    # Over which a plan draws a ROC curve: ("max_deviation_px", [1, 2, 5, 10]).
    sweep: tuple[str, list[float]] | None = None
    role = ""
    methods: tuple[str, ...] = ()

    def __init__(self, **values: Any) -> None:
        declared = parameters_of(type(self))
        for name, value in values.items():
            if name not in declared:
                raise TypeError(f"{type(self).__name__} has no parameter '{name}'")
            declared[name].check(value)
        for name, parameter in declared.items():
            if name not in values and parameter.required:
                raise TypeError(f"{type(self).__name__} needs its parameter '{name}'")
            default = parameter.default
            if isinstance(default, (dict, list)):
                default = type(default)(default)
            setattr(self, name, values.get(name, default))

    def prepare(self, given: Any) -> None:
        """Called once before the first frame with `given.template` and `given.camera`; not for
        sources and templates. What is read or computed once belongs here."""


class Source(Component):
    """`open(given)` answers the camera, `count(given)` the number of frames, -1 if it is not known,
    and `read(given)` a dict of records by output for the frame `given.call.frame`."""

    role = "sources"
    methods = ("open", "count", "read")


class TemplateBuilder(Component):
    """`build(given)` answers the template."""

    role = "templates"
    methods = ("build",)


class Detector(Component):
    """`detect(given)` answers keypoints."""

    role = "detectors"
    methods = ("detect",)


class Matcher(Component):
    """`match(given)` answers correspondences; `given.correspondences` is a list."""

    role = "matchers"
    methods = ("match",)


class Filter(Component):
    """`filter(given)` answers an inlier mask: marks matches, and never drops or reorders them."""

    role = "filters"
    methods = ("filter",)


class WarpModel(Component):
    """`fit(given)` answers a warp, `evaluate(given)` samples of it, which depend on the record only."""

    role = "warps"
    methods = ("fit", "evaluate")


class Pass(Component):
    """`run(given)` answers a dict of records by output: sightlines, visibility,
    region, registration, object_mask."""

    role = "passes"
    methods = ("run",)


class Solver(Component):
    """`solve(given)` answers a shape. Whether it is estimated or weak is told by one rule for all
    solvers; what a solver calls weak itself stays so."""

    role = "solvers"
    methods = ("solve",)


class Sink(Component):
    """`open(given)`, `write(given)` for each frame, in their order, and `finish(given)`; answers of
    them are ignored."""

    role = "sinks"
    methods = ("open", "write", "finish")

    def open(self, given: Any) -> None:
        """Called once, after prepare()."""

    def finish(self, given: Any) -> None:
        """Called once after the last frame, also when the run failed."""
