#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks that commits changed only text: comments, docstrings and string literals.

usage: scripts/compare_tokens.py [--strings] REV [REV2]

Compares the token streams of all C++ and Python sources of two revisions, or of REV and the working
tree. Comments, docstrings and line breaks are ignored, and each sequence of adjacent string literals
is replaced by one placeholder. With --strings the contents of string literals are compared too.
Paths of #include directives are always compared. Other kinds of files are not compared.

Prints the first differing token of each source. Exits 1 if a source differs, 2 if git fails.
"""

import argparse
import io
import keyword
import re
import subprocess
import sys
import tokenize
from itertools import zip_longest
from pathlib import Path
from typing import Iterator, NamedTuple, Optional

CPP = {".h", ".hpp", ".c", ".cpp"}
PYTHON = {".py", ".pyi"}
STRING, CHARACTER, END = "<string>", "<character>", "<end of directive>"
CPP_TOKEN = re.compile(
    r"""(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)
      | (?P<newline>\n) | (?P<space>\\\r?\n|[^\S\n]+)
      | (?P<raw>(?:u8|[uUL])?R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)")
      | (?P<string>(?:u8|[uUL])?"(?:\\.|[^"\\\n])*")
      | (?P<character>(?:u8|[uUL])?'(?:\\.|[^'\\\n])+')
      | (?P<number>\.?\d(?:[eEpP][+-]|'?[\w.])*)
      | (?P<name>\w+)
      | (?P<operator><<=|>>=|<=>|->\*|\.\.\.|\#\#|::|->|\+\+|--|&&|\|\||[-+*/%&|^=!<>]=|<<|.)""",
    re.VERBOSE | re.DOTALL)


Token = NamedTuple("Token", [("text", str), ("line", int)])


def literal(found: re.Match[str]) -> str:
    """The contents of a string or character literal."""
    text = found.group()
    if found["raw"]:
        return text[text.index("(") + 1:-2 - len(found["mark"])]
    return text[text.index(text[-1]) + 1:-1]


def cpp_tokens(text: str, strings: bool) -> Iterator[Token]:
    line, directive, fresh = 1, "", True  # fresh: no token on this line yet
    pending: Optional[Token] = None  # string literals seen since the last other token
    for found in CPP_TOKEN.finditer(text):
        kind, start = found.lastgroup, line
        line += found.group().count("\n")
        if kind in ("raw", "string") and directive != "#include":
            before = pending.text if pending else STRING
            pending = Token(before + literal(found) if strings else STRING,
                            pending.line if pending else start)
        elif kind not in ("comment", "space") and (kind != "newline" or directive):
            if pending:
                yield pending
                pending = None
            if kind == "newline":
                directive = ""
                yield Token(END, start)
            elif kind == "character":
                yield Token(CHARACTER + (literal(found) if strings else ""), start)
            else:
                if found.group() == "#" and fresh:
                    directive = "#"
                elif directive == "#":
                    directive += found.group()
                yield Token(found.group(), start)
        fresh = kind == "newline" or (fresh and kind in ("comment", "space"))
    if pending:
        yield pending


def groups_only(kept: list[Token]) -> bool:
    """True if the tokens end with `( string` and the parenthesis only allows a line break."""
    words = ["", *(each.text for each in kept[-3:])][-3:]
    return words[1] == "(" and words[2].startswith(STRING) and (
        keyword.iskeyword(words[0]) or not re.match(r"[\w)\]]", words[0]))


def python_tokens(text: str, strings: bool) -> Iterator[Token]:
    kept: list[Token] = []
    depth = 0  # nesting depth of f-strings, which Python 3.12 splits
    for kind, word, (line, _), _, _ in tokenize.generate_tokens(io.StringIO(text).readline):
        name, inside = tokenize.tok_name[kind], depth > 0
        depth += (name == "FSTRING_START") - (name == "FSTRING_END")
        if name in ("INDENT", "DEDENT", "NEWLINE"):
            word = f"<{name.lower()}>"
        if name == "STRING" or inside or depth:
            content = re.sub(r"""^\w*("{3}|'{3}|["'])|("{3}|'{3}|["'])$""", "", word) if strings else ""
            joined = kept.pop() if kept and kept[-1].text.startswith(STRING) else Token(STRING, line)
            kept.append(joined._replace(text=joined.text + content))
        elif word == ")" and groups_only(kept):
            del kept[-2]
        elif name == "NEWLINE" and kept and kept[-1].text.startswith(STRING) and (
                len(kept) == 1 or kept[-2].text in ("<newline>", "<indent>", "<dedent>")):
            kept.pop()  # a docstring
        elif name not in ("COMMENT", "NL"):
            kept.append(Token(word, line))
    yield from kept


def difference(path: str, old: str, new: str, strings: bool) -> Optional[str]:
    """The first tokens that differ, None if there are none."""
    split = cpp_tokens if Path(path).suffix in CPP else python_tokens
    try:
        for one, two in zip_longest(split(old, strings), split(new, strings)):
            if one is None or two is None or one.text != two.text:
                was, now = (repr(t.text) if t else "the end" for t in (one, two))
                return f"{path}:{(two or one).line}: {now}, was {was}"
    except (tokenize.TokenError, SyntaxError) as error:
        return f"{path}: cannot be read: {error}"
    return None


def git(*arguments: str) -> str:
    ran = subprocess.run(["git", *arguments], check=True, capture_output=True)
    return ran.stdout.decode("utf-8", "replace")


def problems(old: str, new: Optional[str], strings: bool) -> Iterator[str]:
    root = Path(git("rev-parse", "--show-toplevel").strip())
    fields = git("diff", "--name-status", "--no-renames", "-z", old, *filter(None, [new])).split("\0")
    changes = dict(zip(fields[1::2], fields[::2]))
    if not new:
        untracked = git("ls-files", "--others", "--exclude-standard", "--full-name", "-z", ":/")
        changes.update((path, "A") for path in untracked.split("\0"))
    for path, status in sorted(changes.items()):
        if Path(path).suffix not in CPP | PYTHON:
            continue
        if status in "AD":
            yield f"{path}: {'added' if status == 'A' else 'removed or renamed'}"
            continue
        after = git("show", f"{new}:{path}") if new else (root / path).read_text("utf-8", "replace")
        found = difference(path, git("show", f"{old}:{path}"), after, strings)
        if found:
            yield found


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("--strings", action="store_true")
    parser.add_argument("old")
    parser.add_argument("new", nargs="?")
    options = parser.parse_args(arguments)
    try:
        found = list(problems(options.old, options.new, options.strings))
    except subprocess.CalledProcessError as error:
        print(error.stderr.decode("utf-8", "replace").strip(), file=sys.stderr)
        return 2
    print("\n".join([*found, f"sources that differ in code: {len(found)}"]))
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
