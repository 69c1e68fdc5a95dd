# SPDX-License-Identifier: Apache-2.0
"""YAML documents as trees that are written in a random style and know where each value landed.

A tree is made of Text (a scalar), Map and List. write() gives the text and sets `at`, the
(line, column) at which Weft must report a mistake of that node: the first character of a scalar
or of [ ] and { }, the first key of a map and the first dash of a list in lines of their own.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

PLAIN_FIRST = set("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ/_")
PLAIN = PLAIN_FIRST | set("0123456789.@+-*# ")


@dataclass
class Text:
    """A scalar; `raw` is written as it stands, quotes and all."""

    value: str
    raw: str | None = None
    at: tuple[int, int] = (0, 0)

    def is_word(self) -> bool:
        """Whether quotes would change nothing: a text that is no number, boolean or null."""
        word = self.raw is None and self.value and self.value[0] in PLAIN_FIRST
        return bool(word) and self.value not in ("true", "false", "null")


@dataclass
class Map:
    entries: list[tuple[Text, Node]] = field(default_factory=list)
    at: tuple[int, int] = (0, 0)

    def find(self, key: str) -> Node | None:
        return next((value for name, value in self.entries if name.value == key), None)

    def key(self, key: str) -> Text:
        return next(name for name, _ in self.entries if name.value == key)

    def put(self, key: str, value: object) -> Text:
        """Adds an entry at the end and gives its key."""
        name = Text(key)
        self.entries.append((name, tree(value)))
        return name


@dataclass
class List:
    items: list[Node] = field(default_factory=list)
    at: tuple[int, int] = (0, 0)


Node = Text | Map | List


def tree(value: object) -> Node:
    """A tree of Python's dict, list, bool, number and str."""
    if isinstance(value, (Text, Map, List)):
        return value
    if isinstance(value, dict):
        return Map([(Text(str(key)), tree(item)) for key, item in value.items()])
    if isinstance(value, list):
        return List([tree(item) for item in value])
    if isinstance(value, bool):
        return Text("true" if value else "false")
    return Text(repr(value) if isinstance(value, float) else str(value))


@dataclass
class Style:
    """How a document is written: the shares of values in brackets, quoted words and comments."""

    rng: Random | None = None
    indent: int = 2
    flow: float = 0.0
    quotes: float = 0.0
    comments: float = 0.0
    line_end: str = "\n"

    @staticmethod
    def random(rng: Random) -> Style:
        line_end = "\r\n" if rng.random() < 0.1 else "\n"
        return Style(rng, rng.choice([2, 2, 3, 4]), rng.random(), 0.3 * rng.random(),
                     0.3 * rng.random(), line_end)

    def draws(self, share: float) -> bool:
        return self.rng is not None and self.rng.random() < share


class Writer:
    """Appends characters and counts lines and columns from 1."""

    def __init__(self, style: Style) -> None:
        self.style, self.parts, self.line, self.column = style, [], 1, 1

    def add(self, text: str) -> None:
        self.parts.append(text)
        self.column += len(text)

    def end_line(self) -> None:
        if self.style.draws(self.style.comments):
            self.parts.append("   # 'a: [comment' {")
        self.parts.append(self.style.line_end)
        self.line, self.column = self.line + 1, 1
        if self.style.draws(self.style.comments / 2):
            self.parts.append("# {" + self.style.line_end)
            self.line += 1

    def scalar(self, node: Text) -> None:
        node.at = (self.line, self.column)
        quote = self.style.draws(self.style.quotes) and node.is_word()
        text = '"' + node.value + '"' if quote else plain(node.value)
        self.add(text if node.raw is None else node.raw)

    def flow(self, node: Node) -> None:
        if isinstance(node, Text):
            return self.scalar(node)
        node.at = (self.line, self.column)
        self.add("[" if isinstance(node, List) else "{")
        for index, child in enumerate(children_of(node)):
            self.add(", " if index else "")
            if isinstance(node, Map):
                self.scalar(child[0])
                self.add(": ")
                child = child[1]
            self.flow(child)
        self.add("]" if isinstance(node, List) else "}")

    def value(self, node: Node, depth: int, behind_dash: bool) -> None:
        """What follows a key or a dash, to the end of its last line."""
        if isinstance(node, Text) or not children_of(node) or self.style.draws(self.style.flow):
            self.add(" ")
            self.flow(node)
            return self.end_line()
        if behind_dash and isinstance(node, Map):
            self.add(" " * (self.style.indent - 1))
            return self.block(node, depth + self.style.indent, True)
        self.end_line()
        self.block(node, depth + self.style.indent, False)

    def block(self, node: Map | List, depth: int, begun: bool) -> None:
        for index, child in enumerate(children_of(node)):
            if index or not begun:
                self.add(" " * depth)
            if index == 0:
                node.at = (self.line, self.column)
            if isinstance(node, List):
                self.add("-")
                self.value(child, depth, True)
            else:
                self.scalar(child[0])
                self.add(":")
                self.value(child[1], depth, False)


def plain(value: str) -> str:
    """The value without quotes where YAML allows that, else in single quotes."""
    legal = value and all(c in PLAIN for c in value) and value[0] != "#" and " #" not in value
    number = value and value[0] in "0123456789-+."
    return value if legal or number else "'" + value.replace("'", "''") + "'"


def write(root: Map, style: Style | None = None, json: bool = False) -> str:
    """The text of the document, in JSON where asked; every node of it then knows its place."""
    writer = Writer(style or Style())
    if json:
        writer.style = Style(Random(0), quotes=2.0)
        writer.flow(root)
        writer.end_line()
    else:
        writer.block(root, 0, False)
    return "".join(writer.parts)


def children_of(node: Map | List) -> list:
    return node.items if isinstance(node, List) else node.entries


def nodes(node: Node):
    """The node and all below it."""
    yield node
    children = node.items if isinstance(node, List) else []
    if isinstance(node, Map):
        children = [value for _, value in node.entries]
    for child in children:
        yield from nodes(child)
