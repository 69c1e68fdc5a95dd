# SPDX-License-Identifier: Apache-2.0
"""Templates whose scale is that of another file or in another unit, read by `weft check`."""

from __future__ import annotations

from pathlib import Path
from random import Random

from judging import Expected, Mutant
from pictures import png
from program import Answer, Program

SOURCE = "source: {use: sources/test.scripted}\n"


def base(width: str) -> bytes:
    return ("weft: 1\n" + SOURCE + "template:\n  use: templates/rectangular\n"
            f"  params: {{texture: base.png, width_m: {width}}}\n").encode()


def scale_mutant(rng: Random) -> Mutant:
    files: dict[str, object] = {"base.png": png(40, 30), "own.png": png(40, 30)}
    command = ["check", "pipeline.yaml"]
    kind = rng.randrange(4)
    if kind == 0:  # only the image is replaced, through a file between or not
        files["base.yaml"] = base("0.3")
        between = rng.random() < 0.5
        files["between.yaml"] = b"weft: 1\nextends: base.yaml\nseed: 4\n"
        blank = " " * rng.randrange(1, 5)
        files["pipeline.yaml"] = (
            f"weft: 1\nextends: {'between' if between else 'base'}.yaml\ntemplate:\n  params:\n"
            f"    texture:{blank}own.png\n").encode()
        return Mutant("scale", files, command,
                      [Expected("inherited length", "pipeline.yaml", 5, 13 + len(blank))])
    if kind == 1:  # with its length, or as the same file under another name
        files["base.yaml"] = base("0.3")
        params = rng.choice(["texture: own.png, width_m: 0.4", "texture: ./base.png", "columns: 5"])
        files["pipeline.yaml"] = (
            f"weft: 1\nextends: base.yaml\ntemplate: {{params: {{{params}}}}}\n").encode()
        return Mutant("scale", files, command)
    if kind == 2:  # by settings, which the command line gives in either order
        files["pipeline.yaml"] = base("0.3")
        settings = ["template.texture=own.png", "template.width_m=0.4"]
        rng.shuffle(settings)
        for setting in settings:
            command += ["--set", setting]
        return Mutant("scale", files, command)
    width = rng.choice(["29.7", "297", "5.01", "0.000297", "0.0049"])
    files["pipeline.yaml"] = base(width)

    def warns(program: Program, folder: Path, answer: Answer) -> str:
        said = "pipeline.yaml:5:" in answer.err and "'width_m'" in answer.err
        return "" if said else f"no warning of {width} m: {answer.err[:200]}"

    return Mutant("scale", files, command, same=warns)
