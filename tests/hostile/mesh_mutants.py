# SPDX-License-Identifier: Apache-2.0
"""Mutants of OBJ and PLY files, read by `weft template show`; a mistake is reported with its line.

A mesh file is refused at its first mistake, so each has one.
"""

from __future__ import annotations

from pathlib import Path
from random import Random

from judging import Expected, Mutant
from pictures import png
from program import Answer, Program

COLUMNS, ROWS = 4, 3
BAD_CORNERS = ["99", "0", "-99", "1/99", "1/0", "99999999999999999999", "x", "1/x", "1.5",
               "2147483648", "4294967297", "-2147483649"]
BAD_NUMBERS = ["x", "nan", "inf", "1e999", "", "0,1", "\x01", "--1", "0x1p3", "é"]


def vertices() -> list[tuple[str, str]]:
    """Place and texture coordinates of a sheet of COLUMNS x ROWS vertices."""
    return [(f"{0.1 * x:g} {0.1 * y:g} 0", f"{x / (COLUMNS - 1):.6f} {y / (ROWS - 1):.6f}")
            for y in range(ROWS) for x in range(COLUMNS)]


def triangles() -> list[tuple[int, int, int]]:
    corners = []
    for y in range(ROWS - 1):
        for x in range(COLUMNS - 1):
            v = y * COLUMNS + x
            corners += [(v, v + 1, v + COLUMNS + 1), (v, v + COLUMNS + 1, v + COLUMNS)]
    return corners


def obj_lines() -> list[str]:
    lines = [f"v {place}" for place, _ in vertices()] + [f"vt {uv}" for _, uv in vertices()]
    return lines + ["f " + " ".join(f"{v + 1}/{v + 1}" for v in face) for face in triangles()]


def ply_lines() -> list[str]:
    head = ["ply", "format ascii 1.0", f"element vertex {COLUMNS * ROWS}"]
    head += [f"property float {name}" for name in ("x", "y", "z", "s", "t")]
    head += [f"element face {len(triangles())}", "property list uchar int vertex_indices",
             "end_header"]
    lines = head + [f"{place} {uv}" for place, uv in vertices()]
    return lines + ["3 " + " ".join(map(str, face)) for face in triangles()]


def pick(rng: Random, lines: list[str], start: str) -> int:
    return rng.choice([i for i, line in enumerate(lines) if line.startswith(start)])


def spoil_obj(rng: Random, lines: list[str]) -> int:
    """Plants a mistake and gives the index of its line."""
    kind = rng.randrange(6)
    if kind == 0:
        at = pick(rng, lines, rng.choice(["v ", "vt "]))
        words = lines[at].split()
        words[rng.randrange(1, 3)] = rng.choice(BAD_NUMBERS[:4] + BAD_NUMBERS[5:])
        lines[at] = " ".join(words)
    elif kind == 1:
        at = pick(rng, lines, "f ")
        wrong = rng.choice(BAD_CORNERS)
        lines[at] = " ".join([*lines[at].split()[:3], wrong])
    elif kind == 2:
        at = pick(rng, lines, "f ")
        lines[at] = " ".join(lines[at].split()[:3])
    elif kind == 3:
        at = pick(rng, lines, rng.choice(["v ", "vt ", "f "]))
        lines[at] = rng.choice(["vx ", "\x01 ", "face ", "{ ", "\0 "]) + lines[at]
    elif kind == 4:
        at = pick(rng, lines, "v ")
        lines[at] = " ".join(lines[at].split()[:3])
    else:
        at = pick(rng, lines, "f ")
        lines.insert(at + 1, lines[at])
        at += 1
    return at


def spoil_ply(rng: Random, lines: list[str]) -> int:
    kind = rng.randrange(5)
    first = lines.index("end_header") + 1
    at = first + rng.randrange(COLUMNS * ROWS)
    words = lines[at].split()
    if kind == 0:
        words[rng.randrange(3)] = rng.choice(BAD_NUMBERS[:4] + BAD_NUMBERS[5:])
        lines[at] = " ".join(words)
    elif kind == 1:
        at = pick(rng, lines, "3 ")
        lines[at] = rng.choice(["3 0 1 99", "3 0 1 -1", "3 0 1", "3 0 1 x", "2 0 1",
                                "3 0 1 99999999999999999999", "-3 0 1 2", "4000000000 0 1 2"])
    elif kind == 2:
        at = rng.randrange(3, 8)
        lines[at] = rng.choice(
            ["property quad x", "property", "proprety float x", "element", "\x01"])
    elif kind == 3:
        at = pick(rng, lines, "element")
        wrong = rng.choice(["-1", "many", "1e3", "99999999999999999999"])
        lines[at] = " ".join([*lines[at].split()[:2], wrong])
    else:
        at = 1
        lines[at] = rng.choice(["format text 1.0", "format ascii", "frmat ascii 1.0"])
    return at


def dressed(rng: Random, lines: list[str], ply: bool) -> list[str]:
    """The same mesh in other words."""
    comment = "comment x" if ply else "# v 1 2"
    for _ in range(rng.randrange(4)):
        last = lines.index("end_header") if ply else len(lines)
        lines.insert(rng.randrange(1 if ply else 0, last + 1), comment)
    if not ply:
        lines = [line.replace(" ", rng.choice([" ", "  ", "\t"])) for line in lines]
        lines = [line + rng.choice(["", " ", "\r"]) for line in lines]
    return lines


def same_mesh(program: Program, folder: Path, answer: Answer) -> str:
    legal = program.ask(folder, "template", "show", "legal.yaml", "--json")
    return "" if legal.code == 0 and legal.out == answer.out else "templates differ"


def mesh_mutant(rng: Random) -> Mutant:
    ply = rng.random() < 0.4
    name = "mesh.ply" if ply else "mesh.obj"
    lines = ply_lines() if ply else obj_lines()

    def pipeline(mesh: str) -> bytes:
        return ("weft: 1\nsource: {use: sources/test.scripted}\ntemplate: {use: templates/mesh, "
                f"params: {{mesh: {mesh}, texture: texture.png}}}}\n").encode()

    files: dict[str, object] = {"texture.png": png(40, 30), "pipeline.yaml": pipeline(name)}
    command = ["template", "show", "pipeline.yaml", "--json"]
    if rng.random() < 0.2:
        files |= {"legal-" + name: "\n".join(lines).encode() + b"\n",
                  "legal.yaml": pipeline("legal-" + name)}
        files[name] = "\n".join(dressed(rng, lines, ply)).encode() + b"\n"
        return Mutant("mesh", files, command, same=same_mesh)
    at = (spoil_ply if ply else spoil_obj)(rng, lines)
    files[name] = "\n".join(lines).encode() + b"\n"
    return Mutant("mesh", files, command, [Expected("mistake", name, at + 1)], one_pass=False)
