#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the YAML blocks of all pages by `weft check`: documented_yaml.py WEFT ROOT [EXAMPLES]

A reader's folder is made: a copy of pipelines/ by links, its plans in `ablations`, and stand-ins for the
files that pages take from their readers (STAND_INS). All blocks become files there, which one
`weft check` reads:

- below `<!-- quote: PATH ... -->`: that file of this repository, of which the block is a part
  (tests/architecture/documentation.py compares the two), without the plugins in the folder EXAMPLES;
- with the key `weft`: as it stands; a plan in `ablations`;
- anything else is part of a variant, as the pages teach it: a list is one of `stages`, keys are those of a
  pipeline, and both are laid over `sparse.yaml` by `extends`. What makes no sense there names the file over
  which it is to be laid, a plan perhaps, in the line before it: `<!-- over: pipelines/near.yaml -->`.

A block that cannot be checked says why in the line before it: `<!-- not checked: the reason -->`. There
are NOT_CHECKED of these; another one is to be counted here. A block of no language that has components
in it is a mistake, for nobody would check it. Pages of the scaffold are of plugins that are not there yet:
scaffold_test.py finds their blocks in pipelines that it runs.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import textwrap

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "architecture"))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "hostile"))
from documentation import QUOTE, pages  # noqa: E402
from pictures import png  # noqa: E402

NOT_CHECKED = 2
SCAFFOLD = "framework/kit/scaffold/"
BASE = "pipelines/sparse.yaml"
FENCE = re.compile(r"^(\s*)```(\S*)")
OVER = re.compile(r"<!-- over: (\S+) -->")
EXCUSE = re.compile(r"<!-- (?:file: \S+, )?not checked: (\S.*) -->")
COMPONENT = re.compile(r"^\s*(?:- )?(?:\w+: )?\{?use: \w+/")
EXCERPT = re.compile(r" +(\d+ )?\| ")  # a line of the file, and the caret under it
PLACE = re.compile(r"^(\S+?):(\d+):(\d+): ")

