#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the style of pages, comments, parameter help and messages.

usage: tests/architecture/prose.py ROOT [--list [PREFIX] | --write-budget [--force]]

Reads all Markdown pages (except CHANGELOG.md, code blocks and generated parts) and all C++ sources.
Each finding has a kind, such as `comment term`:

  term    a banned word or phrase, with its replacement (see TERMS)
  length  a sentence above 30 words
  start   a statement that begins with a word such as What or Of (see START)
  form    a parameter help that is no noun phrase

prose_budget.json, beside this script or in ROOT, has the allowed number of findings of each kind in
each top folder. The test fails above the budget, and prints the findings in the files that were
changed last. --write-budget lowers the budget to the present counts; --force also raises it. --list
prints all findings in paths that begin with PREFIX, and their counts.
"""

import argparse
import bisect
import json
import re
import sys
from collections import Counter
from pathlib import Path
from typing import Iterator, NamedTuple

import documentation

BUDGET = "prose_budget.json"
LIMIT = 30  # words of a sentence
SHOWN = 20  # findings of one kind and folder

# Pattern (a space matches any white space, the case of the first letter is ignored) and replacement.
TERMS = [
    # Components are not people.
    (r"(?<!people )(?<!users )(?<!user )(?<!authors )(?<!readers )(?<!reader )who(ever|m)?\b",
     "name the component"),
    (r"nobody|no one|somebody", "name the component; 'no component', 'unused', 'discarded'"),
    (r"tells?|telling|told", "reports, prints, distinguishes, indicates"),
    (r"says?|saying|said", "reports, prints, states, specifies"),
    (r"asks?|asking|asked", "requests, calls, requires"),
    (r"knows|knew", "has, detects, stores"),
    (r"speaks?|spoke", "contradicts, supports, suggests"),
    (r"wish(es|ed)?", "parameter change request; 'need', 'want'"),
    (r"minds|cares about|is content with", "accepts, checks, handles"),
    # Terms of the field.
    (r"mistakes?", "error"),
    (r"apart(?! from)", "separately, excluded, in its own process"),
    (r"held frames?|frames? (is|are|was|were) held", "carried over"),
    (r"(laid|lays?|laying) over", "merged, overrides"),
    (r"stands? (in for|in|at|on|beside|under|before|after|there)|standing in", "is stored in, is defined in"),
    (r"lies? in (a|an|the|its|their|this|each|one) (\w+ )?(file|folder|header|page|table|record|key)s?",
     "is stored in, is defined in"),
    (r"(goes|go|went) without", "omits"),
    (r"(leaves?|leaving|left) out", "omits, is omitted"),
    (r"on the wall|processor time", "wall-clock time; CPU time"),
    (r"pictures?", "image"),
    (r"drawn(?! (at random|from|uniformly|independently))", "rendered, sampled"),
    (r"(the|a|its|this) print", "texture"),
    (r"(?<!paper )(?<!rubber )(?<!A4 )sheets?(?! of paper)", "surface, object, table"),
    (r"(in|into|out of) sight", "visible, invisible"),
    (r"(correct|wrong|right|false) match(es)?", "inlier, outlier"),
    (r"(sparse|dense) ways?", "method, pipeline"),
    (r"exactness", "accuracy"),
    (r"lanes?", "execution context"),
    (r"(seat|workplace|cage|animal|deed|door|zoo)s?",
     "worker session, worker context, temporary directory, test case, mutation, command"),
    (r"foreign(?! (key|function|object))", "third-party, external"),
    # Constructions.
    (r"of (one's|its|their|your|his) own", "custom, separate, own"),
    (r"of (which|whom|whose)", "split the sentence"),
    (r"(is|are|was|were) (not )?of(?! (type|size|order|length|class|interest|use|the form))",
     "belongs to, comes from, has"),
    (r"what is [^.;:?!]{3,60} is", "name the thing"),
    (r"by then|to and fro|as it were|for its part|and nothing else|anything else", "drop"),
    (r"so many|so much|as many as may be|as may be", "the number"),
    (r"(goes|go) by", "uses, depends on"),
    (r"in place of", "instead of"),
]
START = re.compile(r"(?:What|Who|Whoever|Whether|Of|By(?! default)|So|That (?:an?|the|no|it|all|each))\b")
START_COMMENT = re.compile(r"(?:of|what|who|whether)\b")
# Help texts that are no noun phrase: first words.
RELATION = re.compile(
    r"(?:of|at|in|on|by|from|to|with|without|within|up|for|over|after|before|beside|between|below|above|"
    r"how|what|which|where|when|who|why|that|if|so|as|also|or|and|then|than|not|it|they|these|else)\b")
VERB = re.compile(
    r"(?:add|allow|ask|begin|build|choose|compare|compute|count|cut|detect|do|drop|draw|estimate|fill|"
    r"find|fit|follow|give|go|ignore|keep|leave|let|look|make|match|measure|move|print|put|read|refine|"
    r"reject|render|run|see|send|show|skip|solve|start|stop|store|take|train|try|turn|use|wait|warn|"
    r"write)(?:s|es)?\b(?! (?:of|for))|(?:is|are|has|have|may|must|can|does)\b")

CPP_PART = re.compile(
    r"""(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)
      | (?P<raw>\b(?:u8|[uUL])?R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)")
      | (?P<string>"(?:\\.|[^"\\\n])*") | (?<!\w)'(?:\\.|[^'\\\n])+'""",
    re.VERBOSE | re.DOTALL)
