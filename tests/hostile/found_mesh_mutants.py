# SPDX-License-Identifier: Apache-2.0
"""Meshes as scanners and programs write them, read by `weft template show`.

Some are the same surface in another form and must give the same template. The others cannot be
used and must be refused with what they are and what helps.
"""

from __future__ import annotations

import json
import struct
from collections.abc import Callable
from pathlib import Path
from random import Random

from judging import Mutant
from mesh_mutants import COLUMNS, ROWS, obj_lines, triangles, vertices
from pictures import png
from program import Answer, Program


def as_bytes(lines: list[str], end: str = "\n") -> bytes:
    return "".join(line + end for line in lines).encode()


def numbers(text: str) -> list[float]:
    return [float(word) for word in text.split()]


def soup_lines(rng: Random, off: float, off_uv: float) -> list[str]:
    """Each triangle with three vertices of its own, off by up to these amounts."""
    lines, faces = [], []
    for face in triangles():
        corners = []
        for v in face:
            place, uv = (numbers(text) for text in vertices()[v])
            inwards = [0.001 + 0.998 * x for x in uv]  # errors must stay inside the image
            lines.append("v " + " ".join(f"{x + rng.uniform(-off, off):.12f}" for x in place))
            lines.append("vt " + " ".join(f"{x + rng.uniform(-off_uv, off_uv):.12f}" for x in inwards))
            corners.append(f"{len(lines) // 2}/{len(lines) // 2}")
        faces.append("f " + " ".join(corners))
    return lines + faces


def soup(rng: Random) -> tuple[str, bytes]:
    return "mesh.obj", as_bytes(soup_lines(rng, 3e-8, 3e-7))


def marked(rng: Random) -> tuple[str, bytes]:
    return "mesh.obj", b"\xef\xbb\xbf" + as_bytes(obj_lines(), rng.choice(["\n", "\r\n", "\r"]))


def degenerate(rng: Random) -> tuple[str, bytes]:
    lines = obj_lines()
    corner = f"{rng.randrange(COLUMNS * ROWS) + 1}"
    lines.insert(rng.randrange(len(lines) - 6, len(lines)), f"f {corner}/{corner} {corner}/{corner} 1/1")
    return "mesh.obj", as_bytes(lines)


def quads(rng: Random) -> tuple[str, bytes]:
    lines = [line for line in obj_lines() if not line.startswith("f ")]
    for y in range(ROWS - 1):
        for x in range(COLUMNS - 1):
            v = y * COLUMNS + x
            corners = [f"{i - COLUMNS * ROWS}" for i in (v, v + 1, v + COLUMNS + 1, v + COLUMNS)]
            lines.append("f " + " ".join(f"{i}/{i}" for i in corners))
    return "mesh.obj", as_bytes(lines)


def colours(rng: Random) -> tuple[str, bytes]:
    return "mesh.obj", as_bytes([line + " 0.5 0.25 1" if line.startswith("v ") else line
                                 for line in obj_lines()])


def binary_ply(rng: Random) -> tuple[str, bytes]:
    order, name = rng.choice([("<", "little"), (">", "big")])
    head = ["ply", f"format binary_{name}_endian 1.0", f"element vertex {COLUMNS * ROWS}"]
    head += [f"property double {each}" for each in ("x", "y", "z", "s", "t")]
    head += ["property uchar red", f"element face {len(triangles())}",
             "property list uchar int vertex_indices", "end_header"]
    content = as_bytes(head)
    for place, uv in vertices():
        content += struct.pack(order + "5dB", *numbers(place), *numbers(uv), 7)
    for face in triangles():
        content += struct.pack(order + "B3i", 3, *face)
    return "mesh.ply", content


def wide(rng: Random) -> tuple[str, bytes, str]:
    coding, mark = rng.choice([("utf-16-le", b"\xff\xfe"), ("utf-16-be", b"\xfe\xff")])
    text = "\n".join(obj_lines()).encode(coding)
    return "mesh.obj", rng.choice([mark, b""]) + text, "UTF-16: save it as UTF-8"


