# SPDX-License-Identifier: Apache-2.0
"""What is disturbed, an ablation and runs: what of it counts as finished, and its results."""

from __future__ import annotations

import json
import re
import zipfile
from pathlib import Path

from program import Program

STAGES = """\
template: {use: templates/test.scripted}
stages:
  - {use: detectors/test.scripted}
  - {use: matchers/test.scripted}
  - {use: filters/test.scripted, params: {gate: gate}ISOLATED}
  - {use: warps/test.scripted}
  - {use: passes/test.scripted}
  - {use: solvers/test.scripted}
"""
BASE = "weft: 1\nsource: {use: sources/test.scripted, params: {frames: FRAMES, truth: true}}\n"
PLAN = """\
weft: 1
name: plan
pipeline: pipeline.yaml
data_use: tuning
axes:
  every: {set: filters.every, values: [2, 3, 4]}
  distance: {set: solvers.distance_m, values: [0.2, 0.3]}
data: {plain: {seeds: 2-3, seed_setting: source.frames}}
comparisons: [{axis: every, metric: all.error_solved.mean_mm}]
"""


def stages(isolated: bool) -> str:
    return STAGES.replace("ISOLATED", ", isolate: process" if isolated else "")


def whole_lines(file: Path) -> list[bytes]:
    """The lines that end; a last one without its line break does not count."""
    data = file.read_bytes() if file.exists() else b""
    return data.split(b"\n")[:-1]


class Ablation:
    """Twelve cells over two sequences, run by two processes; with `isolated`, their filters have
    processes of their own."""

    calls = 10
    stopped_codes, interrupted_codes = (3,), (1,)

    def __init__(self, out: str, isolated: bool) -> None:
        self.out, self.isolated = out, isolated
        self.name = "isolated ablation" if isolated else "ablation"
        self.command = ["ablate", "plan.yaml", "--out", out, "--jobs", "2", "--quiet",
                        "--isolate", "none"]

    def prepare(self, folder: Path) -> None:
        text = BASE.replace("FRAMES", "2") + stages(self.isolated)
        (folder / "pipeline.yaml").write_text(text)
        (folder / "plan.yaml").write_text(PLAN)

    def again(self) -> Ablation:
        """What goes on where this one ended."""
        return self

    def finished(self, folder: Path) -> dict[str, bytes]:
        """Each finished cell: its line, and its files."""
        kept: dict[str, bytes] = {}
        for file in sorted((folder / self.out / "results").glob("*.jsonl")):
            for line in whole_lines(file):
                key = json.loads(line)["key"]
                kept.setdefault("line " + key, line)
                for other in sorted((folder / self.out / "cells" / key).iterdir()):
                    kept[f"{key}/{other.name}"] = other.read_bytes()
        return kept

    def results(self, program: Program, folder: Path) -> dict[str, str]:
        """Lines without times and machine, files of the cells, tables of the report."""
        kept = self.finished(folder)
        found = {}
        for name, data in kept.items():
            if name.startswith("line "):
                line = json.loads(data)
                del line["timing"], line["machine"]
                line.pop("check", None)  # covers the whole line, times and machine too
                found[name] = json.dumps(line, sort_keys=True)
            else:
                found[name] = data.hex()
        outcome = program.ask(folder, "report", self.out)
        found["report"] = f"exit {outcome.code}"
        for table in sorted((folder / self.out / "report").glob("*")):
            if table.suffix in (".csv", ".md"):
                found[table.name] = table.read_text()
        return found

    def read_back(self, program: Program, folder: Path) -> str:
        """What is wrong with the folder as it was left; "" where it can be read."""
        if not (folder / self.out / "manifest.json").exists():
            return ""
        outcome = program.ask(folder, *self.command, "--status")
        return "" if outcome.code in (0, 1) and not outcome.dirt() else f"--status: {outcome.text[:300]}"


class Run:
    """A run of six frames; with `isolated`, its filter is in a process of its own."""

    calls, frames = 6, 6
    stopped_codes, interrupted_codes = (3,), (0,)

    def __init__(self, out: str, isolated: bool, attempt: str = "") -> None:
        self.base, self.isolated, self.out = out, isolated, out + attempt
        self.name = "isolated run" if isolated else "run"
        self.command = ["run", "pipeline.yaml", "--out", self.out, "--quiet", "--isolate", "none"]

    def prepare(self, folder: Path) -> None:
        text = BASE.replace("FRAMES", str(self.frames)) + stages(self.isolated)
        (folder / "pipeline.yaml").write_text(
            text + "sinks:\n  - {use: sinks/test.scripted, params: {path: lines.txt}}\n")

    def again(self) -> Run:
        return Run(self.base, self.isolated, "-again")

    def finished(self, folder: Path) -> dict[str, bytes]:
        """Each frame that has its line, and its file."""
        kept: dict[str, bytes] = {}
        for line in whole_lines(folder / self.out / "frames.jsonl"):
            name = f"{json.loads(line)['frame']:06}.npz"
            kept["line " + name[:6]] = line
            kept[name] = (folder / self.out / "frames" / name).read_bytes()
        return kept

    def results(self, program: Program, folder: Path) -> dict[str, str]:
        """Lines without times, files of the frames, what the sink wrote."""
        found = {name: data.hex() for name, data in self.finished(folder).items()
                 if not name.startswith("line ")}
        for name, data in self.finished(folder).items():
            if name.startswith("line "):
                found[name] = re.sub(r'"(?:processor_)?ms":(\{[^}]*\}|[\d.e-]+)', "", data.decode())
        lines = folder / self.out / "lines.txt"
        found["lines.txt"] = lines.read_text() if lines.exists() else "absent"
        return found

    def read_back(self, program: Program, folder: Path) -> str:
        kept = [name for name in self.finished(folder) if name.endswith(".npz")]
        for name in kept:
            broken = zipfile.ZipFile(folder / self.out / "frames" / name).testzip()
            if broken is not None:
                return f"{name}: {broken} is damaged"
        if not kept:
            return ""
        outcome = program.ask(folder, "eval", self.out, "--no-save", "--json", "-")
        if outcome.code != 0 or outcome.dirt():
            return f"eval: exit {outcome.code}: {outcome.err[:300]}"
        frames = json.loads(outcome.out)["counts"]["frames"]
        return "" if frames == len(kept) else f"eval counts {frames} frames, {len(kept)} are there"
