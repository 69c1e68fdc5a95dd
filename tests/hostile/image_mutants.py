# SPDX-License-Identifier: Apache-2.0
"""Mutants of image files: orientations of EXIF, and names whose numbers have no leading zeros.

The answer is known from the construction: how frames are turned is what `weft data info` reports of
the camera, and the order of frames is that of their numbers.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path
from random import Random

from judging import Mutant
from pictures import chunk, png
from program import Answer, Program

WIDTH, HEIGHT = 40, 30  # px, of the sensor
FX, FY, CX, CY = 41.0, 42.0, 18.5, 13.25
CAMERA = f"{{fx: {FX}, fy: {FY}, cx: {CX}, cy: {CY}, width: {WIDTH}, height: {HEIGHT}}}\n".encode()
ROTATED = {1: (FX, FY, CX, CY), 3: (FX, FY, WIDTH - 1 - CX, HEIGHT - 1 - CY),
           6: (FY, FX, HEIGHT - 1 - CY, CX), 8: (FY, FX, CY, WIDTH - 1 - CX)}


def exif(orientation: int, big: bool) -> bytes:
    """The smallest EXIF data: one directory with one entry."""
    order = ">" if big else "<"
    head = (b"MM" if big else b"II") + struct.pack(order + "HI", 42, 8)
    entry = struct.pack(order + "HHHIHHI", 1, 0x112, 3, 1, orientation, 0, 0)
    return head + entry


def turned(image: bytes, orientation: int, big: bool) -> bytes:
    """The PNG with a chunk eXIf behind its head."""
    return image[:33] + chunk(b"eXIf", exif(orientation, big)) + image[33:]


def info(answer: Answer) -> dict:
    return json.loads(answer.out)


def orientation_mutant(rng: Random) -> Mutant:
    """Frames of one orientation, or one among them that has another."""
    orientation, count = rng.randrange(0, 10), rng.randrange(1, 5)
    big = rng.random() < 0.5
    as_upright = rng.random() < 0.3 and orientation in (6, 8)  # the size that was calibrated
    stored = (HEIGHT, WIDTH) if as_upright else (WIDTH, HEIGHT)
    files: dict[str, object] = {
        f"frames/{i}.png": turned(png(*stored), orientation, big) for i in range(count)}
    files["camera.yaml"] = CAMERA
    command = ["data", "info", ".", "--json"]
    effective = orientation if 1 <= orientation <= 8 else 1
    if count > 1 and rng.random() < 0.3:
        other = rng.choice([k for k in range(1, 9) if k != effective])
        files[f"frames/{count - 1}.png"] = turned(png(*stored), other, big)
        return refused("mixed orientations", files, command, f"{count - 1}.png")
    if effective not in ROTATED:
        return refused("mirrored", files, command, "0.png")
    expected = (FX, FY, CX, CY) if as_upright else ROTATED[effective]

    def same(_program: Program, _folder: Path, answer: Answer) -> str:
        camera = info(answer)["camera"]
        found = tuple(camera[key] for key in ("fx", "fy", "cx", "cy"))
        near = all(abs(a - b) < 1e-9 for a, b in zip(found, expected))
        return "" if near else f"orientation {orientation}: camera {found}, not {expected}"

    return Mutant("image", files, command, same=same)


def refused(what: str, files: dict[str, object], command: list[str], name: str) -> Mutant:
    """It must be refused with the file's name: no exit code of a success is right."""
    def never(_program: Program, _folder: Path, _answer: Answer) -> str:
        return f"{what} were taken"

    return Mutant("image", files, command, same=never, refusable=name)


def order_mutant(rng: Random) -> Mutant:
    """Numbers of different lengths in names: the first and the last frame are known."""
    before, after = rng.choice(["", "img_", "a1_", "f-"]), rng.choice(["", "_l", ".0"])
    numbers = rng.sample(range(0, 10 ** rng.randrange(1, 5) + 10), rng.randrange(2, 9))
    padded = rng.choice([0, 0, 2, 3])
    names = {number: f"{before}{number:0{padded}d}{after}" for number in numbers}
    files: dict[str, object] = {f"frames/{name}.png": png(WIDTH, HEIGHT)
                                for name in names.values()}
    files["camera.yaml"] = CAMERA
    first, last = names[min(numbers)], names[max(numbers)]
    ordered = [names[number] for number in sorted(numbers)]

    def same(_program: Program, _folder: Path, answer: Answer) -> str:
        found = info(answer)
        if (found["first_stem"], found["last_stem"]) != (first, last):
            return f"{found['first_stem']} to {found['last_stem']}, not {first} to {last}"
        stated = any("in the order of the numbers" in text for text in found["findings"])
        files_of = [f"{name}.png" for name in ordered]
        return "" if stated == (files_of != sorted(files_of)) else "the order is not stated"

    return Mutant("image", files, ["data", "info", ".", "--json"], same=same)


def image_mutant(rng: Random) -> Mutant:
    return rng.choice([orientation_mutant, order_mutant])(rng)
