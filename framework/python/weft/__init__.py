# SPDX-License-Identifier: Apache-2.0
"""What components of Weft in Python are made of: docs/python.md."""

from weft.answers import Cancelled, Degenerate, Failure, NoMoreFrames, NoResult, degenerate
from weft.parameters import (choice, component, flag, input_path, labels, number, numbers,
                             output_path, text, texts, whole, wholes)
from weft.records import Record
from weft.roles import (Detector, Filter, Matcher, Pass, Sink, Solver, Source, TemplateBuilder,
                        WarpModel)

__all__ = [
    "Cancelled", "Degenerate", "Detector", "Failure", "Filter", "Matcher", "NoMoreFrames", "NoResult", "Pass",
    "Record", "Sink", "Solver", "Source", "TemplateBuilder", "WarpModel", "choice", "component",
    "degenerate", "flag", "input_path", "labels", "number", "numbers", "output_path", "text",
    "texts", "whole", "wholes",
]
