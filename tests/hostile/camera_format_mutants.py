# SPDX-License-Identifier: Apache-2.0
"""Camera files as other programs write them: the camera is known, or a number is none."""

from __future__ import annotations

from pathlib import Path
from random import Random

from image_mutants import HEIGHT, WIDTH, info, refused
from judging import Mutant
from pictures import png
from program import Answer, Program

# COLMAP and nerfstudio count pixels from the first one's corner: px and py are cx + 0.5, cy + 0.5.
FORMATS = {
    "kalibr": "cam0:\n  camera_model: pinhole\n  distortion_coeffs: [0, 0, 0, 0]\n"
              "  distortion_model: radtan\n  intrinsics: [{fx}, {fy}, {cx}, {cy}]\n"
              "  resolution: [{width}, {height}]\n  rostopic: /cam0/image_raw\n",
    "ros": "header:\n  seq: 0\n  frame_id: camera\nheight: {height}\nwidth: {width}\n"
           "distortion_model: plumb_bob\nD: [0, 0, 0, 0, 0]\n"
           "K: [{fx}, 0.0, {cx}, 0.0, {fy}, {cy}, 0.0, 0.0, 1.0]\n---\n",
    "colmap": "# Camera list with one line of data per camera:\n"
              "1 PINHOLE {width} {height} {fx} {fy} {px} {py}\n",
    "orb_slam": "%YAML:1.0\n\nCamera.type: \"PinHole\"\nCamera.fx: {fx}\nCamera.fy: {fy}\n"
                "Camera.cx: {cx}\nCamera.cy: {cy}\nCamera.k1: 0.0\nCamera.k2: 0.0\n"
                "Camera.p1: 0.0\nCamera.p2: 0.0\nCamera.width: {width}\nCamera.height: {height}\n",
    "realsense": '{{"width": {width}, "height": {height}, "ppx": {cx}, "ppy": {cy}, "fx": {fx}, '
                 '"fy": {fy}, "model": "distortion.brown_conrady", "coeffs": [0, 0, 0, 0, 0]}}',
    "nerfstudio": '{{"fl_x": {fx}, "fl_y": {fy}, "cx": {px}, "cy": {py}, "w": {width}, '
                  '"h": {height}, "camera_model": "OPENCV"}}',
    "opencv_sample": "%YAML:1.0\nimage_width: {width}\nimage_height: {height}\n"
                     "M1: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                     "   data: [{fx}, 0., {cx}, 0., {fy}, {cy}, 0., 0., 1.]\n"
                     "D1: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
                     "   data: [0., 0., 0., 0., 0.]\n",
}


def camera_format_mutant(rng: Random) -> Mutant:
    name, text = rng.choice(list(FORMATS.items()))
    camera = {"fx": rng.randrange(120, 400) / 4, "fy": rng.randrange(120, 400) / 4,
              "cx": rng.randrange(60, 100) / 4, "cy": rng.randrange(40, 80) / 4}
    words: dict[str, object] = {**camera, "px": camera["cx"] + 0.5, "py": camera["cy"] + 0.5,
                                "width": WIDTH, "height": HEIGHT}
    spoilt = rng.random() < 0.5
    if spoilt:
        key = rng.choice([key for key in words if "{" + key + "}" in text])
        words[key] = rng.choice(["far", ".nan", "1e999", "-5", "'", "40;5", "[", "0x1F"])
    written = text.format(**words)
    if rng.random() < 0.3:
        written = written.replace("\n", "\r\n")
    files: dict[str, object] = {"frames/0.png": png(WIDTH, HEIGHT), "cam.txt": written.encode()}
    command = ["data", "info", "frames", "--camera", "cam.txt", "--json"]
    # A negative image centre is legal in a camera; the other sampled values are not.
    may_be = spoilt and words[key] == "-5" and key in ("cx", "cy", "px", "py")
    if spoilt and not may_be:
        mutant = refused(f"{name} with {key}: {words[key]}", files, command, "cam.txt")
        mutant.kind = "camera format"
        return mutant

    def same(_program: Program, _folder: Path, answer: Answer) -> str:
        found = info(answer)["camera"]
        wrong = [k for k in camera if not may_be and abs(found[k] - camera[k]) > 1e-9]
        return f"{name}: {wrong} of {found}" if wrong else ""

    return Mutant("camera format", files, command, same=same,
                  refusable="cam.txt" if may_be else None)
