#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs clang-tidy over sources of framework/ and plugins/, tests not counted.

usage: scripts/tidy.py --since REV | --all [--jobs N] BUILD

BUILD is a configured build folder. With --since only the sources that differ from REV in the working
tree are checked, each by itself, which needs a build without unity (the preset clang). A header is
checked with a source that includes it. --all checks all that the build compiles, by its unity
batches where it has them.

The last line, `summary: RESULT: DETAIL`, is for test.sh. Exits 1 where clang-tidy reports
something, 2 where it cannot run.
"""

import argparse
import concurrent.futures
import json
import os
import subprocess
import sys
import time
from pathlib import Path
from typing import Iterable, Optional

ROOT = Path(__file__).resolve().parent.parent
ROOMS = ("framework", "plugins")
HEADERS = {".h", ".hpp"}
SOURCES = {".c", ".cpp"}
# Clang 14 does not know all of GCC's warnings and parameters, and misses captures that only
# instances of a generic lambda use.
ARGUMENTS = (
    "--quiet",
    "--checks=-bugprone-suspicious-include",
    "--extra-arg=-Wno-unknown-warning-option",
    "--extra-arg=-Wno-unused-lambda-capture",
    "--extra-arg=-Wno-unused-command-line-argument",
)


def is_ours(path: str) -> bool:
    """True for sources and headers of the rooms, tests not counted; the path is from the root."""
    parts = Path(path).parts
    return (parts[0] in ROOMS and "tests" not in parts
            and Path(path).suffix in HEADERS | SOURCES)


def git(*arguments: str) -> Optional[str]:
    """The output of git, None where it fails."""
    try:
        ran = subprocess.run(["git", "-C", str(ROOT), *arguments], check=True,
                             capture_output=True, text=True)
    except (subprocess.CalledProcessError, FileNotFoundError):
        return None
    return ran.stdout.strip()


def changed_since(commit: str) -> list[str]:
    """Sources and headers of ours that differ from the commit, untracked ones included."""
    differing = git("diff", "--name-only", "--no-renames", "--diff-filter=d", "-z", commit)
    if differing is None:
        raise OSError(f"git knows no commit '{commit}'")
    untracked = git("ls-files", "--others", "--exclude-standard", "-z") or ""
    return sorted({name for name in f"{differing}\0{untracked}".split("\0")
                   if name and is_ours(name)})


def includers(header: str, tree: dict[str, str]) -> list[str]:
    """Files of the tree that include the header, those beside it first."""
    path = Path(header)
    tails = {"/".join(path.parts[-n:]) for n in range(1, len(path.parts) + 1)}

    def includes(text: str) -> bool:
        return any(f'#include "{tail}"' in text or f"#include <{tail}>" in text for tail in tails)

    found = [name for name, text in tree.items() if path.name in text and includes(text)]
    return sorted(found, key=lambda name: (Path(name).parent != path.parent,
                                           Path(name).stem != path.stem, name))


def source_with(header: str, tree: dict[str, str], compiled: set[str]) -> Optional[str]:
    """A compiled source that reads the header, through as few other headers as may be."""
    seen, front = {header}, [header]
    while front:
        above = [name for each in front for name in includers(each, tree) if name not in seen]
        for name in above:
            if name in compiled:
                return name
        seen.update(above)
        front = above
    return None


def sources_of(changed: Iterable[str], compiled: set[str]) -> set[str]:
    """The compiled sources by which all that changed is seen."""
    tree = {name: (ROOT / name).read_text(encoding="utf-8", errors="replace")
            for name in (git("ls-files", "-z", "--cached", "--others", "--exclude-standard") or "")
            .split("\0") if name and is_ours(name) and (ROOT / name).is_file()}
    chosen = {name for name in changed if name in compiled}
    for name in changed:
        if Path(name).suffix in HEADERS:
            source = source_with(name, tree, compiled)
            if source:
                chosen.add(source)
    return chosen


def entries_of(build: Path) -> list[str]:
    """What the build compiles of the rooms, tests not counted: paths from the root."""
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    found = set()
    for entry in commands:
        path = os.path.relpath(entry["file"], ROOT)
        own = os.path.relpath(entry["file"], build)
        if is_ours(path) or (own.split("/")[0] in ROOMS and "_test" not in own):
            found.add(path)
    return sorted(found)


def tidy(source: str, build: Path) -> tuple[bool, str]:
    """Whether clang-tidy is content, and a text with its time and its complaints."""
    start = time.monotonic()
    ran = subprocess.run(["clang-tidy", *ARGUMENTS, "-p", str(build), str(ROOT / source)],
                         check=False, capture_output=True, text=True)
    verdict = "ok" if ran.returncode == 0 else "FAILED"
    said = ran.stdout if "error:" in ran.stdout or not ran.returncode else ran.stdout + ran.stderr
    text = f"{source}: {verdict}, {time.monotonic() - start:.0f} s"
    return ran.returncode == 0, "\n".join([text, said.rstrip()]).rstrip()


def report(result: str, detail: str) -> int:
    print(f"summary: {result}: {detail}")
    return 1 if result == "FAILED" else 0


def run(options: argparse.Namespace) -> int:
    compiled = entries_of(options.build)
    chosen, of = compiled, f"of {len(compiled)} sources"
    if not options.all:
        changed = changed_since(options.since)
        chosen = sorted(sources_of(changed, set(compiled)))
        of += f", files changed since {git('rev-parse', '--short', options.since)}: {len(changed)}"
    failed = 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        running = [pool.submit(tidy, source, options.build) for source in chosen]
        for number, done in enumerate(concurrent.futures.as_completed(running), 1):
            passed, text = done.result()
            print(f"[{number}/{len(chosen)}] {text}", flush=True)
            failed += not passed
    if failed:
        return report("FAILED", f"{failed} of {len(chosen)} sources")
    return report("ok", f"{len(chosen)} {of}")


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("build", type=Path)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument("--since")
    which.add_argument("--all", action="store_true")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args(arguments)
    options.build = options.build.resolve()
    try:
        return run(options)
    except OSError as error:
        print(f"tidy.py: {error} (the build must be configured, clang-tidy and git installed)",
              file=sys.stderr)
    return 2


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
