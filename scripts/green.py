#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Remembers on which content a step of test.sh passed, so that it need not run on the same again.

usage: scripts/green.py sources STEP       prints the hash of all that the step is made from
       scripts/green.py since STEP HASH    prints when it passed on that; exits 1 where it has not
       scripts/green.py record STEP HASH   it has passed on that just now
       scripts/green.py each STEP BUILD    prints `HASH TEST` for each test in a build folder
       scripts/green.py tests STEP FILE SUITE LOG
                                           so have those tests of a suite that CTest says passed in
                                           its output LOG, each on its hash in FILE, as `each` prints
       scripts/green.py passed STEP FILE SUITE
                                           prints the tests of a suite that have, a line each

The hash covers the files behind the step that git tracks or would track, the versions of the
compiler and of the installed -dev packages, and where recorded data are. That of a single test
leaves out what only programs of other tests are compiled from, other tests that are scripts, and
these scripts themselves; a test to which the whole tree is given reads all of it. It is kept in
build/STEP.green: a fresh build folder knows of nothing that passed.
"""

import datetime
import functools
import hashlib
import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Iterable, Mapping, Optional

ROOT = Path(__file__).resolve().parent.parent
CODE = ("CMakeLists.txt", "CMakePresets.json", "cli", "docs/examples", "framework", "pipelines",
        "plugins", "scripts", "tests", "web")
# What the builds and tests of a step read, from the root. Races hide in no page of text.
STEPS = {"tests": (".",), "tsan": CODE}
WITHOUT_PAGES = ("tsan",)
# They choose what is run, and change no result.
HARNESS = {"scripts/green.py", "scripts/test.sh", "scripts/tidy.py"}
TOOLS = (
    (os.environ.get("CXX", "c++"), "--version"),
    ("cmake", "--version"),
    ("dpkg-query", "-W", "*-dev"),
)


@functools.lru_cache(maxsize=None)
def content(file: str) -> str:
    """The hash of a file, read once; of one that is not there, a word."""
    try:
        return hashlib.sha256(Path(file).read_bytes()).hexdigest()
    except OSError:
        return "missing"


def combined(lines: Iterable[str]) -> str:
    """One hash of lines, whatever their order."""
    return hashlib.sha256("\n".join(sorted(lines)).encode()).hexdigest()


def output_of(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def from_root(path: str, folder: Path) -> str:
    """A path of a file in `folder` as one from the root, where it lies below it."""
    full = os.path.normpath(folder / path)
    return os.path.relpath(full, ROOT) if full.startswith(f"{ROOT}/") else full


def sources_of(file: Path) -> frozenset[str]:
    """The files that CMake put together in a batch, or the file itself."""
    included = [str(file)]
    if re.fullmatch(r"unity_\d+_cxx\.cxx", file.name):
        included = re.findall(r'^#include "(.*)"$', file.read_text(encoding="utf-8"), re.MULTILINE)
    return frozenset(from_root(each, file.parent) for each in included)


def files_behind(step: str) -> set[str]:
    listed = output_of("git", "-C", str(ROOT), "ls-files", "-coz", "--exclude-standard", "--",
                       *STEPS[step])
    return {name for name in listed.split("\0")
            if name and not (step in WITHOUT_PAGES and name.endswith(".md"))}


def hash_of(files: Iterable[str]) -> str:
    return combined([*(f"{content(str(ROOT / name))} {name}" for name in files),
                     *(output_of(*tool) for tool in TOOLS),
                     "data " + os.environ.get("WEFT_DATA", "")])


def sources(step: str) -> str:
    return hash_of(files_behind(step))


def recorded_reads(build: Path) -> dict[str, frozenset[str]]:
    """For each object that is up to date in Ninja's record, the files that its compiler read."""
    reads: dict[str, set[str]] = {}
    files: set[str] = set()
    for line in output_of("ninja", "-C", str(build), "-t", "deps").splitlines():
        if line.startswith("    "):
            files.add(from_root(line.strip(), build))
        elif ": #deps " in line:
            files = set()
            if line.endswith("(VALID)"):
                reads[line.split(": #deps ")[0]] = files
    return {name: frozenset(files) for name, files in reads.items()}


def readers(build: Path, tests: set[str]) -> dict[str, set[str]]:
    """For each file the targets that are compiled from it: of tests all, of others those that are
    built."""
    reads = recorded_reads(build)
    targets: dict[str, set[str]] = {}
    for entry in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        made = re.search(r" -o (\S*CMakeFiles/([^/]+)\.dir/\S+)", entry["command"])
        if not made:
            continue
        read = reads.get(made[1]) or (sources_of(Path(entry["file"])) if made[2] in tests else ())
        for file in read:
            targets.setdefault(file, set()).add(made[2])
    return targets


