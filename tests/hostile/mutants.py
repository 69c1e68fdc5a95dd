#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Asks the program about mutants whose mistakes are known, and prints how often it was right.

Judged is whether each mutant is refused or shown harmless, whether each planted mistake is reported
at its place and with its suggestion, whether all of them are reported in one pass and nothing else,
and that nothing crashes, hangs or prints what is not for users. The time is printed, never judged.

Exits 1 if a rate misses its goal, 2 on wrong usage.
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

from file_mutants import bytes_mutant, path_mutant
from judging import Mutant, Rates, Verdict, judge
from camera_format_mutants import camera_format_mutant
from camera_mutants import camera_mutant
from found_mesh_mutants import found_mesh_mutant
from image_mutants import image_mutant
from mesh_mutants import mesh_mutant
from part_mutants import PartFiles
from program import Program
from run_mutants import RunFolders
from scale_mutants import scale_mutant
from yaml_mutants import pipeline_mutant, plan_mutant

Maker = Callable[[Random], Mutant]


def makers_of(program: Program) -> list[Maker]:
    """All makers, each as often as its share of the mutants."""
    runs, parts = RunFolders(program), PartFiles(program)
    shares = [(36, pipeline_mutant), (22, plan_mutant), (12, camera_mutant),
              (4, camera_format_mutant), (8, mesh_mutant), (6, found_mesh_mutant),
              (4, scale_mutant), (8, runs.mutant), (4, runs.bytes_mutant), (6, bytes_mutant),
              (4, path_mutant), (4, image_mutant), (8, parts.mutant)]
    return [maker for share, maker in shares for _ in range(share)]


# These kinds can be requested alone, as often as needed; those of a class need the program.
BY_KIND: dict[str, Maker | Callable[[Program], object]] = {
    "pipeline": pipeline_mutant, "plan": plan_mutant, "camera": camera_mutant,
    "camera format": camera_format_mutant, "mesh": mesh_mutant, "found mesh": found_mesh_mutant,
    "scale": scale_mutant, "bytes": bytes_mutant, "path": path_mutant, "image": image_mutant,
    "run": RunFolders, "part file": PartFiles}


def makers_by_kind(kinds: list[str], program: Program) -> list[Maker]:
    made = [BY_KIND[kind] for kind in kinds]
    return [each(program).mutant if isinstance(each, type) else each for each in made]


def mutant_of(makers: list[Maker], seed: int, index: int) -> Mutant:
    """The same mutant whatever else is asked: all draws come from the seed and the index."""
    rng = Random(f"{seed}/{index}")
    return rng.choice(makers)(rng)


def ask(program: Program, makers: list[Maker], seed: int, index: int,
        keep: Path | None) -> Verdict:
    folder = keep / str(index) if keep else Path(tempfile.mkdtemp(prefix="weft-mutant-"))
    folder.mkdir(parents=True, exist_ok=True)
    try:
        verdict, answer = judge(mutant_of(makers, seed, index), program, folder)
        if keep:
            (folder / "answer.txt").write_text(
                f"$ {' '.join(answer.command)}\n{answer.text}exit {answer.code}\n")
        return verdict
    finally:
        if not keep:
            shutil.rmtree(folder, ignore_errors=True)


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER")
    parser.add_argument("--seed", type=int, default=18, help="of all draws (default: %(default)s)")
    parser.add_argument("--count", type=int, default=100,
                        help="mutants, with --kinds of each kind (default: %(default)s)")
    parser.add_argument("--kinds", type=lambda text: text.split(","), default=[], metavar="KIND,...",
                        help=f"these alone: {', '.join(BY_KIND)}")
    parser.add_argument("--only", type=int, metavar="I", help="this mutant alone")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="leave files and answers there")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="asked at a time")
    arguments = parser.parse_args(words)
    if unknown := set(arguments.kinds) - set(BY_KIND):
        parser.error(f"no kind is {', '.join(sorted(unknown))}; there are {', '.join(BY_KIND)}")
    return arguments


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    program = Program(arguments.weft, arguments.plugin_path)
    kinds = arguments.kinds
    makers = makers_by_kind(kinds, program) if kinds else makers_of(program)
    count = arguments.count * max(1, len(kinds))
    which = range(count) if arguments.only is None else [arguments.only]
    print(f"seed {arguments.seed}, {len(which)} mutants")
    with ThreadPoolExecutor(arguments.jobs) as pool:
        verdicts = list(pool.map(
            lambda index: ask(program, [makers[index % len(makers)]] if kinds else makers,
                              arguments.seed, index, arguments.keep), which))
    options = " ".join(f"--plugin-path {folder}" for folder in arguments.plugin_path)
    options += f" --kinds {','.join(kinds)}" if kinds else ""
    for index, verdict in zip(which, verdicts):
        if verdict.faults:
            print(f"{sys.argv[0]} --weft {arguments.weft} {options} --seed {arguments.seed} "
                  f"--only {index} --keep DIR  # {verdict.kind}")
            print("\n".join("    " + fault[:300] for fault in verdict.faults))
    rates = Rates(verdicts)
    print(rates.table())
    sorts = [sort for verdict in verdicts for sort in verdict.sorts]
    print(f"{len(sorts)} mistakes of {len(set(sorts))} sorts")
    return 0 if rates.met() else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
