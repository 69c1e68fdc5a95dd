#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints where each member of each struct of the binary contract lies.

Usage: layout.py ABI_H [COMPILER]

One line each: struct.member, offset and size in bytes, as the C compiler (default cc) has them.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path


def structs(text: str) -> dict[str, list[str]]:
    """Members of each struct by its name, in the order of the header."""
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    found = {}
    for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\n\} \w+;", text, flags=re.S):
        members = []
        for declaration in body.split(";"):
            pointer = re.search(r"\(\*(\w+)\)\(", declaration)
            plain = re.search(r"(\w+)(\[\w+\])?\s*$", declaration.strip())
            if pointer or plain:
                members.append((pointer or plain).group(1))
        found[name] = members
    return found


def main() -> int:
    if len(sys.argv) not in (2, 3):
        print(__doc__, file=sys.stderr)
        return 2
    header = Path(sys.argv[1]).resolve()
    lines = []
    for name, members in structs(header.read_text()).items():
        lines.append(f'  printf("{name} %zu\\n", sizeof({name}));')
        for member in members:
            place = f"offsetof({name}, {member}), sizeof((({name}*)0)->{member})"
            lines.append(f'  printf("{name}.{member} %zu %zu\\n", {place});')
    program = "\n".join(["#include <stddef.h>", "#include <stdio.h>", f'#include "{header}"',
                         "int main(void) {", *lines, "  return 0;", "}", ""])
    with tempfile.TemporaryDirectory() as folder:
        source, binary = Path(folder, "layout.c"), Path(folder, "layout")
        source.write_text(program)
        compiler = sys.argv[2] if len(sys.argv) == 3 else "cc"
        subprocess.run([compiler, "-std=c99", source, "-o", binary], check=True)
        subprocess.run([binary], check=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