def other_format(rng: Random) -> tuple[str, bytes, str]:
    ending, content = rng.choice([
        ("stl", b"solid x\nfacet normal 0 0 1\n"), ("stl", bytes(80) + b"\1\0\0\0" + bytes(50)),
        ("glb", b"glTF\2\0\0\0"), ("gltf", b'{"asset": {}}'), ("fbx", b"Kaydara FBX Binary  \0"),
        ("dae", b"<?xml version='1.0'?><COLLADA/>"), ("off", b"OFF\n3 1 0\n"), ("3ds", b"MM\x10\0"),
        ("blend", b"BLENDER-v300"), ("dxf", b"0\nSECTION\n"), ("usdz", b"PK\3\4")])
    return f"mesh.{rng.choice([ending, ending, 'obj']) if ending != 'dxf' else ending}", content, \
        "OBJ and PLY are read"


def loose(rng: Random) -> tuple[str, bytes, str]:
    off, off_uv, advice = rng.choice([(1e-3, 0.0, "merge vertices by distance"),
                                      (0.0, 9e-4, "unwrap the mesh")])
    return "mesh.obj", as_bytes(soup_lines(rng, off, off_uv)), advice


def two_pictures(rng: Random) -> tuple[str, bytes, str]:
    lines = obj_lines()
    first = next(i for i, line in enumerate(lines) if line.startswith("f "))
    at = rng.randrange(first + 1, len(lines))
    lines[at:at] = ["usemtl b"]
    lines[first:first] = ["mtllib m.mtl", "usemtl a"]
    return "mesh.obj", as_bytes(lines), "with 2 images, but a template has one"


LIBRARY = b"newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd b.png\n"
SAME: list[Callable[[Random], tuple[str, bytes]]] = [soup, marked, degenerate, quads, colours, binary_ply]
REFUSED: list[Callable[[Random], tuple[str, bytes, str]]] = [wide, other_format, loose, two_pictures]


def same_figures(program: Program, folder: Path, answer: Answer) -> str:
    """Up to what rounding does to the surface."""
    legal = json.loads(program.ask(folder, "template", "show", "legal.yaml", "--json").out)
    found = json.loads(answer.out)
    for key in ("vertices", "faces", "edges", "border_edges", "texture_px"):
        if legal[key] != found[key]:
            return f"{key}: {found[key]} instead of {legal[key]}"
    if abs(legal["area_cm2"] - found["area_cm2"]) > 1e-3 * legal["area_cm2"]:
        return f"area: {found['area_cm2']} instead of {legal['area_cm2']}"
    return ""


def found_mesh_mutant(rng: Random) -> Mutant:
    def pipeline(mesh: str) -> bytes:
        return ("weft: 1\nsource: {use: sources/test.scripted}\ntemplate: {use: templates/mesh, "
                f"params: {{mesh: {mesh}, texture: texture.png}}}}\n").encode()

    command = ["template", "show", "pipeline.yaml", "--json"]
    if rng.random() < 0.5:
        name, content = rng.choice(SAME)(rng)
        files: dict[str, object] = {
            name: content, "legal.obj": as_bytes(obj_lines()), "texture.png": png(40, 30),
            "pipeline.yaml": pipeline(name), "legal.yaml": pipeline("legal.obj")}
        return Mutant("found mesh", files, command, same=same_figures)
    name, content, sentence = rng.choice(REFUSED)(rng)

    def says_so(program: Program, folder: Path, answer: Answer) -> str:
        return "" if sentence in answer.err else f"does not say: {sentence}: {answer.err[:200]}"

    refused: dict[str, object] = {name: content, "m.mtl": LIBRARY, "texture.png": png(40, 30),
                                  "pipeline.yaml": pipeline(name)}
    return Mutant("found mesh", refused, command, same=says_so, codes=(2,))
