# SPDX-License-Identifier: Apache-2.0
"""What killed writers leave: temporary files, files that are cut off, and lines that are not ended.

The answer is known from what was finished: it is all read, and nothing else is. Or the file that is
not whole is named with a remedy.
"""

from __future__ import annotations

import json
import re
import tempfile
from pathlib import Path
from random import Random

from found_mesh_mutants import as_bytes, binary_ply
from image_mutants import CAMERA, HEIGHT, WIDTH
from judging import Mutant
from mesh_mutants import ply_lines
from pictures import png
from program import Answer, Program
from run_mutants import EVALUATION, PIPELINE
from victims import whole_lines

FILMED = PIPELINE + """\
sinks:
  - {use: sinks/overlay, params: {path: overlay.avi}}
  - {use: sinks/meshes, params: {path: meshes}}
"""
PLAN = """\
weft: 1
name: plan
pipeline: pipeline.yaml
data_use: tuning
axes: {every: {set: filters.every, values: [2, 3]}}
data: {plain: {seeds: 2-3, seed_setting: source.frames}}
comparisons: [{axis: every, metric: all.error_solved.mean_mm}]
"""
ABLATION = ["ablate", "plan.yaml", "--out", "out", "--jobs", "1", "--isolate", "none"]
INFO = ["data", "info", "sequence.yaml", "--json"]
SEQUENCE = "weft: 1\nsource: {use: sources/images, params: {path: PATH, camera: camera.yaml, truth: TRUTH}}\n"


def contents(folder: Path, top: str) -> dict[str, object]:
    return {f"{top}/{file.relative_to(folder)}": file.read_bytes()
            for file in sorted(folder.rglob("*")) if file.is_file()}


def beginning(rng: Random, data: object) -> bytes:
    return data[:rng.randrange(len(data))]


def unfinished(rng: Random, name: str) -> str:
    """As Weft names a file that is not yet whole."""
    return f"{name}.{rng.randrange(16 ** 12):012x}.part"


def of_another_program(rng: Random, name: str) -> str:
    return rng.choice([name + ".part", name + ".pt", name + ".tmp", name + "~", name + ".crdownload",
                       name + ".filepart", name + ".swp"])


def refused(what: str, files: dict[str, object], command: list[str], name: str) -> Mutant:
    def never(_program: Program, _folder: Path, _answer: Answer) -> str:
        return f"{what} was taken"

    return Mutant("part file", files, command, same=never, refusable=name)


# --- sequences ------------------------------------------------------------------------------------


def sequence_mutant(rng: Random, truth: object) -> Mutant:
    """A folder of images and truth whose writer was killed while it wrote the last frame."""
    count = rng.randrange(2, 5)
    last = f"{count - 1:06}"
    whole = rng.random() < 0.6  # else names are matched that no image has
    text = SEQUENCE.replace("PATH", "frames/*.png" if whole else '"frames/*"')
    text = text.replace("TRUTH", "gt/*.npz" if whole else '"gt/*"')
    files: dict[str, object] = {"sequence.yaml": text.encode(), "camera.yaml": CAMERA}
    for i in range(count):
        files[f"frames/{i:06}.png"] = png(WIDTH, HEIGHT)
        files[f"gt/{i:06}.npz"] = truth
    frames, failed = count, ""
    kind = rng.randrange(7)
    if kind == 0:  # truth comes before the image
        del files[f"frames/{last}.png"]
        return refused("truth without its image", files, INFO, f"gt/{last}.npz")
    if kind == 1:
        del files["camera.yaml"]
        files[unfinished(rng, "camera.yaml")] = beginning(rng, CAMERA)
        return refused("a camera that is not there", files, INFO, "camera.yaml")
    if kind == 2:
        files["camera.yaml"] = beginning(rng, CAMERA[:-2])
        return refused("a camera that is cut off", files, INFO, "camera.yaml")
    if kind == 3:  # by a program that does not rename
        failed = f"frames/{last}.png"
        files[failed] = beginning(rng, files[failed])
    elif kind == 4:
        failed = f"gt/{last}.npz"
        files[failed] = beginning(rng, files[failed])
    elif kind == 5:
        files[unfinished(rng, f"frames/{count:06}.png")] = beginning(rng, png(WIDTH, HEIGHT))
        files[unfinished(rng, f"gt/{count:06}.npz")] = beginning(rng, truth)
    else:
        name = of_another_program(rng, f"frames/{count:06}.png")
        files[name] = beginning(rng, png(WIDTH, HEIGHT))
        if not whole:
            frames, failed = count + 1, name

    def finished(_program: Program, _folder: Path, answer: Answer) -> str:
        found = json.loads(answer.out)
        named = [failed] if failed else []
        if found["frames"] != frames or len(found["failures"]) != len(named):
            return f"{found['frames']} frames of {frames}, failures {found['failures']}"
        if any(name not in text for name, text in zip(named, found["failures"])):
            return f"{failed} is not named: {found['failures']}"
        readable = count - (failed in files and failed in (f"frames/{last}.png", f"gt/{last}.npz"))
        return "" if found["frames_with_truth"] == readable else f"{readable} frames have truth"

    return Mutant("part file", files, INFO, same=finished, codes=(1,) if failed else (0,))


