# SPDX-License-Identifier: Apache-2.0
"""Numbers by their paths, as `weft metrics` lists them; and the JSON of folders."""

from __future__ import annotations

import json
import pathlib
from typing import Any

from weft.programs.errors import Error


def metric_at(metrics: dict[str, Any], path: str) -> float:
    """The number that a path such as "all.error_solved.mean_mm" names in metrics; NaN where it is null. In a
    list the path names an entry by its stage, kind or part, or leaves it out where there is one only."""
    place: Any = metrics
    words = path.split(".")
    while words:
        if isinstance(place, list):
            named = [each for each in place if label_of(each) == words[0]]
            if named:
                place, words = named[0], words[1:]
                continue
            if len(place) != 1:
                raise no_such(path, words[0], [label_of(each) for each in place])
            place = place[0]
        if not isinstance(place, dict) or words[0] not in place:
            raise no_such(path, words[0], list(place) if isinstance(place, dict) else [])
        place, words = place[words[0]], words[1:]
    if place is None:
        return float("nan")
    if isinstance(place, bool) or not isinstance(place, (int, float)):
        raise Error(f"the metric '{path}' is no number", code="not_found")
    return float(place)


def label_of(entry: dict[str, Any]) -> str:
    return next((str(entry[key]) for key in ("stage", "kind", "part") if key in entry), "")


def no_such(path: str, word: str, names: list[str]) -> Error:
    there = f"; there are: {', '.join(names)}" if names else ""
    return Error(f"the metric '{path}': there is no '{word}'{there}", code="not_found")


def read_json(file: pathlib.Path) -> dict[str, Any]:
    """The object in a file."""
    try:
        found: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"))
        return found
    except OSError as mistake:
        code = "not_found" if isinstance(mistake, FileNotFoundError) else "io"
        raise Error(f"cannot be read: {mistake.strerror}", str(file), code) from None
    except ValueError as mistake:
        raise Error(f"is no JSON: {mistake}", str(file), "syntax") from None


def whole_lines(file: pathlib.Path) -> list[bytes]:
    """The lines of a file that another program may be writing, without the one that it has begun."""
    try:
        text = file.read_bytes()
    except OSError as mistake:
        raise Error(f"cannot be read: {mistake.strerror}", str(file), "io") from None
    return text.split(b"\n")[:-1]
