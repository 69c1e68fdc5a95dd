#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Cuts the power of runs and ablations at random moments, and looks at what is left.

The journal (power_cut_journal.cpp) halts the program before one of its changes to the folder, and
power_cut_states.py makes a folder that a power cut at that moment may leave: what was not synced is
missing, or there in part. Judged is that no cell is lost whose line was on the disk, that the same
command completes the ablation or begins a new run, that its results are those of an undisturbed
one, and that `weft eval` reads what is left of a run.

Exits 1 if one of these failed, 2 on wrong usage.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "cluster"))

import fake_slurm  # noqa: E402
from fake_nodes import Nodes  # noqa: E402
from power_cut_states import Disk  # noqa: E402
from disturbing import wait_for  # noqa: E402
from planned import SUBMIT  # noqa: E402
from program import PATIENCE_S, Answer, Program  # noqa: E402
from victims import Ablation, Run, whole_lines  # noqa: E402


class SlurmAblation(Ablation):
    """The cells of the ablation in tasks of a Slurm that runs on this machine."""

    def __init__(self, out: str) -> None:
        super().__init__(out, isolated=False)
        self.name = "slurm ablation"
        self.command = ["ablate", "plan.yaml", "--out", out, "--quiet", "--isolate", "none", *SUBMIT]


VICTIMS = {"run": lambda: Run("out", isolated=False),
           "ablation": lambda: Ablation("out", isolated=False),
           "slurm ablation": lambda: SlurmAblation("out")}


def end_all(mark: str) -> None:
    """Ends the processes that have this word in their environment, and no others."""
    def found() -> list[int]:
        with_mark = []
        for process in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if mark.encode() in (process / "environ").read_bytes():
                    with_mark.append(int(process.name))
        return with_mark

    for process in found():
        with contextlib.suppress(OSError):
            os.kill(process, signal.SIGKILL)


class Scene:
    """A victim in a folder, with the programs that stand for Slurm."""

    def __init__(self, program: Program, name: str, folder: Path) -> None:
        self.program, self.victim, self.folder = program, VICTIMS[name](), folder
        self.is_cluster = name.startswith("slurm")
        self.tree = folder / "tree"
        self.tree.mkdir(parents=True)
        (folder / "bin").mkdir()
        for command in ("sbatch", "squeue", "sinfo", "scancel"):
            (folder / "bin" / command).symlink_to(Path(fake_slurm.__file__).resolve())
        self.victim.prepare(self.tree)

    def environment(self, queue: str) -> dict[str, str]:
        (self.folder / queue).mkdir(exist_ok=True)
        return dict(os.environ) | {"PATH": f"{self.folder / 'bin'}:{os.environ['PATH']}",
                                   "FAKE_SLURM": str(self.folder / queue)}

    def run(self, tree: Path, environment: dict[str, str], queue: str) -> int | None:
        """The exit code of the program; None where it did not end."""
        with open(self.folder / "said.txt", "ab") as said:
            child = subprocess.Popen(self.program.command(*self.victim.command), cwd=tree,
                                     env=environment, stdin=subprocess.DEVNULL, stdout=said,
                                     stderr=said, start_new_session=True)
            try:
                child.wait(PATIENCE_S)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
                return None
        if self.is_cluster and child.returncode == 0:
            Nodes(self.folder / queue, environment).run()
        return child.returncode

    def complete(self, tree: Path, queue: str) -> int | None:
        """Again until nothing is left: tasks of Slurm are told of by the next call."""
        environment = self.environment(queue)
        code = self.run(tree, environment, queue)
        return self.run(tree, environment, queue) if self.is_cluster and code == 0 else code

    def said(self) -> str:
        return (self.folder / "said.txt").read_text(errors="replace")


