#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`weft ablate --engine slurm` against Slurm itself, on this machine, while tasks, daemons and nodes
are killed.

Usage: loopback_test.py --weft PROGRAM --plugin-path FOLDER [--kills N] [--seed N] [--plan PLAN]

PLAN, with the components that are installed, is run here and by Slurm, which loses a node meanwhile.

Skipped (exit code 77) unless $WEFT_SLURM is set, as scripts/test.sh --with-slurm does.
"""

from __future__ import annotations

import argparse
import os
import re
import signal
import sys
import tempfile
import time
from pathlib import Path
from random import Random, SystemRandom

from loopback import NODES, Loopback, missing, wait_for
from planned import CELLS, TASKS, Planned, PlannedByFile, Program, differing

SKIPPED = 77


class Failed(Exception):
    pass


def check(holds: bool, what: str) -> None:
    if not holds:
        raise Failed(what)


class Trial:
    def __init__(self, slurm: Loopback, planned: Planned) -> None:
        self.slurm, self.planned = slurm, planned
        outcome = planned.ask("out00", "--quiet", "--jobs", "2")
        check(outcome.code == 0, outcome.text)
        self.expected, self.cells = planned.results("out00"), planned.cells("out00")
        self.all_done = re.search(r"\d+ done, 0 failed, 0 left", planned.ask("out00", "--status").out)[0]
        self.done: dict[str, int] = {}

    def submit(self, out: str, *arguments: str) -> str:
        outcome = self.planned.submit(out, *arguments)
        check(outcome.code == 0, outcome.text)
        return outcome.out

    def check_whole(self, out: str) -> None:
        said = self.submit(out)
        check(self.all_done in said, said)
        different = differing(self.planned.results(out), self.expected)
        check(not different, f"{out} differs from the local engine: {different}")
        print(f"{out}: {self.planned.lines(out)} lines of {self.cells} cells", flush=True)

    def wait(self) -> None:
        check(self.slurm.wait_until_empty(self.planned.program.patience_s),
              "tasks do not end: " + self.slurm.state())

    def finish(self, out: str) -> None:
        for _ in range(5):
            self.wait()
            if self.planned.cells(out) == self.cells:
                return
            self.submit(out)
        raise Failed(self.planned.submit(out, "--status").text)

    def undisturbed(self) -> None:
        """Tables are those of the local engine, and a summary is written."""
        said = self.submit("out01", "--partition", "main")
        check(f"{CELLS} cells in {TASKS} tasks" in said, said)
        outcome = self.planned.submit("out01", "--status")
        check("cells are on their way" in outcome.out, outcome.text)
        self.wait()
        summary = self.planned.folder / "out01/slurm/000001/summary.txt"
        check(f"{CELLS} done" in summary.read_text(), summary.read_text())
        self.check_whole("out01")

    def node_lost(self) -> None:
        """Its tasks go on where they were when it is back, or elsewhere."""
        self.submit("out02")
        check(wait_for(lambda: self.planned.cells("out02") > 0, self.planned.program.patience_s),
              "no cell ends: " + self.slurm.state())
        print(f"a node is lost after {self.planned.cells('out02')} cells", flush=True)
        self.slurm.lose_node("n2")
        time.sleep(1.0)
        self.slurm.bring_back("n2")
        self.finish("out02")
        self.check_whole("out02")

    def cancelled(self) -> None:
        """What is finished stays, and the rest can be submitted again."""
        self.submit("out03")
        time.sleep(2.0)
        outcome = self.planned.submit("out03", "--cancel")
        check("tasks ended" in outcome.out, outcome.text)
        before = self.planned.finished("out03")
        self.wait()
        now = self.planned.finished("out03")
        check(before == {name: now.get(name) for name in before}, "a finished cell is gone")
        self.submit("out03")
        self.finish("out03")
        self.check_whole("out03")

    def refused(self) -> None:
        outcome = self.planned.submit("out04", "--partition", "mani")
        check(outcome.code == 2 and "did you mean 'main'?" in outcome.err, outcome.text)

    def disturb(self, random: Random) -> bool:
        """One thing at random; False where there was nothing to be killed."""
        kind = random.choice(["task", "task", "process", "supervisor", "slurmd", "slurmctld", "node",
                              "requeued", "cancelled"])
        node = random.choice(NODES)
        running = self.slurm.processes(node, supervisors=kind == "supervisor")
        tasks = self.slurm.tasks()
        if kind == "slurmd":
            self.slurm.kill_daemon("slurmd." + node)
            self.slurm.start_node(node)
        elif kind == "slurmctld":
            self.slurm.kill_daemon("slurmctld")
            self.slurm.start_controller()
        elif kind in ("requeued", "cancelled"):
            if not tasks:
                return False
            words = ("scontrol", "requeue") if kind == "requeued" else ("scancel",)
            self.slurm.call(*words, random.choice(tasks), check=False)
        elif not running:
            return False
        elif kind == "node":
            self.slurm.lose_node(node)
            self.slurm.bring_back(node)
        else:
            self.slurm.kill(running[0] if kind == "task" else random.choice(running))
        self.done[kind] = self.done.get(kind, 0) + 1
        return True

    def killed_at_random(self, kills: int, random: Random) -> None:
        """No finished cell is lost, and none counts twice, whatever is killed when."""
        rounds = 0
        while sum(self.done.values()) < kills:
            rounds += 1
            out = f"out{10 + rounds}"
            known: dict[str, object] = {}
            while True:
                self.submit(out)
                for _ in range(3):
                    time.sleep(random.random() * 1.5)
                    if sum(self.done.values()) < kills:
                        self.disturb(random)
                self.wait()
                now = self.planned.finished(out)
                check(known == {name: now.get(name) for name in known}, "a finished cell is gone")
                known = now
                if self.planned.cells(out) == self.cells:
                    break
            self.check_whole(out)
        print(f"{rounds} ablations, {self.done}, {self.slurm.held} tasks were held")


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--weft", required=True)
    parser.add_argument("--plugin-path", required=True)
    parser.add_argument("--kills", type=int, default=5)
    parser.add_argument("--seed", type=int, default=SystemRandom().randrange(10**6))
    parser.add_argument("--plan", type=Path)
    options = parser.parse_args()
    if not os.environ.get("WEFT_SLURM"):
        print("skipped: scripts/test.sh --with-slurm runs it")
        return SKIPPED
    if missing():
        print(f"not installed: {', '.join(missing())}; see scripts/bootstrap.sh --with-slurm")
        return 1
    print(f"seed {options.seed}", flush=True)
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that daemons are stopped
    with tempfile.TemporaryDirectory(prefix="weft_slurm_") as scratch:
        folder = Path(scratch)
        folder.chmod(0o755)
        slurm = Loopback(folder / "slurm")
        try:
            work = folder / "work"
            work.mkdir()
            program = Program(options.weft, [options.plugin_path])
            trial = Trial(slurm, Planned(program, work, frame_ms=150))
            for step in (trial.undisturbed, trial.node_lost, trial.cancelled, trial.refused):
                print(step.__name__, flush=True)
                step()
            trial.killed_at_random(options.kills, Random(options.seed))
            if options.plan:
                print(options.plan, flush=True)
                (folder / "plan").mkdir()
                program = Program(options.weft, [], patience_s=3600.0)
                Trial(slurm, PlannedByFile(program, folder / "plan", options.plan)).node_lost()
        except Failed as failure:
            print(f"FAILED: {failure}")
            for log in sorted((folder / "slurm/log").glob("*.log")):
                print(log.name, *log.read_text(errors="replace").splitlines()[-20:], sep="\n  ")
            return 1
        finally:
            slurm.stop()
    return 0


if __name__ == "__main__":
    sys.exit(main())
