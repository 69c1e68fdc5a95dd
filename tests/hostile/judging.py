# SPDX-License-Identifier: Apache-2.0
"""What a mutant is, what the program's answer to it is worth, and the rates of many."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from program import Answer, Mistake, Program

FOLDER = object()  # in Mutant.files: a folder; a function is called with the path to make it


@dataclass
class Expected:
    """A mistake that must be reported: where, and with which suggestion ("" none, None any)."""

    what: str
    file: str
    line: int
    column: int | None = None
    suggestion: str | None = None

    def fits(self, mistake: Mistake) -> bool:
        return self.line == mistake.at[0] and self.column in (None, mistake.at[1]) and (
            mistake.file == self.file or mistake.file.endswith("/" + self.file))


@dataclass
class Mutant:
    """Files, the command that is to read them, and the truth about them.

    Without `expected` the mutant is harmless if `same` says so (it tells what differs, or ""),
    and with `refusable` it may be refused as well, naming the file.
    """

    kind: str
    files: dict[str, object]
    command: list[str]
    expected: list[Expected] = field(default_factory=list)
    same: Callable[[Program, Path, Answer], str] | None = None
    refusable: str | None = None
    codes: tuple[int, ...] = (0,)  # exit codes of a harmless mutant
    one_pass: bool = True  # the program promises to report all errors at once

    def write(self, folder: Path) -> None:
        for name, content in self.files.items():
            file = folder / name
            file.parent.mkdir(parents=True, exist_ok=True)
            if content is FOLDER:
                file.mkdir()
            elif callable(content):
                content(file)
            else:
                file.write_bytes(content)


@dataclass
class Verdict:
    """Counts of one mutant; `faults` says what was wrong, and `crash` that it broke the program."""

    kind: str
    ms: float = 0.0
    processor_ms: float = 0.0
    answered: bool = True  # refused, or shown harmless
    planted: int = 0
    exact: int = 0
    misplaced: int = 0
    suggestions: int = 0
    right_suggestions: int = 0
    complete: bool = True
    sorts: list[str] = field(default_factory=list)  # kinds of the planted errors
    faults: list[str] = field(default_factory=list)


def mistakes_in(answer: Answer, files: set[str]) -> list[Mistake]:
    """The reported mistakes; one inside another's message, or without a column, counts as well."""
    found = answer.mistakes()
    for file in files:
        pattern = r"(?:^|[ /])" + re.escape(file) + r":(\d+)(?::(\d+))?: (.*)"
        for line in answer.err.splitlines():
            inner = list(re.finditer(pattern, line))
            if inner and not any(m.message in line and m.file.endswith(file) for m in found):
                at = (int(inner[-1][1]), int(inner[-1][2] or 0))
                found.append(Mistake(file, at, inner[-1][3]))
    return found


def judge_planted(mutant: Mutant, answer: Answer, verdict: Verdict) -> None:
    if answer.code not in (2, 3):
        verdict.answered = False
        verdict.faults.append(f"exit {answer.code} where it must be refused")
    files = {expected.file for expected in mutant.expected}
    reported = [m for m in mistakes_in(answer, files) if Path(m.file).name in files]
    verdict.planted = len(mutant.expected)
    verdict.sorts = [expected.what for expected in mutant.expected]
    left = list(reported)
    for expected in mutant.expected:
        fitting = next((m for m in left if expected.fits(m)), None)
        if fitting is None:
            column = "" if expected.column is None else f":{expected.column}"
            verdict.faults.append(
                f"{expected.what} not reported at {expected.file}:{expected.line}{column}")
            continue
        left.remove(fitting)
        verdict.exact += 1
        if expected.suggestion is not None:
            verdict.suggestions += 1
            right = (fitting.suggestion or "") == expected.suggestion
            verdict.right_suggestions += right
            if not right:
                wanted = f"'{expected.suggestion}' is not suggested"
                verdict.faults.append(f"{wanted}: {fitting.message}")
    for extra in left if mutant.one_pass else []:
        verdict.faults.append(f"not planted: {extra.at[0]}:{extra.at[1]}: {extra.message}")
    verdict.misplaced = min(len(left), verdict.planted - verdict.exact)
    verdict.complete = verdict.exact == verdict.planted and not (left and mutant.one_pass)


