#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares part of a page with what a program prints: page_part.py [--write] PAGE NAME PROGRAM [ARGUMENT...]

The part stands between the lines `<!-- NAME -->` and `<!-- /NAME -->`. Prints how the two differ and
exits 1 where they do; with --write the part is replaced.
"""

import difflib
import pathlib
import subprocess
import sys


def main(arguments: list[str]) -> int:
    write = arguments[:1] == ["--write"]
    page, name, *command = arguments[1:] if write else arguments
    text = pathlib.Path(page).read_text(encoding="utf-8")
    start, end = f"<!-- {name} -->\n", f"<!-- /{name} -->"
    if start not in text or end not in text:
        print(f"{page}: there is no part between {start.strip()} and {end}")
        return 1
    before, rest = text.split(start, 1)
    part, after = rest.split(end, 1)
    printed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    if write:
        pathlib.Path(page).write_text(before + start + printed + end + after, encoding="utf-8")
        return 0
    difference = list(difflib.unified_diff(
        part.splitlines(), printed.splitlines(), page, " ".join(command), lineterm=""))
    print("\n".join(difference))
    return 1 if difference else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
