#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Kills, interrupts, stops and starves runs and ablations half-way, and looks at what is left.

Judged is after each: that a cell or frame was running when it happened; that what was finished is
still there, byte for byte, and can be read; that no result that was cut short ends with exit code
0; that the same command completes it; and that the tables are those of an undisturbed one.

Exits 1 if one of these failed, 2 on wrong usage.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from random import Random

import disturbing
from disturbing import Gate
from program import Answer, Program
from small_disk import SmallDisk, can_mount
from victims import Ablation, Run

# [bytes] 25 sizes. The program's output goes into a file too, which must contain its message.
SIZES = [600, 700, 800, 900, 1000, 2000, 3000, *range(4096, 19 * 4096, 4096)]
SIGNALS = {"child killed": disturbing.kill_child, "parent killed": disturbing.kill_parent,
           "group killed": disturbing.kill_group, "interrupted": disturbing.interrupt,
           "interrupted twice": disturbing.interrupt_twice,
           "stopped, continued": disturbing.stop_and_continue}
GAVE_UP = 130  # exit code of a process that a second interrupt ended
UNHARMED = ("child killed", "stopped, continued")  # after these the program goes on by itself


@dataclass(frozen=True)
class Case:
    """One disturbance; `size` where room runs out."""

    victim: str
    kind: str
    size: int = 0


def cases() -> list[Case]:
    """300 of them: 25 sizes of two kinds, and 200 signals."""
    found = [Case(victim, kind, size) for size in SIZES for victim in ("ablation", "run")
             for kind in ("full disk", "file limit")]
    for victim, each in (("ablation", 20), ("run", 8), ("isolated run", 4),
                         ("isolated ablation", 3)):
        kinds = [kind for kind in SIGNALS if victim != "run" or kind != "child killed"]
        found += [Case(victim, kind) for kind in kinds for _ in range(each)]
    return (found + [Case("isolated run", kind) for kind in SIGNALS for _ in range(9)])[:300]


def victim_of(case: Case) -> Ablation | Run:
    out = "disk/out"  # a separate disk for those that are to find it full
    isolated = case.victim.startswith("isolated")
    if case.victim.endswith("ablation"):
        return Ablation(out, isolated)
    return Run(out, isolated)


class Judge:
    """Knows what undisturbed victims result in, and compares."""

    def __init__(self, program: Program, scratch: Path) -> None:
        self.program, self.results, self.codes = program, {}, {}
        for name in ("ablation", "run", "isolated run", "isolated ablation"):
            folder = scratch / name
            (folder / "disk").mkdir(parents=True)
            victim = victim_of(Case(name, ""))
            victim.prepare(folder)
            self.codes[name] = program.ask(folder, *victim.command).code
            self.results[name] = victim.results(program, folder)

    def differs(self, case: Case, victim: Ablation | Run, folder: Path) -> str:
        found, right = victim.results(self.program, folder), self.results[case.victim]
        wrong = sorted(name for name in found.keys() | right.keys()
                       if found.get(name) != right.get(name))
        return f"not as undisturbed: {', '.join(wrong[:4])} ({len(wrong)})" if wrong else ""

    def ending(self, case: Case, victim: Ablation | Run, answer: Answer, folder: Path) -> str:
        """What is wrong with how the disturbed program ended."""
        if case.kind in ("parent killed", "group killed"):
            return "" if answer.code == -signal.SIGKILL else f"exit {answer.code} though killed"
        if case.kind == "interrupted twice" and case.victim == "run":
            gave_up = answer.code != 0 and "filters" in answer.err
            return "" if gave_up else f"exit {answer.code}, stage not named: {answer.err[:200]}"
        if answer.dirt():
            return answer.dirt()
        if case.kind.startswith("interrupted"):
            gave_up = (GAVE_UP,) if case.kind == "interrupted twice" else ()
            allowed = (*victim.interrupted_codes, *gave_up)
            return "" if answer.code in allowed else f"exit {answer.code} after an interrupt"
        if case.victim.startswith("isolated") and case.kind == "child killed":
            return "" if answer.code == 1 else f"exit {answer.code} where one frame failed"
        if answer.code == self.codes[case.victim]:
            return self.differs(case, victim, folder)  # the exit code states that nothing was cut
        starved = case.kind not in UNHARMED
        reported = answer.code in victim.stopped_codes and answer.err.strip()
        return "" if starved and reported else f"exit {answer.code}: {answer.text[:200]}"

    def after(self, case: Case, victim: Ablation | Run, kept: dict, folder: Path) -> list[str]:
        """What is wrong with what was left, and with going on from there."""
        now = victim.finished(folder)
        lost = sorted(name for name in kept if now.get(name) != kept[name])
        faults = [f"lost: {', '.join(lost)}"] if lost else []
        faults += [victim.read_back(self.program, folder)]
        return [fault for fault in faults if fault]

    def go_on(self, case: Case, victim: Ablation | Run, folder: Path) -> list[str]:
        following = victim.again()
        answer = self.program.ask(folder, *following.command)
        if answer.code != self.codes[case.victim]:
            return [f"going on: exit {answer.code}: {answer.text[:300]}"]
        different = self.differs(case, following, folder)
        return [f"going on: {different}"] if different else []