class Judge:
    """Knows what undisturbed victims come to, and how many moments they have."""

    def __init__(self, program: Program, library: Path, scratch: Path) -> None:
        self.program, self.library = program, library
        self.results, self.codes, self.moments = {}, {}, {}
        for name in VICTIMS:
            scene = Scene(program, name, scratch / name.replace(" ", "_"))
            disk = Disk(scene.folder / "notes", scene.tree)
            environment = scene.environment("queue") | disk.environment(library)
            scene.run(scene.tree, environment, "queue")
            self.moments[name] = disk.moments
            self.codes[name] = scene.complete(scene.tree, "queue") if scene.is_cluster else 0
            self.results[name] = scene.victim.results(program, scene.tree)
            if not self.results[name] or self.moments[name] < 10:
                raise SystemExit(f"{name}: nothing to cut: {scene.said()[-2000:]}")

    def cut(self, name: str, moment: int, rng: Random, folder: Path) -> list[str]:
        """What is wrong after a power cut at that moment."""
        scene = Scene(self.program, name, folder)
        disk = Disk(folder / "notes", scene.tree)
        disk.set_cut(moment)
        environment = scene.environment("queue") | disk.environment(self.library)
        with ThreadPoolExecutor(1) as pool:
            running = pool.submit(scene.run, scene.tree, environment, "queue")
            wait_for(lambda: disk.is_cut or running.done())
            end_all(f"POWER_CUT={disk.notes}")
            while not running.done():  # tasks that started meanwhile halt too
                end_all(f"POWER_CUT={disk.notes}")
                wait_for(running.done, 0.05)
        finished = self.certain(scene, disk)
        was_done = not disk.is_cut
        left = folder / "left"
        disk.leave(left, rng)
        return self.after(name, scene, left, finished, was_done)

    @staticmethod
    def certain(scene: Scene, disk: Disk) -> dict[str, bytes]:
        """The lines of cells that were on the disk, by key."""
        kept: dict[str, bytes] = {}
        for file in (scene.tree / scene.victim.out / "results").glob("*.jsonl"):
            synced = disk.synced_bytes(os.stat(file).st_ino) or b""
            for line in synced.split(b"\n")[:-1]:
                kept.setdefault(json.loads(line)["key"], line)
        return kept

    def after(self, name: str, scene: Scene, left: Path, finished: dict[str, bytes],
              was_done: bool) -> list[str]:
        faults = []
        victim = scene.victim
        if isinstance(victim, Run):
            faults += self.read_run(victim, left, was_done)
            scene.victim = victim.again()
        code = scene.complete(left, "queue_after")
        if code != self.codes[name]:
            return [*faults, f"going on: exit {code}: {scene.said()[-600:]}"]
        found, right = scene.victim.results(self.program, left), self.results[name]
        wrong = sorted(key for key in found.keys() | right.keys() if found.get(key) != right.get(key))
        if wrong:
            faults.append(f"not as undisturbed: {', '.join(wrong[:4])} ({len(wrong)})")
        now = {line for file in (left / victim.out / "results").glob("*.jsonl")
               for line in whole_lines(file)}
        lost = sorted(key for key, line in finished.items() if line not in now)
        again = sorted(key for key in finished
                       if sum(json.loads(line).get("key") == key for line in now) > 1)
        if lost:
            faults.append(f"lost: {', '.join(lost[:4])} ({len(lost)} of {len(finished)})")
        if again and not scene.is_cluster:  # there a cell may be run twice
            faults.append(f"run again: {', '.join(again[:4])} ({len(again)} of {len(finished)})")
        return faults

    def read_run(self, victim: Run, left: Path, was_done: bool) -> list[str]:
        answer: Answer = self.program.ask(left, "eval", victim.out, "--no-save", "--json", "-")
        if was_done:
            found, right = victim.results(self.program, left), self.results["run"]
            wrong = sorted(key for key in right if found.get(key) != right[key]
                           and key != "lines.txt")  # file of the scripted sink, which does not sync
            return [f"a run that had ended lacks: {', '.join(wrong[:4])}"] if wrong else []
        if answer.dirt():
            return [f"eval: {answer.dirt()}"]
        began = (left / victim.out / "template.npz").exists()
        if began and answer.code != 0 and "no frames" not in answer.err:
            return [f"eval: exit {answer.code}: {answer.err[:300]}"]
        return []


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER",
                        help="folder of the scripted components")
    parser.add_argument("--journal", type=Path, required=True, metavar="FILE",
                        help="the library power_cut_journal")
    parser.add_argument("--seed", type=int, default=18, help="of all draws (default: %(default)s)")
    parser.add_argument("--count", type=int, default=12, help="power cuts")
    parser.add_argument("--only", type=int, metavar="I", help="this one alone")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave folders there")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    scratch = Path(tempfile.mkdtemp(prefix="weft-power-cuts-"))
    judge = Judge(Program(arguments.weft, arguments.plugin_path), arguments.journal.resolve(), scratch)
    print(f"seed {arguments.seed}, {arguments.count} power cuts; moments: {judge.moments}")

    def one(index: int) -> tuple[str, int, list[str]]:
        rng = Random(f"{arguments.seed}/{index}")
        name = list(VICTIMS)[index % len(VICTIMS)]
        # The last ones fall behind the end: all of it must be there.
        moment = rng.randrange(1, judge.moments[name] * 9 // 8)
        folder = ((arguments.keep or scratch) / f"cut_{index}").resolve()
        try:
            return name, moment, judge.cut(name, moment, rng, folder)
        except (OSError, ValueError, KeyError) as failure:
            return name, moment, [f"unreadable: {failure!r}"]

    which = range(arguments.count) if arguments.only is None else [arguments.only]
    with ThreadPoolExecutor(arguments.jobs) as pool:
        outcomes = list(zip(which, pool.map(one, which)))
    shutil.rmtree(scratch, ignore_errors=True)
    options = " ".join(f"--plugin-path {folder}" for folder in arguments.plugin_path)
    rows: Counter = Counter()
    for index, (name, moment, faults) in outcomes:
        rows[name, "done"] += 1
        rows[name, "survived"] += not faults
        if faults:
            print(f"{sys.argv[0]} --weft {arguments.weft} {options} --journal {arguments.journal} "
                  f"--seed {arguments.seed} --only {index} --keep DIR  # {name}, moment {moment}")
            print("\n".join("    " + fault[:700] for fault in faults))
    for name in VICTIMS:
        print(f"{name:<20}{rows[name, 'done']:>6} cuts{rows[name, 'survived']:>6} survived")
    return 0 if all(not faults for _, (_, _, faults) in outcomes) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