def judge_harmless(mutant: Mutant, program: Program, folder: Path, answer: Answer,
                   verdict: Verdict) -> None:
    if mutant.refusable is not None and answer.code in (2, 3):
        if mutant.refusable not in answer.err:
            verdict.faults.append(f"refused without naming {mutant.refusable}: {answer.err[:200]}")
            verdict.answered = False
        return
    if answer.code not in mutant.codes:
        verdict.faults.append(f"exit {answer.code} where nothing is wrong: {answer.err[:200]}")
    elif mutant.same is not None:
        different = mutant.same(program, folder, answer)
        verdict.faults += [different] if different else []
    verdict.answered = not verdict.faults


def judge(mutant: Mutant, program: Program, folder: Path) -> tuple[Verdict, Answer]:
    """Writes the mutant into the folder, asks the program, and compares."""
    mutant.write(folder)
    answer = program.ask(folder, *mutant.command)
    verdict = Verdict(mutant.kind, answer.ms, answer.processor_ms)
    if mutant.expected:
        judge_planted(mutant, answer, verdict)
    else:
        judge_harmless(mutant, program, folder, answer, verdict)
    if dirt := answer.dirt():
        verdict.answered = False
        verdict.faults.append(dirt)
    return verdict, answer


def percentile(values: list[float], percent: float) -> float:
    """The smallest value that so many percent do not exceed."""
    ordered = sorted(values)
    return ordered[min(len(ordered) - 1, int(len(ordered) * percent / 100.0))]


class Rates:
    """Rates of verdicts, which have goals; the times are told beside theirs."""

    HEADER = ("kind", "mutants", "mistakes", "refused or harmless", "exact place", "suggestion",
              "one pass", "P50 ms", "P95 ms", "P99 ms", "P50 cpu", "P95 cpu", "P99 cpu")
    PERCENTS = (50, 95, 99)

    def __init__(self, verdicts: list[Verdict]) -> None:
        self.verdicts = verdicts

    @staticmethod
    def percent(right: int, of: int) -> float:
        return 100.0 * right / of if of else 100.0

    def figures(self, kind: str | None) -> tuple[list[Verdict], list[float]]:
        mine = [v for v in self.verdicts if kind in (None, v.kind)]
        wrong = [v for v in mine if v.planted]
        placed = sum(v.exact + v.misplaced for v in wrong)
        return mine, [self.percent(sum(v.answered for v in mine), len(mine)),
                      self.percent(sum(v.exact for v in wrong), placed),
                      self.percent(sum(v.right_suggestions for v in mine),
                                   sum(v.suggestions for v in mine)),
                      self.percent(sum(v.complete for v in wrong), len(wrong))]

    def table(self) -> str:
        rows = [self.HEADER]
        for kind in [*sorted({v.kind for v in self.verdicts}), None]:
            mine, figures = self.figures(kind)
            times = [percentile(values, percent) for values in
                     ([v.ms for v in mine], [v.processor_ms for v in mine])
                     for percent in self.PERCENTS]
            rows.append((kind or "all", str(len(mine)), str(sum(v.planted for v in mine)),
                         *(f"{f:.1f} %" for f in figures), *(f"{time:.0f}" for time in times)))
        rows.append(("goal", "", "", "100 %", "100 %", "100 %", "98 %", "", "", "50", "", "", "50"))
        widths = [max(len(row[i]) for row in rows) for i in range(len(self.HEADER))]
        return "\n".join("  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                                   for i, (cell, width) in enumerate(zip(row, widths)))
                         for row in rows)

    def met(self) -> bool:
        goals = (100.0, 100.0, 100.0, 98.0)
        return all(figure >= goal for figure, goal in zip(self.figures(None)[1], goals))