def disturb(judge: Judge, case: Case, rng: Random, folder: Path) -> tuple[bool, list[str]]:
    """Whether the disturbance landed in something that ran, and what was wrong."""
    on_disk = case.kind == "full disk"
    victim, gate = victim_of(case), Gate(folder)
    victim.prepare(folder)
    gate.close(deaf=case.kind == "interrupted twice")
    with SmallDisk(folder / "disk") if on_disk else nullcontext() as disk:
        state = disturbing.start(judge.program, victim, folder, gate, rng.randrange(victim.calls))
        if state is None:
            return False, ["no call was held at the gate"]
        faults = []
        try:
            if on_disk:
                disk.fill(case.size)
            elif case.kind == "file limit":
                disturbing.small_files(state, case.size)
            else:
                SIGNALS[case.kind](state, rng)
        except AssertionError as failure:
            faults.append(str(failure))
        gate.open()
        answer = disturbing.end(state, judge.program.command(*victim.command))
        ending = judge.ending(case, victim, answer, folder)
        faults += [ending] if ending else []
        if on_disk:
            disk.empty()
        faults += judge.after(case, victim, state.finished, folder)
        return True, faults + judge.go_on(case, victim, folder)


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER",
                        help="folder of the scripted components")
    parser.add_argument("--seed", type=int, default=18, help="of all draws (default: %(default)s)")
    parser.add_argument("--count", type=int, default=12, help="disturbances, up to 300")
    parser.add_argument("--only", type=int, metavar="I", help="this one alone")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave folders there")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="at a time")
    return parser.parse_args(words)


def chosen(seed: int, count: int) -> list[tuple[int, Case]]:
    """So many of all cases, evenly from all kinds."""
    every = list(enumerate(cases()))
    Random(f"order {seed}").shuffle(every)
    turn: Counter = Counter()
    ranked = []
    for index, case in every:
        turn[case.victim, case.kind] += 1
        ranked.append((turn[case.victim, case.kind], index, case))
    ranked.sort(key=lambda entry: entry[0])
    return [(index, case) for _, index, case in ranked[:count]]


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    scratch = Path(tempfile.mkdtemp(prefix="weft-disturbed-"))
    judge = Judge(Program(arguments.weft, arguments.plugin_path), scratch)
    which = chosen(arguments.seed, arguments.count)
    if arguments.only is not None:
        which = [(arguments.only, cases()[arguments.only])]
    if not can_mount(scratch):
        print("this user may not mount a file system: no full disks, file limits only")
        which = [entry for entry in which if entry[1].kind != "full disk"]
    print(f"seed {arguments.seed}, {len(which)} disturbances")

    def one(entry: tuple[int, Case]) -> tuple[bool, list[str]]:
        folder = (arguments.keep or scratch) / str(entry[0])
        (folder / "disk").mkdir(parents=True)
        try:
            return disturb(judge, entry[1], Random(f"{arguments.seed}/{entry[0]}"), folder)
        except (OSError, ValueError, KeyError) as failure:
            return True, [f"unreadable: {failure!r}"]

    with ThreadPoolExecutor(arguments.jobs) as pool:
        outcomes = list(pool.map(one, which))
    shutil.rmtree(scratch, ignore_errors=True)
    return report(arguments, which, outcomes)


def report(arguments: argparse.Namespace, which: list, outcomes: list) -> int:
    """Prints failures as commands and the counts by kind; 1 if anything failed."""
    options = " ".join(f"--plugin-path {folder}" for folder in arguments.plugin_path)
    rows: dict[tuple[str, str], list[int]] = {}
    for (index, case), (landed, faults) in zip(which, outcomes):
        row = rows.setdefault((case.victim, case.kind), [0, 0, 0])
        for column, add in enumerate((1, landed, not faults)):
            row[column] += add
        if faults:
            print(f"{sys.argv[0]} --weft {arguments.weft} {options} --seed {arguments.seed} "
                  f"--only {index} --keep DIR  # {case.victim}, {case.kind}, {case.size} bytes")
            print("\n".join("    " + fault[:400] for fault in faults))
    print(f"{'victim':<20}{'disturbance':<20}{'done':>6}{'landed':>8}{'survived':>10}")
    for (victim, kind), (done, landed, survived) in sorted(rows.items()):
        print(f"{victim:<20}{kind:<20}{done:>6}{landed:>8}{survived:>10}")
    done, landed, survived = (sum(row[i] for row in rows.values()) for i in range(3))
    print(f"{'all':<40}{done:>6}{landed:>8}{survived:>10}")
    return 0 if done == landed == survived else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
