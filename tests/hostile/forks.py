#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a component that starts processes, which hold its files, and ends or goes on, in every place
where the program loads it: runs, ablations, descriptions and checks of plugins.

Judged is after each that the program ended, that it named what the component did, and that no
process of the component lives on.

Exits 1 if one of these failed, 2 on wrong usage.
"""

from __future__ import annotations

import argparse
import itertools
import os
import sys
import tempfile
import time
from pathlib import Path
from random import Random

from program import Answer, Program
from victims import BASE, PLAN, STAGES

# The expected report of each action.
ACTIONS = {"leave": "signal 6", "leave_session": "signal 6", "fork_twice": "",
         "multiply": "started more than 256 processes"}
PLACES = ("process", "create", "prepare")
COMMANDS = ("run", "ablate", "check")


def living(name: str) -> list[int]:
    """Processes of this name that have not ended."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            state = (folder / "stat").read_text().rpartition(") ")[2][0]
            if (folder / "comm").read_text().strip() == name and state != "Z":
                found.append(int(folder.name))
        except (OSError, IndexError):
            pass  # it has ended meanwhile
    return found


def ask(program: Program, folder: Path, command: str, params: str) -> Answer:
    component = f"{{use: filters/test_deadly, isolate: process, params: {{{params}}}}}"
    stages = "".join(f"  - {component}\n" if "filters/" in line else line + "\n"
                     for line in STAGES.splitlines())
    (folder / "pipeline.yaml").write_text(BASE.replace("FRAMES", "3") + stages)
    plan = PLAN.replace("set: filters.every, values: [2, 3, 4]", "set: template.columns, values: [6]")
    (folder / "plan.yaml").write_text(plan)
    words = {"run": ["run", "pipeline.yaml", "--out", "out"],
             "ablate": ["ablate", "plan.yaml", "--out", "out", "--isolate", "none"],
             "check": ["plugins", "check", "filters/test_deadly", "--params", f"{{{params}}}",
                       "--brief"]}[command]
    return program.ask(folder, *words)


def faults_of(program: Program, folder: Path, command: str, action: str, place: str,
              name: str) -> list[str]:
    answer = ask(program, folder, command, f"deed: {action}, where: {place}, child: {name}")
    faults = ["hangs"] if answer.hung else []
    if answer.code < 0:
        faults.append(f"killed by signal {-answer.code}")
    if ACTIONS[action] not in answer.text and not any(
            ACTIONS[action] in file.read_text(errors="replace")
            for file in folder.glob("out/**/*.jsonl")):
        faults.append(f"does not say {ACTIONS[action]!r}: {answer.text[-300:]}")
    end = time.monotonic() + 10.0  # a copy of the program that ends by itself
    while living(name) and time.monotonic() < end:
        time.sleep(0.05)
    if living(name):
        faults.append(f"{len(living(name))} processes live on")
    return faults


def main(words: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER",
                        help="of the scripted components and of filters/test_deadly")
    parser.add_argument("--seed", type=int, default=18, help="of all draws (default: %(default)s)")
    parser.add_argument("--count", type=int, default=12, help="forks, up to 36")
    arguments = parser.parse_args(words)
    program = Program(arguments.weft, arguments.plugin_path)
    every = list(itertools.product(COMMANDS, ACTIONS, PLACES))
    Random(arguments.seed).shuffle(every)
    print(f"seed {arguments.seed}, {min(arguments.count, len(every))} forks")
    failed = 0
    with tempfile.TemporaryDirectory(prefix="weft-forks-") as scratch:
        for index, (command, action, place) in enumerate(every[:arguments.count]):
            folder = Path(scratch) / str(index)
            folder.mkdir()
            name = f"f{os.getpid()}_{index}"
            for fault in faults_of(program, folder, command, action, place, name):
                print(f"{command}, {action} in {place}: {fault}")
                failed += 1
    print(f"{failed} faults")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
