# SPDX-License-Identifier: Apache-2.0
"""An ablation that is handed to Slurm, and what it must come to."""

from __future__ import annotations

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "hostile"))

from program import Answer, Program  # noqa: E402
from victims import BASE, PLAN, STAGES, Ablation  # noqa: E402

# Half a minute a cell, a minute a task: two cells each.
SUBMIT = ["--engine", "slurm", "--chunk-minutes", "1", "--cell-seconds", "30"]
CELLS, TASKS = 12, 6


class Planned:
    """The plan of twelve cells over two sequences in a folder, run here or by Slurm."""

    plan, engine = "plan.yaml", SUBMIT

    def __init__(self, program: Program, folder: Path, frame_ms: int = 0) -> None:
        self.program, self.folder = program, folder
        stages = STAGES.replace("ISOLATED", "")
        source = BASE.replace("FRAMES", f"2, sleep_ms: {frame_ms}")
        (folder / "pipeline.yaml").write_text(source + stages)
        (folder / "plan.yaml").write_text(PLAN)

    def ask(self, out: str, *arguments: str) -> Answer:
        return self.program.ask(self.folder, "ablate", self.plan, "--out", out, *arguments)

    def submit(self, out: str, *arguments: str) -> Answer:
        return self.ask(out, *self.engine, *arguments)

    def results(self, out: str) -> dict[str, str]:
        """All that is promised to be the same, tables of the report included; they name `out`."""
        found = Ablation(out, isolated=False).results(self.program, self.folder)
        found["plan.json"] = (self.folder / out / "plan.json").read_text()
        return {name: text.replace(out, "OUT") for name, text in found.items()}

    def finished(self, out: str) -> dict[str, object]:
        """Each finished cell: its line without times and machine, and its files."""
        kept: dict[str, object] = dict(Ablation(out, isolated=False).finished(self.folder))
        for name in [name for name in kept if name.startswith("line ")]:
            line = json.loads(kept[name])
            kept[name] = {key: line[key] for key in line if key not in ("timing", "machine", "check")}
        return kept

    def cells(self, out: str) -> int:
        """Finished ones."""
        return sum(name.startswith("line ") for name in self.finished(out))

    def lines(self, out: str) -> int:
        """Whole lines, those that count no more included."""
        files = (self.folder / out / "results").glob("*.jsonl")
        return sum(file.read_bytes().count(b"\n") for file in files)

    def tasks(self, out: str) -> list[list[str]]:
        """Keys of the cells of each task that was ever submitted."""
        orders = sorted((self.folder / out / "slurm").glob("*/order.json"))
        return [[key for group in chunk for key in group] for order in orders
                for chunk in json.loads(order.read_text())["tasks"]]


class PlannedByFile(Planned):
    """Any plan, of which a cell takes about a second."""

    engine = ["--engine", "slurm", "--chunk-minutes", "0.5", "--cell-seconds", "1"]

    def __init__(self, program: Program, folder: Path, plan: Path) -> None:
        self.program, self.folder, self.plan = program, folder, str(plan.resolve())


def differing(one: dict[str, str], other: dict[str, str]) -> list[str]:
    """Names of what is not the same, with how it begins to differ."""
    found = []
    for name in sorted(one.keys() | other.keys()):
        texts = one.get(name, ""), other.get(name, "")
        if texts[0] != texts[1]:
            at = next((i for i, pair in enumerate(zip(*texts)) if pair[0] != pair[1]), 0)
            found.append(f"{name}: {texts[0][at:at + 100]!r} != {texts[1][at:at + 100]!r}")
    return found


def other_build(library: Path) -> None:
    """Gives a library another build id, as if it had been built anew."""
    data = library.read_bytes()
    note = b"\x04\0\0\0\x14\0\0\0\x03\0\0\0GNU\0"
    at = data.index(note) + len(note)
    before = data[at:at + 20]
    after = bytes([before[0] ^ 1]) + before[1:]
    library.write_bytes(data[:at] + after + data[at + 20:])
    manifest = library.with_suffix(".plugin.yaml")
    text = manifest.read_text()
    assert before.hex() in text
    manifest.write_text(text.replace(before.hex(), after.hex()))
