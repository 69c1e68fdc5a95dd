#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Shows broken plugin libraries to every door of the program and prints what it answers.

    tests/zoo/table/zoo_table.py --weft build/release/bin/weft

prints a table in Markdown, one line for an animal and a door, and ends with 1 where an answer is
another one than it has to be. --only NAME,NAME shows some of the animals.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from itertools import repeat
from pathlib import Path

from cages import ID, LIBRARY, MANIFEST, Ask, Cage, Zoo, fault_of, line_of
from files import OF_FILES
from mistakes import OF_CALLS, OF_DECLARATIONS, OF_LOADING, OF_TABLES


def cell(text: str) -> str:
    return text.replace("|", "\\|").replace("`", "'")


def row(cage: Cage, ask: Ask) -> tuple[str, str, str]:
    """A line of the table, its verdict, and what is wrong with the answer."""
    answer = cage.try_door(ask)
    fault = fault_of(ask, answer)
    verdict = f"WRONG: {fault}" if fault else ask.verdict
    words = " ".join(part for part in (line_of(cage, ask, answer),
                                       f"({answer.frames})" if answer.frames else "") if part)
    name = cage.animal.name
    return (f"| {name} | {ask.door} | {answer.code} | {cell(words)} | {verdict} |",
            ask.verdict, f"{name}, {ask.door}: {fault}" if fault else "")


def describe_the_harmless(zoo: Zoo) -> None:
    """The animal without a mistake is a plugin like any other."""
    folder = zoo.work / "harmless"
    folder.mkdir()
    library = folder / LIBRARY
    library.write_bytes((zoo.animals / LIBRARY).read_bytes())
    answer = zoo.run(["plugins", "describe", str(library)])
    if answer.code != 0:
        sys.exit(f"the harmless animal is not described: {answer.text}")
    zoo.manifest = (folder / MANIFEST).read_text()


def ask_the_doctor(zoo: Zoo, cages: list[Cage]) -> str:
    """Once, with all files that are refused without being loaded; what is wrong with it."""
    words = ["--plugin-path", zoo.scripted]
    for cage in cages:
        words += ["--plugin-path", str(cage.folder)]
    answer = zoo.run([*words, "doctor", "--json"])
    try:
        report = json.loads(answer.text)
    except json.JSONDecodeError:
        return f"doctor: no JSON (exit code {answer.code}): {answer.text[-300:]}"
    zoo.doctor = report["plugins"]["refused"]
    good = [each for each in report["folders"] if each["path"] == os.path.realpath(zoo.scripted)]
    return "" if good and good[0]["usable"] > 0 and good[0]["refused"] == 0 else (
        "doctor: the good plugins beside the broken ones are not usable")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weft", required=True, help="the program")
    parser.add_argument("--build", help="the build folder, if it is not the one of the program")
    parser.add_argument("--only", default="", help="names of animals, separated by commas")
    parser.add_argument("--sanitized", action="store_true", help="whether the program is")
    options = parser.parse_args()
    weft = Path(options.weft).resolve()
    build = Path(options.build).resolve() if options.build else weft.parent.parent
    animals = OF_FILES + OF_TABLES + OF_LOADING + OF_DECLARATIONS + OF_CALLS
    names = Counter(animal.name for animal in animals)
    assert max(names.values()) == 1, names.most_common(3)
    if options.only:
        animals = [animal for animal in animals if animal.name in options.only.split(",")]
    if options.sanitized:
        animals = [animal for animal in animals if animal.sanitized]
    with tempfile.TemporaryDirectory(prefix="weft-zoo-") as work:
        zoo = Zoo(str(weft), build / "tests/zoo/animals", str(build / "tests/scripted"),
                  Path(work).resolve())
        describe_the_harmless(zoo)
        cages = [Cage(zoo, animal) for animal in animals]
        of_files = {animal.name for animal in OF_FILES}
        wrong = [ask_the_doctor(zoo, [cage for cage in cages if cage.animal.name in of_files])]
        # Those that wait for a library to come to an end begin, side by side: they only wait.
        patient = [cage for cage in cages if "hangs" in cage.animal.name]
        with (ThreadPoolExecutor() as waiting, ThreadPoolExecutor() as pool):
            rows = {cage.animal.name: waiting.map(row, repeat(cage), cage.animal.asks)
                    for cage in patient}
            rows |= {cage.animal.name: pool.submit(lambda cage=cage: [
                row(cage, ask) for ask in cage.animal.asks]) for cage in cages
                if cage not in patient}
            answers = [each for cage in cages for each in (
                rows[cage.animal.name] if cage in patient else rows[cage.animal.name].result())]
    print(f"| animal | door | exit | answer ({ID}) | verdict |\n|---|---|---|---|---|")
    for line, _, _ in answers:
        print(line)
    verdicts = Counter(verdict for _, verdict, _ in answers)
    print(f"\n{len(animals)} animals, {len(answers)} answers: "
          + ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common()))
    wrong = [fault for fault in wrong + [fault for _, _, fault in answers] if fault]
    for fault in wrong:
        print(f"WRONG: {fault}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
