# SPDX-License-Identifier: Apache-2.0
"""Mutants below any grammar: bytes of legal files changed, and paths that are no such files."""

from __future__ import annotations

import os
from pathlib import Path
from random import Random

from camera_mutants import camera_mutant
from judging import FOLDER, Expected, Mutant
from mesh_mutants import mesh_mutant
from pictures import png
from run_mutants import flipped
from yaml_mutants import pipeline_mutant, plan_mutant


def bytes_mutant(rng: Random) -> Mutant:
    """A file with changed bytes: it may mean something else now, but must be answered cleanly."""
    mutant = None
    maker = rng.choice([pipeline_mutant, plan_mutant, camera_mutant, mesh_mutant])
    while mutant is None or mutant.expected:
        mutant = maker(rng)
    name = next(name for name in mutant.files
                if name in ("plan.yaml", "camera.yaml", "camera.json", "mesh.obj", "mesh.ply")
                or (name == "pipeline.yaml" and maker is pipeline_mutant))
    mutant.files[name] = flipped(rng, mutant.files[name])
    codes = (0, 1, 2, 3)
    return Mutant("bytes of a " + mutant.kind, mutant.files, mutant.command, codes=codes)


def pipe(path: Path) -> None:
    os.mkfifo(path)


def link_to(target: str):
    return lambda path: path.symlink_to(target)


NO_FILES = {"folder": FOLDER, "pipe": pipe, "endless": link_to("/dev/zero"),
            "memory": link_to("/proc/self/mem"), "dangling": link_to("nowhere"),
            "to itself": link_to("file"), "absent": None}
PLACES = {  # a pipeline in which `FILE` is a path
    "extends": "weft: 1\nextends: FILE\n",
    "texture": """weft: 1
source: {use: sources/test.scripted}
template: {use: templates/rectangular, params: {width_m: 0.2, texture: FILE}}
""",
    "camera": """weft: 1
source: {use: sources/images, params: {path: "frames/*.png", camera: FILE}}
template: {use: templates/test.scripted}
""",
    "mesh": """weft: 1
source: {use: sources/test.scripted}
template: {use: templates/mesh, params: {texture: t.png, mesh: FILE}}
""",
    "frames": """weft: 1
source: {use: sources/images, params: {path: FILE, camera: camera.yaml}}
template: {use: templates/test.scripted}
""",
}
CAMERA = b"{fx: 40, fy: 40, cx: 20, cy: 15, width: 40, height: 30}\n"


def path_mutant(rng: Random) -> Mutant:
    """A path to what is no regular file: refused where the path stands, and never waited for."""
    what, content = rng.choice(sorted(NO_FILES.items(), key=lambda item: item[0]))
    place, text = rng.choice(sorted(PLACES.items()))
    line = next(i for i, line in enumerate(text.splitlines(), 1) if "FILE" in line)
    column = text.splitlines()[line - 1].index("FILE") + 1
    files: dict[str, object] = {"t.png": png(40, 30),
                                "frames/0.png": png(40, 30),
                                "camera.yaml": CAMERA,
                                "pipeline.yaml": text.replace("FILE", "file").encode()}
    if content is not None:
        files["file"] = content
    return Mutant("path", files, ["check", "pipeline.yaml"],
                  [Expected(f"{what} as {place}", "pipeline.yaml", line, column)], one_pass=False)
