#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs commands of the program over faulty plugin libraries and compares what it answers.

    tests/misbehaving/faults/answers.py --weft build/release/bin/weft

prints a table in Markdown, one line for a case and a command, and exits with 1 where an answer is
not the expected one. --only NAME,NAME runs some of the cases.
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

from trials import ID, Ask, Sandbox, Libraries, fault_of, line_of
from files import OF_FILES
from mistakes import OF_CALLS, OF_DECLARATIONS, OF_LOADING, OF_TABLES


def cell(text: str) -> str:
    return text.replace("|", "\\|").replace("`", "'")


def row(sandbox: Sandbox, ask: Ask) -> tuple[str, str, str]:
    """A line of the table, its verdict, and what is wrong with the answer."""
    answer = sandbox.try_command(ask)
    fault = fault_of(ask, answer)
    verdict = f"WRONG: {fault}" if fault else ask.verdict
    words = " ".join(part for part in (line_of(sandbox, ask, answer),
                                       f"({answer.frames})" if answer.frames else "") if part)
    name = sandbox.case.name
    return (f"| {name} | {ask.command} | {answer.code} | {cell(words)} | {verdict} |",
            ask.verdict, f"{name}, {ask.command}: {fault}" if fault else "")


def ask_the_doctor(libraries: Libraries, sandboxes: list[Sandbox]) -> str:
    """Once, with all files that are refused without being loaded; what is wrong with it."""
    words = ["--plugin-path", libraries.scripted]
    for sandbox in sandboxes:
        words += ["--plugin-path", str(sandbox.folder)]
    answer = libraries.run([*words, "doctor", "--json"])
    try:
        report = json.loads(answer.text)
    except json.JSONDecodeError:
        return f"doctor: no JSON (exit code {answer.code}): {answer.text[-300:]}"
    libraries.doctor = report["plugins"]["refused"]
    good = [each for each in report["folders"] if each["path"] == os.path.realpath(libraries.scripted)]
    return "" if good and good[0]["usable"] > 0 and good[0]["refused"] == 0 else (
        "doctor: the good plugins beside the broken ones are not usable")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weft", required=True, help="the program")
    parser.add_argument("--build", help="the build folder, if it is not the one of the program")
    parser.add_argument("--only", default="", help="names of cases, separated by commas")
    parser.add_argument("--sanitized", action="store_true", help="whether the program is")
    options = parser.parse_args()
    weft = Path(options.weft).resolve()
    build = Path(options.build).resolve() if options.build else weft.parent.parent
    cases = OF_FILES + OF_TABLES + OF_LOADING + OF_DECLARATIONS + OF_CALLS
    names = Counter(case.name for case in cases)
    assert max(names.values()) == 1, names.most_common(3)
    if options.only:
        cases = [case for case in cases if case.name in options.only.split(",")]
    if options.sanitized:
        cases = [case for case in cases if case.sanitized]
    with tempfile.TemporaryDirectory(prefix="weft-libraries-") as work:
        libraries = Libraries(str(weft), build / "tests/misbehaving/faulty", str(build / "tests/scripted"),
                  Path(work).resolve())
        sandboxes = [Sandbox(libraries, case) for case in cases]
        of_files = {case.name for case in OF_FILES}
        wrong = [ask_the_doctor(libraries, [each for each in sandboxes if each.case.name in of_files])]
        # Those that wait for a library that never ends run side by side, as they only wait.
        patient = [each for each in sandboxes if "hangs" in each.case.name]
        with (ThreadPoolExecutor() as waiting, ThreadPoolExecutor() as pool):
            rows = {each.case.name: waiting.map(row, repeat(each), each.case.asks)
                    for each in patient}
            rows |= {each.case.name: pool.submit(
                lambda each=each: [row(each, ask) for ask in each.case.asks])
                for each in sandboxes if each not in patient}
            answers = [answer for each in sandboxes for answer in (
                rows[each.case.name] if each in patient else rows[each.case.name].result())]
    print(f"| case | command | exit | answer ({ID}) | verdict |\n|---|---|---|---|---|")
    for line, _, _ in answers:
        print(line)
    verdicts = Counter(verdict for _, verdict, _ in answers)
    print(f"\n{len(cases)} cases, {len(answers)} answers: "
          + ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common()))
    wrong = [fault for fault in wrong + [fault for _, _, fault in answers] if fault]
    for fault in wrong:
        print(f"WRONG: {fault}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
