#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints the frozen part of the binary contract, or compares two such lists.

Usage: layout.py ABI_H [COMPILER]
       layout.py --compare KEPT NEW

The first form prints one line for each struct (size), member (offset and size in bytes, as the C
compiler has them, and declaration), value of an enum, and macro. The records of the catalogue come
from `weft_abi_host --catalogue`. The second form prints each difference that a minor version must
not make, and exits 1 if there is one.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

MINOR = "macro WEFT_ABI_MINOR"  # grows with each version
NOT_FROZEN = {"WEFT_ABI_H_", "WEFT_EXPORT"}


def structs(text: str) -> dict[str, dict[str, str]]:
    """Declarations of the members of each struct, in the order of the header."""
    found = {}
    for name, body in re.findall(r"typedef struct (\w+) \{(.*?)\n\} \w+;", text, flags=re.S):
        members = {}
        for declaration in body.split(";"):
            declaration = " ".join(declaration.split())
            pointer = re.search(r"\(\*(\w+)\)\(", declaration)
            plain = re.search(r"(\w+)(\[\w+\])?$", declaration)
            if pointer or plain:
                members[(pointer or plain).group(1)] = declaration
        found[name] = members
    return found


def values(text: str) -> list[tuple[str, str]]:
    """Enums and their values, by name."""
    return [(name, word) for name, body in re.findall(r"typedef enum (\w+) \{(.*?)\}", text, re.S)
            for word in re.findall(r"(\w+) =", body)]


def macros(text: str) -> list[str]:
    found = re.findall(r"^#define (WEFT_\w+) +(.+?) *$", text, flags=re.M)
    return [f"macro {name} {value}" for name, value in found if name not in NOT_FROZEN]


def program(header: Path, text: str) -> str:
    lines = []
    for name, members in structs(text).items():
        lines.append(f'printf("struct {name} %zu\\n", sizeof({name}));')
        for member, declaration in members.items():
            place = f"offsetof({name}, {member}), sizeof((({name}*)0)->{member})"
            lines.append(f'printf("member {name}.{member} %zu %zu {declaration}\\n", {place});')
    for name, word in values(text):
        lines.append(f'printf("value {name}.{word} %d\\n", (int){word});')
    return "\n".join(["#include <stddef.h>", "#include <stdio.h>", f'#include "{header}"',
                      "int main(void) {", *lines, "return 0;", "}", ""])


def print_layout(header: Path, compiler: str) -> None:
    text = re.sub(r"/\*.*?\*/", "", header.read_text(), flags=re.S)
    with tempfile.TemporaryDirectory() as folder:
        source, binary = Path(folder, "layout.c"), Path(folder, "layout")
        source.write_text(program(header, text))
        subprocess.run([compiler, "-std=c99", source, "-o", binary], check=True)
        subprocess.run([binary], check=True)
    print("\n".join(macros(text)))


def entries(lines: list[str]) -> dict[str, str]:
    """The rest of each line by its kind and name."""
    found = {}
    for line in lines:
        kind, name, *rest = line.split(" ", 2)
        found[f"{kind} {name}"] = rest[0] if rest else ""
    return found


def illegal_addition(key: str, value: str, kept: dict[str, str]) -> str:
    """The reason why a minor version must not add an entry, or an empty text."""
    kind, name = key.split(" ")
    owner = name.rpartition(".")[0]
    if kind == "member" and f"struct {owner}" in kept:
        if int(value.split()[0]) < int(kept[f"struct {owner}"]):
            return "is not behind the members of the kept version"
    if kind == "array" and f"record {owner}" in kept and " optional" not in value:
        return "is an array that is required in a kept record"
    if kind == "value":
        taken = [each for each, number in kept.items()
                 if each.startswith(f"value {owner}.") and number == value]
        return f"has the number of {taken[0]}" if taken else ""
    return ""


def is_legal_change(key: str, old: str, new: str, kept: dict[str, str]) -> bool:
    if key == MINOR:
        return int(new) >= int(old)
    kind, name = key.split(" ")
    return kind == "struct" and f"member {name}.struct_size" in kept and int(new) >= int(old)


def differences(kept_lines: list[str], new_lines: list[str]) -> list[str]:
    kept, new = entries(kept_lines), entries(new_lines)
    found = []
    for key, old in kept.items():
        if key not in new:
            found.append(f"{key} is missing; it was '{old}'")
        elif new[key] != old and not is_legal_change(key, old, new[key], kept):
            found.append(f"{key} is '{new[key]}'; it was '{old}'")
    for key, value in new.items():
        reason = illegal_addition(key, value, kept) if key not in kept else ""
        if reason:
            found.append(f"{key} {reason}")
    in_order = [key for key in new if key in kept]
    if in_order != [key for key in kept if key in new]:
        found.append("the entries of the kept version have another order")
    return found


def main() -> int:
    words = sys.argv[1:]
    if len(words) == 3 and words[0] == "--compare":
        found = differences(*(Path(word).read_text().splitlines() for word in words[1:]))
        print("\n".join(found), end="\n" if found else "")
        return 1 if found else 0
    if len(words) not in (1, 2) or words[0].startswith("-"):
        print(__doc__, file=sys.stderr)
        return 2
    print_layout(Path(words[0]).resolve(), words[1] if len(words) == 2 else "cc")
    return 0


if __name__ == "__main__":
    sys.exit(main())
