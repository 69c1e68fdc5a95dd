# SPDX-License-Identifier: Apache-2.0
"""Misspelt words: one edit away from the right one, and further from all others."""

from __future__ import annotations

from random import Random

LETTERS = "abcdefghijklmnopqrstuvwxyz"


def distance(a: str, b: str) -> int:
    """Insertions, deletions, replacements and swaps of neighbours that turn a into b."""
    before, last = [], list(range(len(b) + 1))
    for i, x in enumerate(a, 1):
        row = [i]
        for j, y in enumerate(b, 1):
            row.append(min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (x != y)))
            if i > 1 and j > 1 and x == b[j - 2] and a[i - 2] == y:
                row[j] = min(row[j], before[j - 2] + 1)
        before, last = last, row
    return last[-1]


def edited(rng: Random, word: str) -> str:
    place, letter = rng.randrange(1, len(word) - 1), rng.choice(LETTERS)
    return rng.choice([
        word[:place] + word[place + 1] + word[place] + word[place + 2:],  # two letters swapped
        word[:place] + word[place + 1:],
        word[:place] + word[place] + word[place:],
        word[:place] + letter + word[place + 1:],
        word[:place] + letter + word[place:],
    ])


def misspelt(rng: Random, word: str, others: list[str]) -> str:
    """A misspelling whose only near word is the right one; `others` may hold the word itself."""
    assert len(word) >= 4, word
    while True:
        wrong = edited(rng, word)
        rivals = [other for other in others if other != word]
        if wrong != word and wrong not in rivals and distance(wrong, word) == 1:
            if all(distance(wrong, rival) > 1 for rival in rivals):
                return wrong


def unlike(rng: Random) -> str:
    """A word like no other: nothing may be suggested for it."""
    return "zq" + "".join(rng.choice("xjkvw") for _ in range(6))
