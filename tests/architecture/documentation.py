#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the Markdown pages of the repository: documentation.py ROOT

A code block after the line `<!-- quote: PATH -->` must be the text of that file; with
`<!-- quote: PATH from: TEXT -->` the text from the first line that begins with TEXT on, and with
`... to: TEXT -->` up to the first later line that begins with it, that line included. Paths start at
the root. Links to files of the repository must exist, with the heading that they name.
"""

import pathlib
import re
import subprocess
import sys

QUOTE = re.compile(r"<!-- quote: (\S+)(?: from: (.*?))?(?: to: (.*?))? -->")
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
FENCE = re.compile(r"^\s*(```|~~~)")


def pages(root):
    """The tracked pages, or all of them where the root is no repository."""
    try:
        listed = subprocess.run(
            ["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", "*.md"],
            check=True, capture_output=True, text=True).stdout.split("\n")
        return [root / name for name in listed if name and (root / name).exists()]
    except (subprocess.CalledProcessError, FileNotFoundError):
        return sorted(root.rglob("*.md"))


def excerpt(root, quote):
    """The lines that a quote names, or an explanation of why there are none."""
    path, start, end = quote.groups()
    file = root / path
    if not file.is_file():
        return None, f"there is no file {path}"
    lines = file.read_text(encoding="utf-8").splitlines()
    if start is not None:
        first = next((i for i, line in enumerate(lines) if line.strip().startswith(start)), None)
        if first is None:
            return None, f"no line of {path} begins with '{start}'"
        lines = lines[first:]
    if end is not None:
        last = next((i for i, line in enumerate(lines) if i and line.strip().startswith(end)), None)
        if last is None:
            return None, f"no later line of {path} begins with '{end}'"
        lines = lines[:last + 1]
    indent = min((len(line) - len(line.lstrip()) for line in lines if line.strip()), default=0)
    return [line[indent:] for line in lines], None


def check_quotes(root, lines):
    for number, line in enumerate(lines, 1):
        quote = QUOTE.search(line)
        if not quote:
            continue
        if number >= len(lines) or not FENCE.match(lines[number]):
            yield number, "no code block follows the quote"
            continue
        expected, problem = excerpt(root, quote)
        if problem:
            yield number, problem
            continue
        close = next((i for i in range(number + 1, len(lines)) if FENCE.match(lines[i])), len(lines))
        if lines[number + 1:close] != expected:
            yield number, f"the code block differs from {quote.group(1)}"


def anchors(lines):
    """Headings as links name them."""
    inside = False
    for line in lines:
        inside ^= bool(FENCE.match(line))
        if not inside and line.startswith("#"):
            text = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower())
            yield text.replace(" ", "-")


def check_links(root, page, lines):
    inside = False
    for number, line in enumerate(lines, 1):
        inside ^= bool(FENCE.match(line))
        if inside:
            continue
        for target, anchor in LINK.findall(re.sub(r"`[^`]*`", "", line)):
            if re.match(r"[a-z]+:", target):
                continue
            file = (page.parent / target).resolve() if target else page
            if not file.exists():
                yield number, f"there is no {target}"
            elif anchor and file.is_file():
                known = list(anchors(file.read_text(encoding="utf-8").splitlines()))
                if anchor not in known:
                    yield number, f"{target or 'the page'} has no heading '#{anchor}'"


def problems(root):
    for page in pages(root):
        lines = page.read_text(encoding="utf-8").splitlines()
        for number, message in [*check_quotes(root, lines), *check_links(root, page, lines)]:
            yield f"{page.relative_to(root)}:{number}: {message}"


def main():
    if len(sys.argv) != 2:
        print(__doc__)
        return 2
    found = list(problems(pathlib.Path(sys.argv[1]).resolve()))
    print("\n".join(found) if found else "all quotes and links hold")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