CAMERA = "fx: 100\nfy: 100\ncx: 80\ncy: 60\nwidth: 160\nheight: 120\ndistortion: null\n"
CLOUD = ("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n0 0 500\n")
POINTS = "X_m,Y_m,Z_m\n0,0,0.5\n"
VIDEO = b"YUV4MPEG2 W160 H120 F25:1 C420\n" + 2 * (b"FRAME\n" + bytes(160 * 120 * 3 // 2))
SHEET = "marker_sheet: 1\ndictionary: 5x5_250\nwidth_mm: 200\nheight_mm: 60\nmarkers:\n" + "".join(
    f"  - {{id: {i}, centre_mm: [{x + 5}, {y + 5}], "
    f"corners_mm: [[{x}, {y}], [{x + 10}, {y}], [{x + 10}, {y + 10}], [{x}, {y + 10}]]}}\n"
    for i, (x, y) in enumerate((20 * column, 20 * row) for row in range(3) for column in range(10)))
SEQUENCE = """weft: 1
source: {use: sources/images, params: {path: ../frames/*.png, camera: ../camera.yaml}}
template: {use: templates/rectangular, params: {texture: ../texture.png, width_m: 0.297}}
"""
# Files that pages call by these names; a path is that file of this repository.
STAND_INS = {
    "frames/0001.png": png(160, 120),
    "masks/0001.png": png(160, 120),
    "photos/1.jpg": pathlib.Path("pipelines/data/sheet_photo.jpg"),
    "camera.yaml": CAMERA,
    "camera.json": CAMERA,
    "texture.png": png(160, 120),
    "poster.png": png(160, 120),
    "poster.jpg": pathlib.Path("pipelines/data/sheet_photo.jpg"),
    "print.png": png(160, 120),
    "gt/visible/0001.ply": CLOUD,
    "gt/hidden/0001.ply": CLOUD,
    "gt/0001_mdh_visible.csv": POINTS,
    "gt/0001_hidden.ply": CLOUD,
    "scans/0001.ply": CLOUD,
    "film.mp4": VIDEO,
    "film.avi": VIDEO,
    "clip.mp4": VIDEO,
    "sheet.yaml": SHEET,
    "network.yaml": pathlib.Path("pipelines/data/networks/sheet.yaml"),
    "sheet.onnx": pathlib.Path("pipelines/data/networks/sheet.onnx"),
    "sheet/sheet.yaml": pathlib.Path("pipelines/data/networks/sheet.yaml"),
    "sheet/sheet.onnx": pathlib.Path("pipelines/data/networks/sheet.onnx"),
    "grippers.csv": pathlib.Path("pipelines/data/grippers.csv"),
    "insole.png": pathlib.Path("pipelines/data/insole.png"),
    "label.obj": pathlib.Path("pipelines/data/label.obj"),
    "block.obj": pathlib.Path("pipelines/data/block.obj"),
    "box.obj": pathlib.Path("pipelines/data/block.obj"),
    "box.mp4": VIDEO,
    "sets": pathlib.Path("pipelines/data/match_set/matches"),
    "D/sequence.yaml": SEQUENCE,
    "ablations/filmed/0001.png": png(160, 120),
    "ablations/filmed/camera.yaml": CAMERA,
    "frex/a/frames/0001.png": png(160, 120),  # WEFT_DATA is the reader's folder
    "frex/a/camera.yaml": CAMERA,
}


class Block:
    def __init__(self, page, number, indent, lines, before):
        self.page, self.number, self.indent = page, number, indent  # first line
        self.text = textwrap.dedent("\n".join(lines)) + "\n"
        self.quote, self.over, self.excuse = (
            kind.search(before) for kind in (QUOTE, OVER, EXCUSE))

    def has_key(self, *keys):
        return re.search(rf"^(?:{'|'.join(keys)}):", self.text, re.MULTILINE) is not None


def blocks(page, name):
    """The YAML blocks of a page, and the lines of those that have components but no language."""
    lines = page.read_text(encoding="utf-8").splitlines()
    found, nameless, number = [], [], 0
    while number < len(lines):
        fence = FENCE.match(lines[number])
        number += 1
        if not fence:
            continue
        end = next((i for i in range(number, len(lines)) if lines[i].strip() == "```"), len(lines))
        body = lines[number:end]
        if fence[2] in ("yaml", "yml"):
            before = lines[number - 2] if number > 1 else ""
            found.append(Block(name, number + 1, len(fence[1]), body, before))
        elif not fence[2] and any(COMPONENT.match(line) for line in body):
            nameless.append(number)
        number = end + 1
    return found, nameless


def as_file(block, name):
    """Path and text of the block as a whole file, and how many lines stand before its own."""
    base = block.over[1] if block.over else BASE
    plan = base.startswith("pipelines/ablations/") or block.has_key("axes", "data", "data_use")
    path = f"ablations/{name}.yaml" if plan else f"{name}.yaml"
    if block.has_key("weft"):
        return path, block.text, 0
    first = next((line for line in block.text.splitlines() if line.lstrip()[:1] not in ("", "#")), "")
    head = f"weft: 1\nextends: {pathlib.Path(base).name}\n"
    head += f"name: {name}\n" if plan else ""
    head += "stages:\n" if first.startswith("- ") else ""
    return path, head + block.text, head.count("\n")


def make_folder(root, folder):
    for source, target in ((root / "pipelines", folder),
                           (root / "pipelines/ablations", folder / "ablations")):
        target.mkdir(exist_ok=True)
        for file in source.iterdir():
            if file.name != "ablations":
                (target / file.name).symlink_to(file)
    (folder / "pipelines").symlink_to(folder)
    for name, content in STAND_INS.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        if isinstance(content, pathlib.PurePath):
            (folder / name).symlink_to(root / content)
        else:
            (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())


def check(weft, root, examples, folder):
    """Problems with their places, and numbers of blocks: all, and those that are not checked."""
    make_folder(root, folder)
    files, quoted, problems, count, excused = {}, {}, [], 0, 0
    for page in pages(root):
        name = str(page.relative_to(root))
        if name.startswith(SCAFFOLD):
            continue
        found, nameless = blocks(page, name)
        problems += [f"{name}:{number}: is this block YAML? Say so behind its ```"
                     for number in nameless]
        for block in found:
            count += 1
            if block.excuse:
                excused += 1
            elif block.quote:
                quoted[str(root / block.quote[1])] = None
            elif block.over and not (root / block.over[1]).is_file():
                problems.append(f"{name}:{block.number - 2}: there is no {block.over[1]}")
            else:
                path, text, offset = as_file(block, f"block_{count}")
                (folder / path).write_text(text, encoding="utf-8")
                files[path] = (block, offset)
    with_examples = [weft, *(["--plugin-path", examples] if examples else [])]
    problems += problems_of([weft, "check"], quoted, folder)
    problems += problems_of([*with_examples, "check"], files, folder)
    return problems, count, excused


def problems_of(command, files, folder):
    """What `weft check` says of files that it does not accept."""
    accepted = {line.split(": ok, ")[0]
                for line in run([*command, *files], folder, subprocess.DEVNULL) if ": ok, " in line}
    for path, place in files.items():
        if path not in accepted:  # checked alone, so that messages about a base are its own
            said = [line for line in run([*command, path], folder, subprocess.STDOUT)
                    if not EXCERPT.match(line)]
            yield from at_their_places(said, place) if place else said
            yield from [] if said else [f"{path}: weft check says nothing"]


def run(command, folder, errors):
    environment = os.environ | {"WEFT_DATA": str(folder)}
    return subprocess.run(command, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=errors, check=False).stdout.splitlines()


def at_their_places(lines, place):
    """What the program says of a block's file, with places of the page."""
    block, offset = place
    for line in lines:
        at = PLACE.match(line)
        if at and pathlib.Path(at[1]).stem.startswith("block_"):
            number = int(at[2]) - offset + block.number - 1
            yield f"{block.page}:{number}:{int(at[3]) + block.indent}: {line[at.end():]}"
        else:
            yield f"{block.page}:{block.number}: {line}"


def main():
    if len(sys.argv) < 3:
        print(__doc__)
        return 2
    weft, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    folder = pathlib.Path(tempfile.mkdtemp())
    try:
        problems, count, excused = check(weft, root, (sys.argv[3:] or [""])[0], folder)
    finally:
        shutil.rmtree(folder)
    if excused != NOT_CHECKED:
        problems.append(f"{excused} blocks are not checked, and NOT_CHECKED says {NOT_CHECKED}")
    print(*problems, f"{count} blocks, {excused} not checked, {len(problems)} problems", sep="\n")
    return 1 if problems or not count else 0


if __name__ == "__main__":
    sys.exit(main())
