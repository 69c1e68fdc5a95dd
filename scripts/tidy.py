#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over the batches in which a build compiles framework/, cli/ and plugins/.

usage: scripts/tidy.py [--changed [--since REV]] [--all] [--jobs N] [BUILD]

BUILD is a build folder of Ninja that has been built, build/release where it is not given. Tests are
left out: GoogleTest's macros are what would be reported.

A batch is left out while nothing of it has changed since it passed: its files and all headers that
they include, how it is compiled, .clang-tidy, and clang-tidy. What passed is kept in
build/tidy.green; --all runs everything.

With --changed only the batches that hold or include a file that differs from REV, in the working
tree. Without --since, REV is where the branch left `main` (of the remote upstream or origin, or of
this clone), or else the commit before. Where neither is known, as in a shallow clone, nothing runs.

The last line, `summary: RESULT: DETAIL`, is for test.sh. Exits 1 where clang-tidy reports
something, 2 where it cannot run.
"""

import argparse
import concurrent.futures
import json
import os
import re
import shlex
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple, Optional

from green import Green, combined, content, from_root, output_of, recorded_reads, sources_of

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("framework", "cli", "plugins")
CODE = {".h", ".hpp", ".c", ".cpp"}
BATCH = re.compile(r"(?!.*_test(_headers)?\.dir/)(framework|cli|plugins)/")
# Clang 14 does not know all of GCC's warnings and parameters, and misses captures that only
# instances of a generic lambda use.
ARGUMENTS = (
    "--quiet",
    "--checks=-bugprone-suspicious-include",
    "--extra-arg=-Wno-unknown-warning-option",
    "--extra-arg=-Wno-unused-lambda-capture",
    "--extra-arg=-Wno-unused-command-line-argument",
)


class Batch(NamedTuple):
    """What one compiler reads; paths from the root where they lie below it."""

    name: str  # of the compiled file, from the build folder
    command: str
    sources: frozenset[str]
    read: frozenset[str]  # all that the compiler read: the sources and every header

    def fingerprint(self, tool: str) -> str:
        """One hash of all on which the verdict depends."""
        files = (f"{content(str(ROOT / name))} {name}" for name in self.sources | self.read)
        return combined([self.command, tool, *files])


def record_of(batch: Batch, build: Path) -> str:
    """Under what a verdict is kept: the commands of two builds differ, and so do their verdicts."""
    return f"{build.name}/{batch.name}"


def is_ours(path: str) -> bool:
    """True for sources of the rooms, tests not counted."""
    parts = Path(path).parts
    return parts[0] in ROOMS and "tests" not in parts and Path(path).suffix in CODE


def asked_reads(command: list[str], build: Path) -> frozenset[str]:
    """The same from the compiler, for what is no part of the build or not up to date in it."""
    output = command.index("-o")
    asked = subprocess.run([*command[:output], *command[output + 2:], "-M"], cwd=build, check=True,
                           capture_output=True, text=True).stdout
    files = re.split(r"(?<!\\)\s+", asked.replace("\\\n", " ").split(": ", 1)[1].strip())
    return frozenset(from_root(file.replace("\\ ", " "), build) for file in files)


def batches_of(build: Path) -> list[Batch]:
    """The batches that hold sources of ours, the largest first: they take longest."""
    reads = recorded_reads(build)
    batches = []
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        name = os.path.relpath(entry["file"], build)
        sources = sources_of(Path(entry["file"]))
        if BATCH.match(name) and any(is_ours(source) for source in sources):
            words = shlex.split(entry["command"])
            read = reads.get(words[words.index("-o") + 1]) or asked_reads(words, build)
            batches.append(Batch(name, entry["command"], sources, read))
    return sorted(batches, key=lambda batch: (-len(batch.sources), batch.name))


def git(*arguments: str) -> Optional[str]:
    """What git answers, None where it cannot."""
    try:
        return output_of("git", "-C", str(ROOT), *arguments).strip()
    except (subprocess.CalledProcessError, FileNotFoundError):
        return None


def base() -> Optional[str]:
    """The commit with which the working tree is compared when nobody names one."""
    head = git("rev-parse", "HEAD")
    for branch in ("upstream/main", "origin/main", "main"):
        common = git("merge-base", "HEAD", branch)
        if common and common != head:
            return common
    return git("rev-parse", "--verify", "--quiet", "HEAD~1")


def changed_since(commit: str) -> set[str]:
    """Sources of ours that differ from the commit, those of which it knows nothing included."""
    listed = (
        output_of("git", "-C", str(ROOT), "diff", "--name-only", "--no-renames", "-z", commit),
        output_of("git", "-C", str(ROOT), "ls-files", "--others", "--exclude-standard", "-z"))
    return {name for names in listed for name in names.split("\0") if name and is_ours(name)}


def tidy(batch: Batch, build: Path) -> tuple[bool, str]:
    """Whether clang-tidy is content, and a text with its time and its complaints."""
    start = time.monotonic()
    ran = subprocess.run(["clang-tidy", *ARGUMENTS, "-p", str(build), str(build / batch.name)],
                         check=False, capture_output=True, text=True)
    verdict = "ok" if ran.returncode == 0 else "FAILED"
    said = ran.stdout if "error:" in ran.stdout or not ran.returncode else ran.stdout + ran.stderr
    text = f"{batch.name}: {verdict}, {time.monotonic() - start:.0f} s"
    return ran.returncode == 0, "\n".join([text, said.rstrip()]).rstrip()


def tidy_all(due: dict[Batch, str], build: Path, jobs: int, green: Green) -> int:
    """Runs clang-tidy on the batches, records those that pass, and counts those that do not."""
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(tidy, batch, build): batch for batch in due}
        for number, done in enumerate(concurrent.futures.as_completed(running), 1):
            batch = running[done]
            passed, text = done.result()
            print(f"[{number}/{len(due)}] {text}", flush=True)
            if passed:
                green.record(record_of(batch, build), due[batch])
            else:
                failed += 1
    return failed


def fingerprints(batches: list[Batch]) -> dict[Batch, str]:
    config = (ROOT / ".clang-tidy").read_text(encoding="utf-8")
    tool = " ".join([output_of("clang-tidy", "--version"), *ARGUMENTS, config])
    return {batch: batch.fingerprint(tool) for batch in batches}


def report(result: str, detail: str) -> int:
    print(f"summary: {result}: {detail}")
    return 1 if result == "FAILED" else 0


def run(options: argparse.Namespace) -> int:
    batches = batches_of(options.build)
    chosen, of = batches, f"of {len(batches)} batches"
    if options.changed:
        commit = options.since or base()
        if commit is None:
            return report("NOT RUN", "no earlier commit is known; name one with --since REV")
        changed = changed_since(commit)
        chosen = [batch for batch in batches if (batch.sources | batch.read) & changed]
        of += f", sources changed since {git('rev-parse', '--short', commit)}: {len(changed)}"
    if not chosen:
        return report("skipped", f"0 {of}")

    green = Green(ROOT / "build" / "tidy.green")
    found = fingerprints(chosen)
    since = {batch: green.since(record_of(batch, options.build), found[batch]) for batch in chosen}
    due = {batch: found[batch] for batch in chosen if options.all or not since[batch]}
    sources = f"sources {combined(found.values())[:12]}"
    if not due:
        last = max(when for when in since.values() if when)
        return report("skipped", f"unchanged since its green run of {last}, {sources}")
    failed = tidy_all(due, options.build, options.jobs, green)
    if failed:
        return report("FAILED", f"{failed} of {len(due)} batches")
    passed = len(chosen) - len(due)
    left_out = f", {passed} unchanged since they passed" if passed else ""
    return report("ok", f"{len(due)} {of}{left_out}, {sources}")


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("build", type=Path, nargs="?", default=ROOT / "build" / "release")
    parser.add_argument("--changed", action="store_true")
    parser.add_argument("--since")
    parser.add_argument("--all", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args(arguments)
    options.build = options.build.resolve()
    try:
        return run(options)
    except subprocess.CalledProcessError as error:
        print(f"tidy.py: {shlex.join(error.cmd)} failed: {error.stderr}", file=sys.stderr)
    except OSError as error:
        print(f"tidy.py: {error}; is the preset built, and clang-tidy installed?", file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
