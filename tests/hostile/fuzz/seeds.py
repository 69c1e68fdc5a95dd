#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the inputs that the fuzzers start from, a folder for each, from the files of this repository
and from small ones made here.

usage: tests/hostile/fuzz/seeds.py FOLDER
"""

from __future__ import annotations

import io
import struct
import sys
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
MOST_BYTES = 4096  # larger inputs cost more than they find

MANIFEST = """\
weft_plugin: 1
abi: [1, 0]
needs_minor: 0
build_id: "a9f98a53"
compiler: "gcc 12.2.0"
isa: ["avx2"]
components:
  - id: "filters/some"
    version: "1.0.0"
    summary: "s"
    reference: "r"
    implements: "paper"
    licence: "Apache-2.0"
    determinism: "exact"
    needs: [correspondences]
    reads: [weights]
    produces: []
    random: true
    uses_truth: false
    extensions: ["weft.check/1"]
    parameters:
      - {name: "a", type: i64, default: 12, range: [4, 100], help: "h"}
      - {name: "b", type: f64, vector: true, default: [1, 2.5], unit: "px", range: [0, 1e9], help: "h"}
      - {name: "c", type: choice, default: "x", choices: ["x", "y"], help: "h", was: "d"}
      - {name: "e", type: bool, default: false, help: "h"}
      - {name: "f", type: input_path, required: true, help: "h"}
      - {name: "g", type: output_path, default: "o", help: "h"}
      - {name: "h", type: component, role: warps, default: {use: warps/tps}, help: "h"}
      - {name: "i", type: labels, default: {}, help: "h"}
      - {name: "j", type: text, default: "", help: "h"}
    sweep: {parameter: a, values: [1, 2, 3]}
    records: ["correspondences/1"]
