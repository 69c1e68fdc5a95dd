# SPDX-License-Identifier: Apache-2.0
"""Runs, shapes and results as HTML for notebooks: tables and drawings in the page's own colours, all text escaped."""

from __future__ import annotations

import html
import itertools
from collections import Counter
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

if TYPE_CHECKING:
    from weft.programs.pipelines import Frame
    from weft.programs.runs import RunFrame

STATE_COLOURS = {"estimated": "#2a9d61", "weak": "#d9822b", "predicted": "#2f7ed8", "lost": "#c9475f",
                 "none": "#8b949e"}
MEASURED, FILLED_IN = "#2f7ed8", "#d9822b"
MOST_EDGES = 4000  # of a drawn mesh; one with more is drawn by its border
SIZE_PX = 220
CELL = "text-align:left;padding:2px 10px 2px 0"


class Html(str):
    """Text that is HTML already."""


def escaped(value: object) -> str:
    return value if isinstance(value, Html) else html.escape(str(value))


def titled(title: str, body: str) -> str:
    return f"<div><b>{html.escape(title)}</b>{body}</div>"


def facts(rows: Iterable[tuple[str, object]]) -> Html:
    """A table of names and values; rows without a value are omitted."""
    lines = "".join(f'<tr><td style="{CELL};opacity:.7">{escaped(name)}</td><td style="{CELL}">{escaped(value)}</td></tr>'
                    for name, value in rows if value not in (None, ""))
    return Html(f"<table>{lines}</table>")


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> Html:
    """A table with a header."""
    lines = "".join("<tr>" + "".join(f'<td style="{CELL}">{escaped(each)}</td>' for each in row) + "</tr>"
                    for row in rows)
    head = "".join(f'<th style="{CELL}">{escaped(each)}</th>' for each in header)
    return Html(f"<table><tr>{head}</tr>{lines}</table>")


def states(names: Sequence[str]) -> Html:
    """A bar with the state of each frame in its colour, and how many frames have each state."""
    if not len(names):
        return Html("")
    bars, first = "", 0
    for state, group in itertools.groupby(names):
        count = len(list(group))
        frames = f"frame {first}" if count == 1 else f"frames {first} to {first + count - 1}"
        bars += (f'<rect x="{first}" width="{count}" height="1" fill="{STATE_COLOURS.get(state, "#000")}">'
                 f"<title>{frames}: {html.escape(state)}</title></rect>")
        first += count
    counts = Counter(names)
    legend = ", ".join(f'<span style="color:{STATE_COLOURS.get(state, "inherit")}">&#9632;</span> '
                       f"{counts[state]} {html.escape(state)}"
                       for state in sorted(counts, key=lambda each: [*STATE_COLOURS, each].index(each)))
    return Html(f'<svg width="{2 * SIZE_PX}" height="12" viewBox="0 0 {first} 1" preserveAspectRatio="none">{bars}</svg>'
                f"<br/>{legend}")


def seen(vertices_m: ArrayLike) -> NDArray[np.float64]:
    """Vertices [V,3] m before the camera as it sees them, [V,2] without a unit."""
    vertices = np.asarray(vertices_m, np.float64)
    depths = np.where(vertices[:, 2:] > 0, vertices[:, 2:], np.nan)
    return np.asarray(vertices[:, :2] / depths, np.float64)


def mesh(points: NDArray[np.float64], faces: NDArray[np.int32], source: ArrayLike | None = None) -> Html:
    """The edges of a mesh over points [V,2]. Those with a vertex that the prior filled in (`source` 0) are orange."""
    ends = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    edges, uses = np.unique(ends, axis=0, return_counts=True)
    if len(edges) > MOST_EDGES:
        edges = edges[uses == 1]
    edges = edges[np.isfinite(points[edges]).all(axis=(1, 2))][:MOST_EDGES]
    if not len(edges):
        return Html("")
    used = points[edges.ravel()]
    low, extent = used.min(axis=0), max(float(np.ptp(used, axis=0).max()), 1e-12)
    drawn = np.rint(4 + (2 * SIZE_PX - 8) * (points[edges] - low) / extent)  # half pixels
    width, height = (int(each) + 4 for each in drawn.max(axis=(0, 1)))
    measured = np.ones(len(edges), bool) if source is None else np.asarray(source)[edges].all(axis=1)
    paths = ""
    for chosen, colour in ((drawn[measured], MEASURED), (drawn[~measured], FILLED_IN)):
        if len(chosen):
            steps = "".join(f"M{a:.0f} {b:.0f}L{c:.0f} {d:.0f}" for a, b, c, d in chosen.reshape(-1, 4))
            paths += f'<path d="{steps}" fill="none" stroke="{colour}" stroke-width="2"/>'
    return Html(f'<br/><svg width="{width // 2}" height="{height // 2}" viewBox="0 0 {width} {height}">{paths}</svg>')


def frame(title: str, shown: Frame | RunFrame, stages: Iterable[Sequence[object]],
          faces: NDArray[np.int32] | None) -> str:
    """A frame: its mesh as the camera sees it, its state, and what its stages did."""
    drawn = Html("")
    if shown.vertices_m is not None and faces is not None:
        drawn = mesh(seen(shown.vertices_m), faces, shown.source)
    state = Html(f'<span style="color:{STATE_COLOURS.get(shown.state, "inherit")}">&#9632;</span> ' +
                 html.escape(shown.state))
    age = "" if shown.age_frames == 0 else f"{shown.age_frames} frames"
    return titled(title, drawn + facts([("state", state), ("confidence", f"{shown.confidence:.2f}"), ("age", age)]) +
                  table(["stage", "status", "time", "reason"], stages))


def milliseconds(value: float) -> str:
    return "" if np.isnan(value) else f"{value:.3g} ms"
