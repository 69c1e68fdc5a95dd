# SPDX-License-Identifier: Apache-2.0
"""Weft, the 3D shape of a deforming surface from one camera and a template, in Python.

Programs open pipelines, read folders of runs and ablations and draw meshes (docs/python_module.md);
components derive from the class of their role (docs/python.md).
"""

import importlib

from weft.answers import Cancelled, Degenerate, Failure, NoMoreFrames, NoResult, degenerate
from weft.parameters import (choice, component, deprecated, flag, formerly, input_path, labels, number,
                             numbers, output_path, prominent, text, texts, whole, wholes)
from weft.records import Record
from weft.roles import (Detector, Filter, Matcher, Pass, Sink, Solver, Source, TemplateBuilder,
                        WarpModel)

# The parts of components in Python, which their libraries contain.
__all__ = [
    "Cancelled", "Degenerate", "Detector", "Failure", "Filter", "Matcher", "NoMoreFrames", "NoResult", "Pass",
    "Record", "Sink", "Solver", "Source", "TemplateBuilder", "WarpModel", "choice", "component",
    "degenerate", "deprecated", "flag", "formerly", "input_path", "labels", "number", "numbers", "output_path",
    "prominent", "text", "texts", "whole", "wholes",
]

# Names for programs, by the module of weft.programs that has them. A module is imported at the first
# access, so that a component needs neither it nor its compiled parts.
_OF_PROGRAMS = {
    "Camera": "geometry", "Cell": "results", "Error": "errors", "Frame": "pipelines",
    "KnownPoints": "inputs", "Lens": "inputs", "Matches": "inputs", "Pipeline": "pipelines", "Results": "results", "Run": "runs", "RunFrame": "runs",
    "Stage": "pipelines", "Template": "geometry", "draw": "drawing", "open_results": "results",
    "open_run": "runs",
}


def __getattr__(name):
    if name not in _OF_PROGRAMS:
        raise AttributeError(f"module 'weft' has no attribute '{name}'")
    try:
        module = importlib.import_module(f"weft.programs.{_OF_PROGRAMS[name]}")
    except ModuleNotFoundError as missing:
        if not (missing.name or "").startswith("weft.programs"):
            raise
        raise AttributeError(f"weft.{name} is for programs; inside of a component it is not there") from None
    globals()[name] = getattr(module, name)
    return globals()[name]


def __dir__():
    return sorted({*globals(), *_OF_PROGRAMS})