"""

CAMERAS = {
    "own.yaml": "fx: 500.25\nfy: 5.1e2\ncx: 3.5\ncy: -2.5\nwidth: 8\nheight: 6\n"
                "distortion: [0.1, -0.2, 0, 0, 0.01]\ncomment: {a: 1}\n",
    "fisheye.json": '{"fx": 500, "fy": 510, "cx": 320, "cy": 240, "width": 640, "height": 480,\n'
                    ' "distortion": {"model": "fisheye", "coefficients": [0.1, 0, 0, 0]}}\n',
    "opencv.yaml": "%YAML:1.0\n---\nimage_width: 8\nimage_height: 6\n"
                   "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                   "   data: [ 500.25, 0., 3.5, 0., 510., -2.5, 0., 0., 1. ]\n"
                   "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
                   "   data: [ -0.1, 0., 0., 0., 0. ]\n",
    "ros.yaml": "image_width: 8\nimage_height: 6\ncamera_name: narrow\n"
                "camera_matrix: {rows: 3, cols: 3, data: [500, 0, 3, 0, 510, -2, 0, 0, 1]}\n"
                "distortion_model: rational_polynomial\n"
                "distortion_coefficients: {rows: 1, cols: 8, data: [0.1,0,0,0,0,0.1,0,0]}\n",
}

OBJECTS = {
    "square.obj": "# a square\r\nmtllib a.mtl\nv 0 0 0 1\nv 1 0 0\nv 1 1 0\nv +0 1e0 0\nvt 0 0\n"
                  "vt 1 0 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nf 1/1/1 2/2 \\\n 3/3/1 -1/-1\ng other\n",
    "plain.obj": "v 0 0 0\nv 1 0 0\nv 1 1 0\ns off\nf 1//1 2 3\nf -1 -2 -3\n",
}

PLY_VERTEX = "element vertex 4\n" + "".join(
    f"property {kind} {name}\n" for kind, name in
    [("float", "x"), ("float", "y"), ("double", "z"), ("float", "s"), ("float", "t"), ("uchar", "red")])
PLY_FACE = "element face 1\nproperty list uchar int vertex_indices\n"


def ply_files() -> dict[str, bytes]:
    """A quadrangle in each format, one whose faces have texture coordinates, and a cloud."""
    rows = [(v % 2, v // 2, 2.25, 0.5, 0.125 * v, 200) for v in range(4)]
    ascii_rows = "".join(" ".join(map(str, row)) + "\n" for row in rows) + "4 0 1 3 2\n"
    files = {"ascii.ply": ("ply\nformat ascii 1.0\ncomment by hand\n" + PLY_VERTEX + PLY_FACE +
                           "end_header\n" + ascii_rows).encode()}
    for order, word in (("<", "little"), (">", "big")):
        body = b"".join(struct.pack(order + "ffdffB", *row) for row in rows)
        body += struct.pack(order + "B4i", 4, 0, 1, 3, 2)
        head = f"ply\nformat binary_{word}_endian 1.0\n{PLY_VERTEX}{PLY_FACE}end_header\n"
        files[word + ".ply"] = head.encode() + body
    xyz = "".join(f"property float {name}\n" for name in "xyz")
    files["cloud.ply"] = f"ply\nformat ascii 1.0\nelement vertex 1\n{xyz}end_header\n1 2 300\n".encode()
    files["corners.ply"] = (
        f"ply\nformat ascii 1.0\nelement vertex 3\n{xyz}element face 1\n"
        "property list uchar int vertex_index\nproperty list uchar float texcoord\nelement edge 1\n"
        "property int a\nproperty list uint16 int8 b\nend_header\n"
        "0 0 1\n1 0 1\n0 1 1\n3 0 1 2 6 0 0 1 0 0 1\n7 2 1 -1\n").encode()
    return files


def npy(kind: str, shape: tuple[int, ...], values: list[float]) -> bytes:
    """An array in NumPy's format 1.0; `kind` is a letter of the module struct."""
    word = {"d": "<f8", "f": "<f4", "q": "<i8", "i": "<i4", "B": "|u1"}[kind]
    header = f"{{'descr': '{word}', 'fortran_order': False, 'shape': {shape}, }}"
    header = header.ljust(64 * ((len(header) + 74) // 64) - 11) + "\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header.encode() +
            struct.pack(f"<{len(values)}{kind}", *values))


def word(text: str) -> bytes:
    return npy("B", (len(text),), list(text.encode()))


def npz_files() -> dict[str, bytes]:
    """Records as Weft writes them, and a cloud: as archives and as the lists that npz_fuzzer reads."""
    xyz = [float(i) for i in range(1, 13)]
    scalars = {f"camera/{name}.npy": npy("d", (), [100.0]) for name in ("fx", "fy", "cx", "cy")}
    scalars |= {f"camera/{name}.npy": npy("q", (), [640]) for name in ("width", "height")}
    files: dict[str, dict[str, bytes]] = {
        "shape": {"shape/record_type.npy": word("shape/1"),
                  "shape/vertices_m.npy": npy("d", (4, 3), xyz), "shape/state.npy": npy("i", (), [1]),
                  "shape/age.npy": npy("q", (), [0]), "shape/confidence.npy": npy("d", (), [0.5]),
                  "shape/source.npy": npy("B", (4,), [1, 1, 0, 1])},
        "truth": {"ground_truth/record_type.npy": word("ground_truth/1"),
                  "ground_truth/template_xy_m.npy": npy("d", (4, 2), xyz[:8]),
                  "ground_truth/points_m.npy": npy("d", (4, 3), xyz),
                  "ground_truth/kind.npy": word("by formula"), "ground_truth/apart.npy": word("")},
        "cloud": {"points.npy": npy("f", (4, 3), xyz), "faces.npy": npy("i", (1, 3), [0, 1, 2])},
        "camera": {"camera/record_type.npy": word("camera/1")} | scalars,
    }
    written = {}
    for name, members in files.items():
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w") as out:
            for member, content in members.items():
                out.writestr(member, content)
        written[name + ".npz"] = archive.getvalue()
        written[name + ".list"] = b"".join(
            bytes([len(member)]) + member.encode() + len(content).to_bytes(2, "big") + content
            for member, content in members.items())
    return written


def files_of(*patterns: str) -> dict[str, bytes]:
    found = [file for pattern in patterns for file in sorted(ROOT.glob(pattern))]
    return {"-".join(file.relative_to(ROOT).parts): file.read_bytes() for file in found
            if file.stat().st_size <= MOST_BYTES}


def encoded(texts: dict[str, str]) -> dict[str, bytes]:
    return {name: text.encode() for name, text in texts.items()}


def seeds() -> dict[str, dict[str, bytes]]:
    """The seeds of each fuzzer by name."""
    return {
        "yaml": files_of("pipelines/*.yaml", "pipelines/ablations/*.yaml", "tests/hostile/malformed/*.yaml",
                         "tests/ablation/plans/*.yaml"),
        "manifest": {"all.plugin.yaml": MANIFEST.encode()},
        "camera": encoded(CAMERAS) | files_of("pipelines/data/*camera.yaml",
                                              "pipelines/data/match_set/camera.yaml"),
        "obj": encoded(OBJECTS) | files_of("pipelines/data/*.obj"),
        "ply": ply_files(),
        "npz": npz_files(),
    }


def main(words: list[str]) -> int:
    if len(words) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    for name, files in seeds().items():
        folder = Path(words[0]) / name
        folder.mkdir(parents=True, exist_ok=True)
        for file, content in files.items():
            (folder / file).write_bytes(content)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
