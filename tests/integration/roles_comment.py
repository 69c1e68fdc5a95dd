#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the table of roles in weft/sdk/roles.hpp with the program: roles_comment.py WEFT ROOT

Prints the lines that the comment should have where it differs from `weft records`.
"""

import pathlib
import subprocess
import sys
import textwrap

HEADER = "framework/include/weft/sdk/roles.hpp"


def expected(page):
    """A line for each method that consumes or produces something, folded at 100 columns."""
    lines = []
    for row in page[page.index("| sources |"):].splitlines():
        if not row.startswith("|"):
            break  # behind the table
        role, method, consumes, produces = (cell.strip() for cell in row.strip("|").split("|"))
        if consumes or produces:
            text = f"{role} {method.split()[1]}: {consumes} -> {produces}".replace("`", "")
            lines += textwrap.wrap(" ".join(text.split()).rstrip("-> "), 100, break_on_hyphens=False,
                                   initial_indent="///   ", subsequent_indent="///       ")
    return lines


def main():
    page = subprocess.run([sys.argv[1], "records"], stdout=subprocess.PIPE, text=True, check=True)
    header = (pathlib.Path(sys.argv[2]) / HEADER).read_text(encoding="utf-8")
    found = [line for line in header.splitlines() if line.startswith("///   ")]
    if found == expected(page.stdout):
        return 0
    print(f"{HEADER} should say:", *expected(page.stdout), sep="\n")
    return 1


if __name__ == "__main__":
    sys.exit(main())
