# SPDX-License-Identifier: Apache-2.0
"""Mutants of camera files in their three forms, read by `weft check` of a pipeline of images.

A camera file is refused at its first mistake, so each has one.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

import planting
from documents import Map, Style, Text, tree, write
from judging import Expected, Mutant
from pictures import png
from planting import Planted, put_value, rename_key, unknown_key
from program import Answer, Program
from words import misspelt
from yaml_mutants import encoded

PIPELINE = """\
weft: 1
source: {{use: sources/images, params: {{path: "frames/*.png", camera: {camera}}}}}
template: {{use: templates/test.scripted}}
stages:
  - {{use: matchers/test.pattern}}
"""
SIZE = ("width", "height", "image_width", "image_height")


def plain_camera(rng: Random) -> Map:
    lens = rng.choice([None, [0.01, 0.002, 0.001, 0.001, 0.0], {"model": "brown", "coefficients":
                       [0.01] * 5}, {"model": "fisheye", "coefficients": [0.01, 0.0, 0.0, 0.0]}])
    given = {"fx": 40.5, "fy": 41.25, "cx": 19.5, "cy": 14.5, "width": 40, "height": 30}
    root = tree(given | ({"distortion": lens} if lens else {}))
    if lens is None:
        root.put("distortion", Text("", "null"))
    rng.shuffle(root.entries)
    return root


def foreign_camera(rng: Random) -> Map:
    """As OpenCV and ROS write them, with keys that Weft has no use for."""
    model = rng.choice([{"distortion_model": "plumb_bob"}, {"fisheye_model": 0}, {}])
    ros = {"camera_name": "left", "rectification_matrix": {"rows": 1, "cols": 1, "data": [1]}}
    root = tree({
        "image_width": 40, "image_height": 30,
        "camera_matrix": {"rows": 3, "cols": 3,
                          "data": [40.5, 0, 19.5, 0, 41.25, 14.5, 0, 0, 1]},
        "distortion_coefficients": {"rows": 1, "cols": 5, "data": [0.01, 0.0, 0.0, 0.0, 0.0]},
    } | model | (ros if "distortion_model" in model else {}))
    rng.shuffle(root.entries)
    return root


# --- mistakes -------------------------------------------------------------------------------------


def wrong_number(rng: Random, root: Map) -> Planted:
    """A number of the pinhole: no number, or one that no camera has."""
    if root.find("camera_matrix"):
        data, index = root.find("camera_matrix").find("data"), rng.choice([0, 2, 4, 5])
        focal, slot = index in (0, 4), data.items[index]
    else:
        name = rng.choice(["fx", "fy", "cx", "cy"])
        focal, slot = name[0] == "f", root.find(name)
    words = ["far", ".nan", ".inf", "1e999", "[1]", "40;5", "40 px", "0x1F", '"\\x1b"']
    slot.raw = rng.choice(words + (["0", "-40.5", "-0.0", "1e300", "1e-300"] if focal else
                                   ["99999", "-99999", "1e300"]))
    return Planted("wrong number", slot)


def wrong_size(rng: Random, root: Map) -> Planted:
    node = root.find(rng.choice([key for key in SIZE if root.find(key)]))
    node.raw = rng.choice(["0", "-1", "40.5", "32768", "1e9", "wide", "[40]", "1e999", ".nan"])
    return Planted("wrong size", node)


def missing_key(rng: Random, root: Map) -> Planted:
    needed = ["fx", "fy", "cx", "cy", *SIZE]
    gone = rng.choice([key.value for key, _ in root.entries if key.value in needed])
    root.entries = [entry for entry in root.entries if entry[0].value != gone]
    return Planted("missing key", root)


def misspelt_lens(rng: Random, root: Map) -> Planted:
    key = "distortion" if root.find("distortion") else "distortion_coefficients"
    return rename_key(rng, "misspelt key", root, key, ["distortion_model"])


def unknown_root_key(rng: Random, root: Map) -> Planted | None:
    return None if root.find("camera_matrix") else unknown_key(rng, "unknown key", root)


def duplicate_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["fx", "cx", *SIZE])
    key = key if root.find(key) else next(k for k in SIZE if root.find(k))
    return Planted("duplicate key", root.put(key, Text(root.find(key).value)))


def wrong_lens(rng: Random, root: Map) -> Planted | None:
    lens = root.find("distortion")
    if lens is None or rng.random() < 0.3:
        if lens is None:
            return None
        value = rng.choice([tree([0.1, 0.1]), tree([0.1] * 9), Text("none"), Text("0.1")])
        return Planted("wrong lens", put_value(root, "distortion", value))
    if not isinstance(lens, Map):
        return None
    if rng.random() < 0.5:
        wrong = misspelt(rng, lens.find("model").value, [])
        return Planted("wrong lens", put_value(lens, "model", Text(wrong)))
    item = rng.choice(lens.find("coefficients").items)
    item.raw = rng.choice(["small", ".nan", "[0.1]", "1e999"])
    return Planted("wrong lens", item)


def syntax(rng: Random, root: Map) -> Planted:
    key = rng.choice(["cx", "fy"] if root.find("cx") else ["image_width", "camera_matrix"])
    raw = rng.choice(["*nowhere", '"ab\x01c"', '"ab\udcff"'])
    return Planted("syntax", put_value(root, key, Text("", raw)))


KINDS = [wrong_number, wrong_number, wrong_size, missing_key, misspelt_lens, unknown_root_key,
         duplicate_key, wrong_lens, syntax]


def same_camera(program: Program, folder: Path, answer: Answer) -> str:
    """Whether a run sees the same camera and the same frames."""
    scenes = []
    for name in ("pipeline.yaml", "legal.yaml"):
        ran = program.ask(folder, "run", name, "--out", f"run-{name}", "--quiet")
        if ran.code != 0:
            return f"{name}: run ends with {ran.code}: {ran.err}"
        scenes.append((folder / f"run-{name}" / "template.npz").read_bytes())
    return "" if scenes[0] == scenes[1] else "runs see different cameras"


def camera_mutant(rng: Random) -> Mutant:
    root = rng.choice([plain_camera, foreign_camera])(rng)
    json = root.find("camera_matrix") is None and rng.random() < 0.4
    name = "camera.json" if json else "camera.yaml"
    files: dict[str, object] = {"frames/0.png": png(40, 30),
                                "pipeline.yaml": PIPELINE.format(camera=name).encode()}
    if rng.random() < 0.2:
        files["legal-" + name] = encoded(write(root))
        files["legal.yaml"] = PIPELINE.format(camera="legal-" + name).encode()
        files[name] = encoded(write(root, Style.random(rng), json))
        return Mutant("camera", files, ["check", "pipeline.yaml"], same=same_camera)
    planted = None
    while planted is None:
        planted = rng.choice(KINDS)(rng, root)
    files[name] = encoded(write(root, Style.random(rng), json))
    line, column = planted.at  # the place of a character inside a value need not be reported
    expected = Expected(planted.kind, name, line, None if planted.kind == "syntax" else column,
                        planted.suggestion)
    return Mutant("camera", files, ["check", "pipeline.yaml"], [expected])
