# SPDX-License-Identifier: Apache-2.0
"""Mutants of run folders: `weft eval` refuses them, or its figures are those of the whole run."""

from __future__ import annotations

import json
import tempfile
from pathlib import Path
from random import Random

from judging import FOLDER, Mutant
from program import Answer, Program

PIPELINE = """\
weft: 1
source: {use: sources/test.scripted, params: {frames: 5, truth: true, no_result_at: [2]}}
template: {use: templates/test.scripted}
stages:
  - {use: detectors/test.scripted}
  - {use: matchers/test.scripted}
  - {use: filters/test.scripted, params: {every: 3}}
  - {use: warps/test.scripted}
  - {use: passes/test.scripted}
  - {use: solvers/test.scripted, params: {weak_at: [3]}}
"""
EVALUATION = ["eval", "run", "--no-save", "--json", "-"]


class RunFolders:
    """A whole run and its figures, made once."""

    def __init__(self, program: Program) -> None:
        with tempfile.TemporaryDirectory(prefix="weft-run-") as name:
            folder = Path(name)
            (folder / "pipeline.yaml").write_text(PIPELINE)
            made = program.ask(folder, "run", "pipeline.yaml", "--out", "run", "--quiet")
            if made.hung or made.code != 0:
                raise RuntimeError(f"the run to spoil was not made: exit {made.code}, {made.text}")
            run = folder / "run"
            self.files = {f"run/{file.relative_to(run)}": file.read_bytes()
                          for file in sorted(run.rglob("*")) if file.is_file()}
            self.figures = json.loads(program.ask(folder, *EVALUATION).out)

    def same(self, program: Program, folder: Path, answer: Answer) -> str:
        """Equal figures, or those of a run that is said to be interrupted."""
        figures = json.loads(answer.out)
        if figures == self.figures or figures["interrupted"]:
            return ""
        return "other figures than the whole run, and nothing said"

    def mutant(self, rng: Random) -> Mutant:
        files: dict[str, object] = dict(self.files)
        name = rng.choice([spoil_lines, spoil_lines, spoil_archive, spoil_archive, spoil_manifest,
                           decorate])(rng, files)
        return Mutant("run", files, EVALUATION, same=self.same, refusable=name)

    def bytes_mutant(self, rng: Random) -> Mutant:
        files: dict[str, object] = dict(self.files)
        name = rng.choice([name for name in sorted(files) if not name.endswith("trace.json")])
        files[name] = flipped(rng, files[name])
        return Mutant("bytes of a run", files, EVALUATION, same=self.same,
                      refusable=Path(name).name)


def flipped(rng: Random, data: bytes) -> bytes:
    """One to three bytes changed, taken out or put in, or the end cut off."""
    changed = bytearray(data)
    for _ in range(rng.randrange(1, 4)):
        place = rng.randrange(len(changed)) if changed else 0
        kind = rng.randrange(5)
        if kind == 0 and changed:
            changed[place] ^= 1 << rng.randrange(8)
        elif kind == 1 and changed:
            del changed[place:place + rng.randrange(1, 9)]
        elif kind == 2:
            changed[place:place] = rng.randbytes(rng.randrange(1, 5))
        elif kind == 3 and changed:
            changed[place] = rng.choice([0, 9, 10, 13, 27, 34, 39, 92, 123, 125, 127, 128, 255])
        elif kind == 4 and rng.random() < 0.3:
            del changed[place:]
    return bytes(changed)


def spoil_lines(rng: Random, files: dict[str, object]) -> str:
    """frames.jsonl with lines that are gone, twice, cut or wrong."""
    name = "run/frames.jsonl"
    lines = files[name].splitlines(keepends=True)
    at, kind = rng.randrange(len(lines)), rng.randrange(8)
    if kind == 0:
        del lines[at]
    elif kind == 1:
        lines.insert(at, lines[at])
    elif kind == 2:
        lines[-1] = lines[-1][:rng.randrange(len(lines[-1]))]
    elif kind == 3:
        lines[at] = lines[at][:rng.randrange(1, len(lines[at]) - 1)] + b"\n"
    elif kind == 4:
        state = rng.choice([b"weak", b"none", b"lost", b"\x1b"])
        lines[at] = lines[at].replace(b"estimated", state)
    elif kind == 5:
        wrong = rng.choice([b"-1", b"99", b"1e3", b"99999999999999999999", b'"0"', b"null"])
        lines[at] = lines[at].replace(f'"frame":{at}'.encode(), b'"frame":' + wrong)
    elif kind == 6:
        lines[at] = rng.choice([b"[" * 100_000 + b"\n", b"{}\n", b"null\n", b"\xff\n", b"\n"])
    else:
        lines = []
    files[name] = b"".join(lines)
    return "frames.jsonl"


def spoil_archive(rng: Random, files: dict[str, object]) -> str:
    """An npz file that is gone, cut, flipped, another one, a folder, or larger than it is."""
    archives = [name for name in sorted(files) if name.endswith(".npz")]
    name, other = rng.sample(archives, 2)
    data, kind = bytearray(files[name]), rng.randrange(8)
    if kind == 0:
        del files[name]
    elif kind == 1:
        files[name] = bytes(data[:rng.randrange(len(data))])
    elif kind == 2:
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        files[name] = bytes(data)
    elif kind == 3:
        files[name] = files[other]
    elif kind == 4:
        files[name] = FOLDER
    elif kind == 5:
        files[name] = b""
    elif kind == 6:
        at = data.find(b"PK\x01\x02") + 20  # sizes in the directory
        data[at:at + 8] = b"\xf0\xff\xff\x7f" * 2
        files[name] = bytes(data)
    else:
        at = data.find(b"'shape': (") + len(b"'shape': (")
        data[at:at + 1] = b"9"
        files[name] = bytes(data)
    return Path(name).name


def spoil_manifest(rng: Random, files: dict[str, object]) -> str:
    name = "run/manifest.json"
    data, kind = files[name], rng.randrange(5)
    if kind == 0:
        files[name] = data[:rng.randrange(len(data))]
    elif kind == 1:
        files[name] = rng.choice([b"", b"[]", b"null", b'{"components": 3}', b"[" * 100_000])
    elif kind == 2:
        files[name] = FOLDER
    elif kind == 3:
        files[name] = data.replace(b'"components"', b'"componets"')
    else:
        files[name] = data.replace(b"\n", b"\n\0", 1)
    return "manifest.json"


def decorate(rng: Random, files: dict[str, object]) -> str | None:
    """What changes nothing: lines in another order, other files, a file of another program gone."""
    lines = files["run/frames.jsonl"].splitlines(keepends=True)
    kind = rng.randrange(4)
    if kind == 0:
        rng.shuffle(lines)
        files["run/frames.jsonl"] = b"".join(lines)
    elif kind == 1:
        files["run/frames/notes.txt"] = b"x"
        files["run/frames/.hidden.npz"] = b"x"
    elif kind == 2:
        del files["run/trace.json"]
    else:
        files["run/metrics.json"] = b"{"
    return None
