#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks what the pages tell readers to run: documented_commands.py WEFT ROOT

Each `weft check`, `weft run` or `weft bench` of a pipeline of this repository, in a shell block
or in backquotes, must pass `weft check` with the same settings. Pipelines on recorded data are
left out.
"""

import os
import pathlib
import re
import shlex
import subprocess
import sys

COMMAND = re.compile(r"weft (?:check|run|bench) (pipelines/\w+\.yaml[^`#\n&|]*)")


def commands(page):
    for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), 1):
        for found in COMMAND.findall(line):
            words = shlex.split(found)
            settings = [word for before, word in zip(words, words[1:]) if before == "--set"]
            yield number, words[0], settings


def main():
    weft, root = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    checked, failed = 0, 0
    environment = {name: value for name, value in os.environ.items() if name != "WEFT_DATA"}
    for page in [root / "README.md", *sorted((root / "docs").rglob("*.md"))]:
        for number, pipeline, settings in commands(page):
            options = [word for setting in settings for word in ("--set", setting)]
            done = subprocess.run([weft, "check", pipeline, *options], cwd=root, text=True, env=environment,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
            if "the variable WEFT_DATA is not set" in done.stdout:
                continue
            checked += 1
            if done.returncode != 0:
                failed += 1
                print(f"{page.relative_to(root)}:{number}: {done.stdout}", end="")
    print(f"{checked} commands, {failed} refused")
    return 1 if failed or not checked else 0


if __name__ == "__main__":
    sys.exit(main())