# --- meshes ---------------------------------------------------------------------------------------


def mesh_mutant(rng: Random) -> Mutant:
    pipeline = ("weft: 1\nsource: {use: sources/test.scripted}\ntemplate: {use: templates/mesh, "
                "params: {mesh: mesh.ply, texture: texture.png}}\n").encode()
    text = as_bytes(ply_lines())
    mesh, cuttable = rng.choice([(text, text.rindex(b" ")), (binary_ply(rng)[1], -1)])
    files: dict[str, object] = {"pipeline.yaml": pipeline, "texture.png": png(40, 30)}
    command = ["template", "show", "pipeline.yaml", "--json"]
    kind = rng.randrange(3)
    if kind == 0:
        files["mesh.ply"] = beginning(rng, mesh[:cuttable])
        return refused("a mesh that is cut off", files, command, "mesh.ply")
    if kind == 1:
        files[unfinished(rng, "mesh.ply")] = beginning(rng, mesh)
        return refused("a mesh that is not there", files, command, "pipeline.yaml:3:")
    files["mesh.ply"] = mesh
    files[unfinished(rng, "mesh.ply")] = beginning(rng, mesh)
    return Mutant("part file", files, command)


class PartFiles:
    """A whole run with a film, and a whole ablation, made once."""

    def __init__(self, program: Program) -> None:
        with tempfile.TemporaryDirectory(prefix="weft-parts-") as name:
            folder = Path(name)
            (folder / "pipeline.yaml").write_text(FILMED)
            self.make(program, folder, "run", "pipeline.yaml", "--out", "run", "--quiet")
            (folder / "pipeline.yaml").write_text(PIPELINE)
            (folder / "plan.yaml").write_text(PLAN)
            self.make(program, folder, *ABLATION, "--quiet")
            self.film = (folder / "run/overlay.avi").read_bytes()
            self.run = contents(folder / "run", "run")
            self.ablation = contents(folder / "out", "out")
            for name in ("pipeline.yaml", "plan.yaml"):
                self.ablation[name] = (folder / name).read_bytes()

    @staticmethod
    def make(program: Program, folder: Path, *command: str) -> None:
        made = program.ask(folder, *command)
        if made.hung or made.code != 0:
            raise RuntimeError(f"what is to be left half-made was not made: {made.text}")

    def mutant(self, rng: Random) -> Mutant:
        kind = rng.randrange(8)
        if kind < 3:
            return sequence_mutant(rng, self.run["run/frames/000000.npz"])
        if kind == 3:
            return mesh_mutant(rng)
        if kind == 4:
            return self.film_mutant(rng)
        return self.run_mutant(rng) if kind < 7 else self.ablation_mutant(rng)

    def run_mutant(self, rng: Random) -> Mutant:
        """A run that was killed: the frames that have their lines are evaluated."""
        files = dict(self.run)
        lines = files["run/frames.jsonl"].splitlines(keepends=True)
        kept = rng.randrange(1, len(lines) + 1)
        begun = beginning(rng, lines[kept]) if kept < len(lines) else b""
        files["run/frames.jsonl"] = b"".join(lines[:kept]) + begun
        for i in range(kept + (rng.random() < 0.5), len(lines)):
            del files[f"run/frames/{i:06}.npz"]
        for name in ("end.json", "trace.json", "overlay.avi"):
            whole = files.pop("run/" + name)
            if rng.random() < 0.5:
                files[unfinished(rng, "run/" + name)] = beginning(rng, whole)
        for name in rng.sample(["frames/000005.npz", "meshes/000005.ply", "manifest.json"], 2):
            files[unfinished(rng, "run/" + name)] = beginning(rng, files["run/template.npz"])
        has_manifest = rng.random() > 0.15
        if not has_manifest:
            del files["run/manifest.json"]

        def same(_program: Program, _folder: Path, answer: Answer) -> str:
            found = json.loads(answer.out)
            if not has_manifest and "manifest.json: is missing" not in answer.err:
                return "nothing said of the manifest"
            right = found["counts"]["frames"] == kept and found["interrupted"]
            return "" if right else f"{found['counts']}, interrupted {found['interrupted']}: {kept}"

        return Mutant("part file", files, EVALUATION, same=same)

    def ablation_mutant(self, rng: Random) -> Mutant:
        """An ablation that was killed: cells that have their lines stay, the others are run."""
        files = dict(self.ablation)
        results = [name for name in sorted(files) if name.startswith("out/results/")]
        name = rng.choice(results)
        lines = files[name].splitlines(keepends=True)
        cut = rng.randrange(len(lines))
        files[name] = b"".join(lines[:cut]) + beginning(rng, lines[cut])
        kept = {line for result in results for line in files[result].splitlines(keepends=True)
                if line.endswith(b"\n")}
        again = "out/cells/" + json.loads(lines[cut])["key"] + "/shapes.npz"  # cell that runs again
        for each in ("out/manifest.json", "out/plan.json", "out/index.sqlite", again):
            if rng.random() < 0.6:
                files[unfinished(rng, each)] = beginning(rng, files[each])
        for each in ("out/manifest.json", "out/plan.json", "out/index.sqlite"):
            if rng.random() < 0.2:
                files[each] = beginning(rng, files[each])
        cells_in_all = sum(len(self.ablation[each].splitlines()) for each in results)

        def continued(_program: Program, folder: Path, answer: Answer) -> str:
            done = re.search(r"(\d+) done, 0 failed, 0 left", answer.out)
            if done is None or int(done[1]) != cells_in_all:
                return f"not {cells_in_all} cells: {answer.text[:300]}"
            there = {line + b"\n" for result in (folder / "out/results").glob("*.jsonl")
                     for line in whole_lines(result)}
            if not kept <= there:
                return f"{len(kept - there)} finished cells were lost"
            left = [str(file) for file in (folder / "out").rglob("*.part")]
            return f"stays there: {left}" if left else ""

        return Mutant("part file", files, ABLATION + ["--quiet"], same=continued)

    def film_mutant(self, rng: Random) -> Mutant:
        """A film that is cut off: its frames up to there are read, or its file is named."""
        film = beginning(rng, self.film)
        files: dict[str, object] = {"overlay.avi": film}
        marks = film.count(b"00dc") - film[film.rfind(b"idx1"):].count(b"00dc") * (b"idx1" in film)

        def frames_before(_program: Program, _folder: Path, answer: Answer) -> str:
            found = json.loads(answer.out)
            read = found["frames"] - len(found["failures"])
            if any("overlay.avi" not in text for text in found["failures"]):
                return f"the film is not named: {found['failures']}"
            return "" if marks - 1 <= read <= marks else f"{read} of {marks} frames"

        return Mutant("part file", files, ["data", "info", "overlay.avi", "--camera", "auto", "--json"],
                      same=frames_before, refusable="overlay.avi", codes=(0, 1))
