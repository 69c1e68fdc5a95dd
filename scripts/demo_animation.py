#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the moving image of the README from a run: demo_animation.py RUN OUT.webp

Joins the stills that sinks/overlay wrote to RUN/overlay into an animated WebP that repeats without
end. To make docs/images/demo.webp:

  weft run pipelines/demo.yaml --set overlay.stills_every=3 --out runs/animation
  scripts/demo_animation.py runs/animation docs/images/demo.webp

Prints the number of stills and the size. Exits 1 if there are less than two stills or if the file
would have more than MOST_BYTES, 2 on wrong usage. Needs Pillow (Debian: python3-pil).
"""

import io
import sys
from pathlib import Path

from PIL import Image

SHOWN_MS = 100  # duration of each still; every third frame of 30 a second
WIDTH_PX = 680
QUALITY = 40
MOST_BYTES = 500_000  # as scripts/check_large_files.sh allows


def stills_of(folder: Path) -> list[Image.Image]:
    """The stills of a run, in the order of frames, WIDTH_PX wide."""
    stills = [Image.open(file).convert("RGB") for file in sorted(folder.glob("overlay/[0-9]*.*"))]
    return [still.resize((WIDTH_PX, round(still.height * WIDTH_PX / still.width)),
                         Image.Resampling.LANCZOS) for still in stills]


def animation_of(stills: list[Image.Image]) -> bytes:
    """The bytes of the animated WebP."""
    coded = io.BytesIO()
    stills[0].save(coded, "WEBP", save_all=True, append_images=stills[1:], duration=SHOWN_MS, loop=0,
                   quality=QUALITY)
    return coded.getvalue()


def main(arguments: list[str]) -> int:
    if len(arguments) != 2 or not arguments[1].endswith(".webp"):
        print(__doc__, file=sys.stderr)
        return 2
    stills = stills_of(Path(arguments[0]))
    if len(stills) < 2:
        print(f"{arguments[0]}/overlay has less than two stills", file=sys.stderr)
        return 1
    coded = animation_of(stills)
    if len(coded) > MOST_BYTES:
        print(f"the animation has {len(coded)} bytes, more than {MOST_BYTES}", file=sys.stderr)
        return 1
    Path(arguments[1]).write_bytes(coded)
    print(f"{arguments[1]}: {len(stills)} stills, {len(coded)} bytes")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
