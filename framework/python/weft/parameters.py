# SPDX-License-Identifier: Apache-2.0
"""Parameters, as attributes of a class: `radius_px = weft.number(60.0, "px", (1, 1000), "...")`.

One declaration each. In an instance the attribute is the value. From the declaration come the checks
of the host, the manifest, the tables of pages and the editor's schema.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


class Parameter:
    """A declaration; `kind` is the type as manifests call it."""

    def __init__(self, kind: str, default: Any, meaning: str, *, unit: str = "",
                 bounds: tuple[float, float] | None = None, choices: Sequence[str] = (), role: str = "",
                 required: bool = False, is_list: bool = False) -> None:
        self.kind, self.default, self.meaning = kind, default, meaning
        self.unit, self.bounds, self.choices, self.role = unit, bounds, tuple(choices), role
        self.required, self.is_list = required, is_list
        self.name, self.was = "", ""
        self.is_deprecated = self.is_prominent = False

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def check(self, value: Any) -> None:
        """Refuses a value that the declaration does not allow."""
        if self.bounds is not None:
            for each in value if self.is_list else [value]:
                if not self.bounds[0] <= each <= self.bounds[1]:
                    raise ValueError(f"parameter '{self.name}' is outside its range")
        if self.kind == "choice" and value not in self.choices:
            raise ValueError(f"parameter '{self.name}' is none of its choices")


def number(default: float, unit: str, bounds: tuple[float, float] | None, meaning: str, *,
           required: bool = False) -> Any:
    """A number. `bounds` are the least and the largest legal one, or None."""
    return Parameter("f64", float(default), meaning, unit=unit, bounds=bounds, required=required)


def whole(default: int, unit: str, bounds: tuple[float, float] | None, meaning: str, *,
          required: bool = False) -> Any:
    """A whole number."""
    return Parameter("i64", int(default), meaning, unit=unit, bounds=bounds, required=required)


def numbers(default: Sequence[float], unit: str, bounds: tuple[float, float] | None, meaning: str, *,
            required: bool = False) -> Any:
    """A list of numbers, each within the bounds."""
    return Parameter("f64", [float(each) for each in default], meaning, unit=unit, bounds=bounds,
                     required=required, is_list=True)


def wholes(default: Sequence[int], unit: str, bounds: tuple[float, float] | None, meaning: str, *,
           required: bool = False) -> Any:
    """A list of whole numbers; likewise."""
    return Parameter("i64", [int(each) for each in default], meaning, unit=unit, bounds=bounds,
                     required=required, is_list=True)


def flag(default: bool, meaning: str) -> Any:
    """True or false."""
    return Parameter("bool", bool(default), meaning)


def choice(default: str, choices: Sequence[str], meaning: str) -> Any:
    """One of several words."""
    return Parameter("choice", default, meaning, choices=choices)


def text(default: str, meaning: str, *, required: bool = False) -> Any:
    """A text."""
    return Parameter("text", default, meaning, required=required)


def texts(default: Sequence[str], meaning: str, *, required: bool = False) -> Any:
    """A list of texts."""
    return Parameter("text", [str(each) for each in default], meaning, required=required, is_list=True)


def input_path(default: str, meaning: str, *, required: bool = False) -> Any:
    """A file to read; absolute in an instance."""
    return Parameter("input_path", default, meaning, required=required)


def output_path(default: str, meaning: str) -> Any:
    """A file or folder to write, the only place where a component writes; absolute in an instance."""
    return Parameter("output_path", default, meaning)


def labels(meaning: str) -> Any:
    """A map from text to text; a dict in an instance."""
    return Parameter("labels", {}, meaning)


def component(role: str, default: str, meaning: str) -> Any:
    """Another component, `role` being its folder, such as `warps`. In an instance it has the methods
    of its role: `self.warp.fit(given, correspondences=..., template=...)`."""
    return Parameter("component", default, meaning, role=role)


def formerly(name: str, parameter: Any) -> Any:
    """The parameter, which had another name: files that use it still run, with a warning, and
    `weft migrate` rewrites them. `noise_px = weft.formerly("noise", weft.number(...))`"""
    parameter.was = name
    return parameter


def prominent(parameter: Any) -> Any:
    """The parameter, as one of those that users change most: programs show it first."""
    parameter.is_prominent = True
    return parameter


def deprecated(parameter: Any) -> Any:
    """The parameter, which files should not set any more: they get a warning with its meaning, which
    names what to use instead."""
    parameter.is_deprecated = True
    return parameter


def parameters_of(component_class: type) -> dict[str, Parameter]:
    """The declarations of a class and of those that it is made of, in their order."""
    found: dict[str, Parameter] = {}
    for each in reversed(component_class.__mro__):
        found.update((name, value) for name, value in vars(each).items()
                     if isinstance(value, Parameter))
    return found