def hashes_of_tests(step: str, build: Path) -> dict[str, str]:
    """For each test of a build folder one hash: of all files behind the step that it can read."""
    shown = json.loads(output_of("ctest", "--test-dir", str(build), "--show-only=json-v1"))
    named: dict[str, set[str]] = {}
    for test in shown["tests"]:
        folders = [each["value"] for each in test.get("properties", [])
                   if each["name"] == "WORKING_DIRECTORY"]
        named[test["name"]] = {from_root(word, build) for word in [*folders, *test.get("command", [])]}
    tests = set(named)
    compiled = readers(build, tests)
    behind = files_behind(step)
    # What is installed and what pages show is compiled by scripts, too.
    of_tests = {file for file in behind if compiled.get(file) and compiled[file] <= tests
                and not file.startswith(("framework/", "docs/"))}
    scripts = {file for file in behind if file.endswith(("_test.py", "_test.sh"))}
    common = hash_of(behind - of_tests - scripts - HARNESS)

    def files_of(test: str) -> set[str]:
        if str(ROOT) in named[test]:
            return behind
        own = {file for file in of_tests if test in compiled[file]} | (named[test] & scripts)
        if any(Path(file).parts[:2] == ("tests", "architecture") for file in own):
            own |= HARNESS & behind
        return own

    return {test: combined([common, *(f"{content(str(ROOT / file))} {file}" for file in files_of(test))])
            for test in tests}


class Green:
    """A file of lines `HASH DATE TIME NAME`: what passed last, on which content, and when."""

    def __init__(self, file: Path) -> None:
        self.file = file
        self.passed: dict[str, tuple[str, str]] = {}
        if file.is_file():
            for line in file.read_text(encoding="utf-8").splitlines():
                digest, day, time, name = line.split(" ", 3)
                self.passed[name] = (digest, f"{day} {time}")

    def since(self, name: str, digest: str) -> Optional[str]:
        """When it passed on this content; None where it did not, or passed on another one last."""
        last = self.passed.get(name)
        return last[1] if last and last[0] == digest else None

    def record(self, name: str, digest: str) -> None:
        self.record_all({name: digest})

    def record_all(self, passed: Mapping[str, str]) -> None:
        now = datetime.datetime.now().strftime("%Y-%m-%d %H:%M")
        self.passed.update({name: (digest, now) for name, digest in passed.items()})
        self.file.parent.mkdir(parents=True, exist_ok=True)
        half_written = self.file.with_suffix(".new")
        half_written.write_text(
            "".join(f"{h} {when} {n}\n" for n, (h, when) in sorted(self.passed.items())),
            encoding="utf-8")
        half_written.replace(self.file)


def passed_in(log: Path) -> list[str]:
    """The tests that CTest says passed; none where there is no such output."""
    if not log.is_file():
        return []
    return re.findall(r"^ *\d+/\d+ +Test +#\d+: (\S+) \.+ +Passed ",
                      log.read_text(encoding="utf-8", errors="replace"), re.MULTILINE)


def listed(file: str) -> dict[str, str]:
    """The hash of each test, from lines `HASH TEST`; empty where there is no such file."""
    if not Path(file).is_file():
        return {}
    lines = Path(file).read_text(encoding="utf-8").splitlines()
    return {test: digest for digest, test in (line.split(" ", 1) for line in lines)}


def run(verb: str, step: str, what: str = "", suite: str = "", log: str = "") -> int:
    green = Green(ROOT / "build" / f"{step}.green")
    if verb == "sources":
        print(sources(step))
    elif verb == "record":
        green.record(step, what)
    elif verb == "each":
        for test, digest in hashes_of_tests(step, (ROOT / what).resolve()).items():
            print(digest, test)
    elif verb == "tests":
        hashes = listed(what)
        green.record_all({f"{suite} {test}": hashes[test]
                          for test in passed_in(Path(log)) if test in hashes})
    elif verb == "passed":
        for test, digest in listed(what).items():
            if green.since(f"{suite} {test}", digest):
                print(test)
    else:
        when = green.since(step, what)
        print(when or "")
        return 0 if when else 1
    return 0


def main(arguments: list[str]) -> int:
    expected = {"sources": 2, "since": 3, "record": 3, "each": 3, "tests": 5, "passed": 4}
    if not arguments or expected.get(arguments[0]) != len(arguments) or arguments[1] not in STEPS:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        return run(*arguments)
    except (OSError, subprocess.CalledProcessError) as error:
        print(f"green.py: {error}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