CALL = re.compile(r"\b(?:p|params|parameters)\.(?:read|text|input_path|output_path|labels|choice|component)\(")
LIST_ITEM = re.compile(r"\s*(?:[-*+]|\d+[.)])\s+")
COMMENT_MARK = re.compile(r"(?:/{2,}<?|/\*+|\*/|\*(?!/))[ ]?")
TOOL = re.compile(r"SPDX-|NOLINT|clang-format|IWYU|@|\\file|namespace\b|=====|-----")


class Text(NamedTuple):
    """A paragraph: its lines with their numbers."""
    path: str
    type: str  # page, heading, comment, help, message
    lines: list[tuple[int, str]]


class Finding(NamedTuple):
    kind: str
    path: str
    line: int
    message: str

    @property
    def folder(self) -> str:
        return self.path.split("/")[0] if "/" in self.path else "."


def compiled(pattern: str) -> re.Pattern[str]:
    """The pattern for text in which a line break may replace a space."""
    lookbehind = re.split(r"(\(\?<![^)]*\))", pattern)  # these need a fixed width, thus a plain space
    return re.compile(r"(?<![\w/.:\-<])(?:" + "".join(
        part if part.startswith("(?<!") else part.replace(" ", r"\s+") for part in lookbehind)
        + r")(?![\w/]|-\w|\(|::)", re.IGNORECASE)


TERM = [(compiled(pattern), replacement) for pattern, replacement in TERMS]


def without_code(line: str) -> str:
    line = re.sub(r"``.+?``|`[^`]*`|\$\$?[^$]+\$\$?", "CODE", line)
    line = re.sub(r"<!--.*?-->|!\[[^\]]*\]", "", line)
    line = re.sub(r"\[([^\]]*)\](?:\([^)]*\)|\[[^\]]*\])", r"\1", line)
    return re.sub(r"https?://\S+|<[^<>\s][^<>]*>", "CODE", line)


def page_texts(path: str, text: str) -> Iterator[Text]:
    lines = text.splitlines()
    closing = {found[1]: number for number, line in enumerate(lines, 1)
               for found in [re.match(r"<!-- /(\w+)", line)] if found}
    fence, generated = False, 0
    paragraph: list[tuple[int, str]] = []
    for number, line in enumerate([*lines, ""], 1):
        if documentation.FENCE.match(line):
            fence = not fence
            line = ""
        begin = re.match(r"<!-- (\w+)", line)
        if begin and not fence:
            end = next((n for n in sorted(closing.values()) if n > number and closing.get(begin[1]) and
                        lines[n - 1].startswith(f"<!-- /{begin[1]}")), 0)
            generated = max(generated, end)
        if fence or number <= generated:
            line = ""
        line = re.sub(r"^\s*(?:>\s?)+", "", line)
        item, row = LIST_ITEM.match(line), line.lstrip().startswith("|")
        if paragraph and (not line.strip() or item or row or line.startswith(("#", "<"))):
            yield Text(path, "page", paragraph)
            paragraph = []
        if row:
            for cell in re.split(r"(?<!\\)\|", line.strip().strip("|")):
                yield Text(path, "page", [(number, without_code(cell.strip()))])
        elif line.startswith("#"):
            yield Text(path, "heading", [(number, without_code(line.strip("# ")))])
        elif line.strip():
            paragraph.append((number, line[item.end():] if item else line.strip()))
    if paragraph:
        yield Text(path, "page", paragraph)


