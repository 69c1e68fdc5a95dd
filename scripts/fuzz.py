#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds the fuzzers of tests/hostile/fuzz with Clang, runs them, and prints what each one found.

Each runs for the given time from the seeds of tests/hostile/fuzz/seeds.py and what earlier runs kept in
build/fuzz/corpus. A finding is an input that crashes, leaks, breaks what must hold of the answer,
takes longer than 10 s or more memory than 2 GiB; it is kept in build/fuzz/findings/TARGET, and the
command that repeats it is printed. Exits 1 if there is one, 2 on wrong usage.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BUILD = ROOT / "build" / "fuzz"
LIMITS = ["-timeout=10", "-rss_limit_mb=2048", "-malloc_limit_mb=1024"]
MOST_FINDINGS = 10  # findings after which a target is given up
SANITIZERS = {
    "ASAN_OPTIONS": "detect_leaks=1:allocator_may_return_null=1:strict_string_checks=1",
    "UBSAN_OPTIONS": "halt_on_error=1:print_stacktrace=1",
}


@dataclass
class Outcome:
    target: str
    runs: int = 0
    edges: int = 0  # branches that inputs of the corpus reach
    features: int = 0  # these and how often
    seconds: float = 0.0
    slowest_s: int = 0
    peak_MiB: int = 0
    findings: list[Path] = field(default_factory=list)

    def row(self, corpus: Path) -> tuple[str, ...]:
        return (self.target, str(self.runs), str(self.edges), str(self.features),
                f"{self.seconds:.0f}", str(self.slowest_s), str(self.peak_MiB),
                str(len(list(corpus.iterdir()))), str(len(self.findings)))


HEADER = ("target", "runs", "branches", "features", "seconds", "slowest s", "memory MiB", "corpus",
          "findings")


def last_number(pattern: str, text: str) -> int:
    found = re.findall(pattern, text)
    return int(found[-1]) if found else 0


def run_once(target: str, seconds: int, seed: int, log: Path, findings: Path) -> Outcome:
    """One run of libFuzzer, which ends at its first finding."""
    corpus = BUILD / "corpus" / target
    before = set(findings.iterdir())
    command = [str(BUILD / "bin" / f"fuzz_{target}"), f"-max_total_time={seconds}", f"-seed={seed}",
               *LIMITS, f"-artifact_prefix={findings}/", "-print_final_stats=1", "-max_len=4096",
               f"-dict={ROOT}/tests/hostile/fuzz/dictionaries/{target}.dict", str(corpus),
               str(BUILD / "seeds" / target)]
    start = time.monotonic()
    with log.open("ab") as out:
        code = subprocess.run(command, stdout=out, stderr=out, env=os.environ | SANITIZERS,
                              check=False).returncode
    text = log.read_text(errors="replace")
    new = [file for file in sorted(set(findings.iterdir()) - before)
           if not file.name.startswith("slow-unit")]  # reported, and no finding below the limit
    if code != 0 and not new and not any(findings.iterdir()):
        raise SystemExit(f"fuzz.py: fuzz_{target} ended with {code} and no finding; see {log}")
    return Outcome(target, last_number(r"stat::number_of_executed_units: *(\d+)", text),
                   last_number(r" cov: (\d+)", text), last_number(r" ft: (\d+)", text),
                   time.monotonic() - start, last_number(r"stat::slowest_unit_time_sec: *(\d+)", text),
                   last_number(r"stat::peak_rss_mb: *(\d+)", text), new)


def run_target(target: str, seconds: int, seed: int) -> Outcome:
    """Runs on with another seed behind each finding, until the time is over."""
    log, findings = BUILD / f"{target}.log", BUILD / "findings" / target
    log.unlink(missing_ok=True)
    for folder in (findings, BUILD / "corpus" / target):
        folder.mkdir(parents=True, exist_ok=True)
    total = Outcome(target)
    while total.seconds < seconds and len(total.findings) < MOST_FINDINGS:
        left = max(1, round(seconds - total.seconds))
        one = run_once(target, left, seed + len(total.findings), log, findings)
        total.runs += one.runs
        total.seconds += max(one.seconds, 0.1)
        total.edges, total.features = max(total.edges, one.edges), max(total.features, one.features)
        total.slowest_s = max(total.slowest_s, one.slowest_s)
        total.peak_MiB = max(total.peak_MiB, one.peak_MiB)
        total.findings += one.findings
        if not one.findings:  # none, or one again that nothing gets past
            break
    return total


def table(rows: list[tuple[str, ...]]) -> str:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join("  ".join(cell.ljust(width) if i == 0 else cell.rjust(width)
                               for i, (cell, width) in enumerate(zip(row, widths))) for row in rows)


def arguments_of(words: list[str], known: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=f"of {', '.join(known)} (all)")
    parser.add_argument("--seconds", type=int, default=600, help="of each (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of libFuzzer (default: %(default)s)")
    parser.add_argument("--jobs", type=int, default=2, help="run at a time (default: %(default)s)")
    arguments = parser.parse_args(words)
    unknown = sorted(set(arguments.targets) - set(known))
    if unknown:
        parser.error(f"no fuzzer is called {', '.join(unknown)}; there are {', '.join(known)}")
    return arguments


def main(words: list[str]) -> int:
    known = sorted(file.name.removesuffix("_fuzzer.cpp")
                   for file in (ROOT / "tests" / "hostile" / "fuzz").glob("*_fuzzer.cpp"))
    arguments = arguments_of(words, known)
    for command in (["cmake", "--preset", "fuzz"],
                    ["cmake", "--build", "--preset", "fuzz", "-j", str(arguments.jobs)],
                    ["tests/hostile/fuzz/seeds.py", str(BUILD / "seeds")]):
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    targets = arguments.targets or known
    print(f"seed {arguments.seed}, {arguments.seconds} s each, {arguments.jobs} at a time", flush=True)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        outcomes = list(pool.map(
            lambda target: run_target(target, arguments.seconds, arguments.seed), targets))
    print(table([HEADER, *(one.row(BUILD / "corpus" / one.target) for one in outcomes)]))
    for outcome in outcomes:
        for finding in outcome.findings:
            print(f"{BUILD}/bin/fuzz_{outcome.target} {finding}")
    findings = sum(len(outcome.findings) for outcome in outcomes)
    runs = sum(outcome.runs for outcome in outcomes)
    print(f"summary: {'FAILED' if findings else 'ok'}: {len(outcomes)} readers, {runs} inputs, "
          f"{findings} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
