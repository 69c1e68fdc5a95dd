# SPDX-License-Identifier: Apache-2.0
"""Planted mistakes: what they are, where they must be reported, and mistakes of any YAML file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from random import Random

from documents import List, Map, Node, Text, tree
from words import misspelt, unlike


@dataclass
class Planted:
    """A mistake of a tree. `node` is where it must be reported, `shift` characters further.

    `suggestion` is the word that must be suggested; "" where none may be, None where it is free.
    """

    kind: str
    node: Node
    suggestion: str | None = None
    shift: int = 0
    alone: bool = False  # a syntax error, which hides all others

    @property
    def at(self) -> tuple[int, int]:
        return self.node.at[0], self.node.at[1] + self.shift


Planter = Callable[[Random, Map], Planted | None]


def rename_key(rng: Random, kind: str, place: Map, key: str, known: list[str]) -> Planted:
    """Misspells a key that is there."""
    name = place.key(key)
    name.value = misspelt(rng, key, known)
    return Planted(kind, name, key)


def unknown_key(rng: Random, kind: str, place: Map) -> Planted:
    return Planted(kind, place.put(unlike(rng), 1), "")


def duplicate_key(rng: Random, kind: str, place: Map) -> Planted:
    """Gives an entry a second time, which is the one to be reported."""
    key, value = rng.choice(place.entries)
    second = Text(key.value)
    place.entries.append((second, tree(value.value) if isinstance(value, Text) else value))
    if isinstance(value, Text):
        place.entries[-1] = (second, Text(value.value, value.raw))
    return Planted(kind, second)


def put_value(place: Map, key: str, value: Node) -> Node:
    """Sets or adds an entry and gives its value."""
    for index, (name, _) in enumerate(place.entries):
        if name.value == key:
            place.entries[index] = (name, value)
            return value
    place.put(key, value)
    return value


# Syntax errors: a raw scalar, and the index of the character at which the reader must stop.
SYNTAX = {
    "control character": ('"ab\x01c"', 3),
    "DEL": ('"a\x7fb"', 2),
    "NUL": ('"a\0b"', 2),
    "no UTF-8": ('"ab\udcff"', 3),
    "cut UTF-8": ('"\udce2\udc82"', 1),
    "unknown alias": ("*nowhere", 0),
    "unknown tag": ("!sheet x", 0),
    "unknown escape": ('"ab\\q"', 5),
}


def syntax(rng: Random, root: Map) -> Planted:
    """A value at the root that is no YAML."""
    kind, (raw, shift) = rng.choice(sorted(SYNTAX.items()))
    key = "seed" if root.find("seed") is not None else root.entries[-1][0].value
    return Planted(kind, put_value(root, key, Text("", raw)), None, shift, True)


def deep(rng: Random, root: Map) -> Planted:
    levels = rng.choice([101, 500, 9000])
    node = put_value(root, root.entries[-1][0].value, Text("", "[" * levels + "]" * levels))
    return Planted("nested too deep", node, None, 99, True)


CONTROL = ["\\x01", "\\x1b[31m", "\\x07", "\\x7f", "\\0", "\\u0085", "\\n", "\\r"]


def with_control(rng: Random, word: str, nul: bool = True) -> Text:
    """The word in quotes with a control character written as an escape, which is legal YAML.

    NUL is a mistake at its own place, whatever it stands in.
    """
    place = rng.randrange(1, len(word))
    character = rng.choice([one for one in CONTROL if nul or one != "\\0"])
    return Text("", '"' + word[:place] + character + word[place:] + '"')


def wrong_type(rng: Random, kind: str) -> tuple[Node, int]:
    """A value of another kind than the parameter's; and the index of the item to blame, or -1."""
    wrong: list[Node] = [tree({"a": 1})]
    if kind in ("whole", "number"):
        wrong += [Text("many"), Text("", '"3"'), Text("3 px"), tree([1]), Text("", "true")]
        wrong += [Text("1e999"), Text(".nan"), Text("-.inf"), Text("0x"), Text("3;5")]
    if kind == "whole":
        wrong += [Text("2.5"), Text("99999999999999999999"), Text("1e3")]
    if kind == "flag":
        wrong += [Text("yes"), Text("1"), Text("", '"true"'), tree([])]
    if kind == "list":
        wrong += [Text("3"), Text("x"), tree([0, "x"]), tree([[1]])]
    if kind in ("choice", "text", "path"):
        wrong += [tree([1])]
    value = rng.choice(wrong)
    blamed = isinstance(value, List) and kind == "list"
    return value, len(value.items) - 1 if blamed else -1