class Source:
    """A C++ source: its comments and string literals."""

    def __init__(self, path: str, text: str) -> None:
        self.path, self.text = path, text
        self.starts = [0, *(found.end() for found in re.finditer("\n", text))]
        self.comments: list[tuple[int, int]] = []
        self.strings: list[tuple[int, int]] = []
        for found in CPP_PART.finditer(text):
            if found["comment"]:
                self.comments.append(found.span())
            elif found["string"]:
                self.strings.append(found.span())

    def line(self, offset: int) -> int:
        return bisect.bisect_right(self.starts, offset)

    def comment_texts(self) -> Iterator[Text]:
        paragraph: list[tuple[int, str]] = []
        before = (0, 0)  # line and column of the paragraph's last comment
        code = False
        for begin, end in self.comments:
            first = self.line(begin)
            column = begin - self.starts[first - 1]
            is_alone = not self.text[self.starts[first - 1]:begin].strip()
            if before != (first - 1, column) or not is_alone:
                if paragraph:
                    yield Text(self.path, "comment", paragraph)
                paragraph, code = [], False
            for number, line in enumerate(self.text[begin:end].split("\n"), first):
                line = line.strip().removesuffix("*/")
                line = COMMENT_MARK.sub("", line, count=1) if COMMENT_MARK.match(line) else line
                code ^= line.strip().startswith("```")
                item = LIST_ITEM.match(line)
                skipped = code or line.startswith("   ") and not item or "```" in line or TOOL.match(line)
                if paragraph and (not line.strip() or item or skipped):
                    yield Text(self.path, "comment", paragraph)
                    paragraph = []
                if line.strip() and not skipped:
                    paragraph.append((number, line[item.end():] if item else line.strip()))
                before = (number, column)
        if paragraph:
            yield Text(self.path, "comment", paragraph)

    def literal_texts(self) -> Iterator[Text]:
        """Parameter help, and other literals of some words."""
        runs: list[list[tuple[int, int]]] = []  # adjacent literals
        for begin, end in self.strings:
            if runs and not self.text[runs[-1][-1][1]:begin].strip():
                runs[-1].append((begin, end))
            else:
                runs.append([(begin, end)])
        helps = set(self.help_starts())
        for run in runs:
            begin = run[0][0]
            lines = [(self.line(b), self.text[b + 1:e - 1].replace("\\n", " ")) for b, e in run]
            if begin in helps:
                yield Text(self.path, "help", lines)
            elif sum(line.count(" ") for _, line in lines) > 2 and "#include" not in self.text[
                    self.starts[lines[0][0] - 1]:begin]:
                yield Text(self.path, "message", lines)

    def help_starts(self) -> Iterator[int]:
        """Where the help of each parameter begins: a literal that is the third argument or later."""
        if not CALL.search(self.text):
            return
        masked = self.text
        for begin, end in self.comments:
            masked = masked[:begin] + " " * (end - begin) + masked[end:]
        for begin, end in self.strings:
            masked = masked[:begin] + '"' + "x" * (end - begin - 2) + '"' + masked[end:]
        for call in CALL.finditer(masked):
            depth, commas = 1, [call.end()]
            at = call.end()
            while depth and at < len(masked):
                depth += (masked[at] in "({[") - (masked[at] in ")}]")
                if depth == 1 and masked[at] == ",":
                    commas.append(at + 1)
                at += 1
            arguments = list(zip(commas, [c - 1 for c in commas[1:]] + [at - 1]))
            texts = [index for index, (begin, end) in enumerate(arguments)
                     if index > 1 and re.fullmatch(r'\s*(?:"x*"\s*)+', masked[begin:end])]
            is_unit = texts == [2] and len(arguments) > 3 and "Need" not in masked[slice(*arguments[3])]
            if texts and not (is_unit and ".read(" in call.group()):
                begin = arguments[texts[-1]][0]
                yield begin + len(masked[begin:]) - len(masked[begin:].lstrip())


def sentences(text: str) -> Iterator[tuple[int, str]]:
    """Offset and text of each sentence."""
    shown = re.sub(r"\b(?:e\.g|i\.e|vs|cf|al|Fig|Eq|Sec|No|approx|resp|etc)\.", lambda m: m[0][:-1] + "_", text)
    begin = 0
    for found in re.finditer(r"[.!?][\"')\]*_]*\s+(?=[A-Z\"'(\[*_`])", shown):
        yield begin, text[begin:found.end()]
        begin = found.end()
    yield begin, text[begin:]


