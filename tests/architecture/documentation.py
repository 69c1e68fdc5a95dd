#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the Markdown pages of the repository: documentation.py ROOT

A code block after the line `<!-- quote: PATH -->` must be the text of that file; with
`<!-- quote: PATH from: TEXT -->` the text from the first line that begins with TEXT on, and with
`... to: TEXT -->` up to the first later line that begins with it, that line included. Paths start at
the root. Links to files of the repository must exist, with the heading that they name.

Names in backticks must exist: `weft/core/x.hpp` as a header, `docs/x.md` and the like as a file of the
root or beside the page, `filters/x` as a component, `a_name` with an underscore in some source. Capitals
(`frames/NNNNNN.npz`) stand for something, and what ends in a number (`plain_101`) is data.
"""

import fnmatch
import os
import pathlib
import re
import subprocess
import sys

QUOTE = re.compile(r"<!-- quote: (\S+)(?: from: (.*?))?(?: to: (.*?))? -->")
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]+))?\)")
FENCE = re.compile(r"^\s*(```|~~~)")
SPAN = re.compile(r"`([^`]+)`")
PATH = re.compile(r"[\w.\-]+(?:/[\w.\-]+)+/?")
NAME = re.compile(r"(?<![\w/.\-])[A-Za-z]\w*_\w+(?![\w/\-])")
WORD = re.compile(r"\w+")
# Pages that list what a folder holds, with the patterns of paths that they must link to.
INDEXES = {
    "docs/README.md": ["docs/[a-z]*.md", "docs/tutorials/*.md", "docs/examples/*/"],
    "docs/evidence/README.md": ["docs/evidence/[0-9]*.md"],
    "docs/decisions/README.md": ["docs/decisions/[0-9]*.md"],
    "pipelines/README.md": ["pipelines/*.yaml", "pipelines/ablations/*.yaml"],
    "plugins/README.md": ["plugins/*/"],
    "tests/README.md": ["tests/*/"],
}
# Names of other programs and libraries, of what a reader is to write, and of what npm builds.
FOREIGN = {"CCACHE_DEPEND", "basic_filebuf", "my_test", "snake_case", "use_registers", "use_stacks",
           "framework/web/dist/report.js"}


def tracked(root, pattern):
    """Files that match, from the root: the tracked ones, or all where the root is no repository."""
    try:
        listed = subprocess.run(
            ["git", "-C", str(root), "ls-files", "-co", "--exclude-standard", pattern],
            check=True, capture_output=True, text=True).stdout.split("\n")
        return sorted(name for name in set(listed) if name and (root / name).is_file())
    except (subprocess.CalledProcessError, FileNotFoundError):
        return sorted(str(f.relative_to(root)) for f in root.rglob(pattern) if f.is_file())


def pages(root):
    return [root / name for name in tracked(root, "*.md")]


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


def outside_code(lines):
    """The numbered lines that stand in no code block."""
    inside = False
    for number, line in enumerate(lines, 1):
        inside ^= bool(FENCE.match(line))
        if not inside:
            yield number, line


def anchors(lines):
    """Headings as links name them."""
    for _, line in outside_code(lines):
        if line.startswith("#"):
            text = re.sub(r"[^\w\- ]", "", line.lstrip("#").strip().lower())
            yield text.replace(" ", "-")


def check_links(root, page, lines):
    for number, line in outside_code(lines):
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


class Names:
    """What exists under the root: files, folders, components and the words of the sources."""

    def __init__(self, root):
        self.files = set(tracked(root, "*"))
        self.folders = {str(folder) for file in self.files for folder in pathlib.Path(file).parents}
        self.words = set()
        for file in self.files:
            if not file.endswith(".md") and not (root / file).is_symlink():
                text = (root / file).read_bytes().decode("utf-8", "replace")
                self.words.update(WORD.findall(text) if "\0" not in text else [])
        roles = {f.split("/")[1] for f in self.files if re.match("plugins/[^/]+/[^/]+/", f)}
        component = re.compile(rf'"((?:{"|".join(sorted(roles)) or "-"})/[a-z0-9_.]+)"')
        self.roles = roles
        self.components = {
            name for file in self.files if file.endswith((".c", ".cpp", ".hpp", ".py"))
            for name in component.findall((root / file).read_text(encoding="utf-8"))}

    def has_path(self, path, folder):
        path = path.removeprefix("./").rstrip("/")
        known = self.files | self.folders
        first = path.split("/")[0]
        if path in FOREIGN:
            return True
        if first == "weft":
            return f"framework/include/{path}" in known
        if first in self.roles:
            return path in self.components or "." in path
        if first in self.folders:
            return path in known or str(folder / path) in known
        return True

    def has_word(self, word):
        if word in self.words or word in FOREIGN or re.search(r"_(\d+|[A-Z]{3,})(_|$)", word):
            return True
        if min(map(len, word.split("_"))) < 2:  # a symbol of a formula
            return True
        test = re.fullmatch(r"([a-z]+)_(\w+?)(_long)?_test", word)
        return test is not None and f"plugins/{test[1]}/{test[2]}" in self.folders


def check_names(names, page, lines):
    printed = False  # another test compares the output of programs
    for number, line in outside_code(lines):
        printed = line.startswith("<!-- weft ") or (printed and not line.startswith("<!-- /weft "))
        if printed:
            continue
        for span in SPAN.findall(line):
            if PATH.fullmatch(span) and not re.search(r"[A-Z]{3,}(?!\w*\.md)", span):
                if not names.has_path(span, page.parent):
                    yield number, f"there is no {span}"
                continue
            for word in NAME.findall(span):
                if not names.has_word(word):
                    yield number, f"no source has the name {word}"


def check_index(names, page, patterns, lines):
    """What a pattern of INDEXES matches and no link of the page leads to."""
    folder = str(page.parent)
    linked = {os.path.normpath(f"{folder}/{target}")
              for _, line in outside_code(lines) for target, _ in LINK.findall(line)}
    for pattern in patterns:
        known = names.folders if pattern.endswith("/") else names.files
        depth = pattern.rstrip("/").count("/")
        for path in sorted(known):
            if (path.count("/") == depth and fnmatch.fnmatch(path, pattern.rstrip("/"))
                    and path not in linked and f"{path}/README.md" not in linked):
                yield 1, f"does not link to {path}"


def problems(root):
    names = Names(root)
    for page in pages(root):
        lines = page.read_text(encoding="utf-8").splitlines()
        for number, message in [*check_quotes(root, lines), *check_links(root, page, lines),
                                *check_names(names, page.relative_to(root), lines),
                                *check_index(names, page.relative_to(root), INDEXES.get(
                                    str(page.relative_to(root)), []), lines)]:
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