def check(paragraph: Text) -> Iterator[Finding]:
    path, kind, lines = paragraph
    joined = "" if kind in ("help", "message") else "\n"  # literals end with their spaces
    raw = [(number, line if kind == "heading" else without_code(line)) for number, line in lines]
    if "`" in "".join(line for _, line in raw):  # a code span over a line break
        joined_lines = re.sub(r"`[^`]*`", lambda m: "CODE" + "\n" * m[0].count("\n"),
                              "\n".join(line for _, line in raw))
        raw = list(zip([number for number, _ in raw], joined_lines.split("\n")))
    ends, text = [0], ""
    for _, line in raw:
        text += line + joined
        ends.append(len(text))

    def finding(sort: str, offset: int, message: str) -> Finding:
        index = min(bisect.bisect_right(ends, offset) - 1, len(raw) - 1)
        return Finding(f"{'page' if kind == 'heading' else kind} {sort}", path, raw[index][0], message)

    for pattern, replacement in TERM:
        for found in pattern.finditer(text):
            words = " ".join(found[0].split())
            yield finding("term", found.start(), f"'{words}': {replacement}")
    if kind == "help":
        stripped = text.strip()
        if RELATION.match(stripped) or VERB.match(stripped) or re.search(r"(?<!\.)\.$", stripped):
            yield finding("form", 0, f"'{stripped[:60]}': a noun phrase without a full stop")
    if kind == "heading":
        return
    for offset, sentence in sentences(text):
        words = [word for word in sentence.split() if re.search(r"\w", word)]
        if len(words) > LIMIT:
            yield finding("length", offset, f"a sentence of {len(words)} words: '{' '.join(words[:6])} ...'")
        start = sentence.lstrip(" *_(\"'")
        if kind in ("page", "comment") and not sentence.rstrip().endswith("?") and (
                START.match(start) or (kind == "comment" and START_COMMENT.match(start))):
            yield finding("start", offset, f"begins with '{start.split()[0]}': name the subject first")


def texts(root: Path) -> Iterator[Text]:
    for path in documentation.tracked(root, "*.md"):
        if Path(path).name != "CHANGELOG.md":
            yield from page_texts(path, (root / path).read_text("utf-8"))
    for suffix in ("h", "hpp", "c", "cpp"):
        for path in documentation.tracked(root, f"*.{suffix}"):
            source = Source(path, (root / path).read_text("utf-8", "replace"))
            yield from source.comment_texts()
            if path.split("/")[0] in ("framework", "plugins") and "tests" not in path.split("/"):
                yield from source.literal_texts()


def findings(root: Path) -> list[Finding]:
    return [found for paragraph in texts(root) for found in check(paragraph)]


def nested(counts: Counter) -> dict[str, dict[str, int]]:
    result: dict[str, dict[str, int]] = {}
    for (kind, folder), number in sorted(counts.items()):
        result.setdefault(kind, {})[folder] = number
    return result


def shown(found: Finding) -> str:
    return f"{found.path}:{found.line}: {found.kind}: {found.message}"


def run(root: Path, options: argparse.Namespace) -> int:
    found = findings(root)
    if options.list is not None:
        chosen = [each for each in found if each.path.startswith(options.list)]
        print("\n".join(map(shown, chosen)))
        for kind, number in sorted(Counter(each.kind for each in chosen).items()):
            print(f"{kind}: {number}")
        return 0
    file = root / BUDGET
    if not file.is_file():
        file = Path(__file__).resolve().parent / BUDGET
    budget = Counter({(kind, folder): number for kind, folders in
                      (json.loads(file.read_text()) if file.is_file() else {}).items()
                      for folder, number in folders.items()})
    counts = Counter((each.kind, each.folder) for each in found)
    above = {key for key in counts if counts[key] > budget[key]}
    if options.write_budget:
        kept = counts if options.force else Counter(
            {key: min(counts[key], budget[key]) for key in counts if budget[key]})
        file.write_text(json.dumps(nested(kept), indent=2) + "\n")
        above = set() if options.force else above
    for key in sorted(budget):
        if counts[key] < budget[key] and not options.write_budget:
            print(f"{': '.join(key)}: lower the budget to {counts[key]} (--write-budget)")
    for key in sorted(above):
        newest = sorted((each for each in found if (each.kind, each.folder) == key),
                        key=lambda each: -(root / each.path).stat().st_mtime)
        print("\n".join(map(shown, newest[:SHOWN])))
        print(f"{': '.join(key)}: {counts[key]} findings, {budget[key]} allowed; all: --list {key[1]}")
    print(f"{len(found)} findings, {sum(budget.values())} allowed")
    return 1 if above else 0


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(usage=__doc__, add_help=False)
    parser.add_argument("root", type=Path)
    parser.add_argument("--list", nargs="?", const="")
    parser.add_argument("--write-budget", action="store_true")
    parser.add_argument("--force", action="store_true")
    options = parser.parse_args(arguments)
    return run(options.root.resolve(), options)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
