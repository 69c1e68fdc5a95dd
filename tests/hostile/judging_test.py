#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Gives the judge answers that are right and wrong, and expects the wrong ones to be noticed."""

import sys
import tempfile
import unittest
from pathlib import Path
from random import Random

import bases
from documents import Style, Text, nodes, plain, write
from judging import Expected, Mutant, Rates, Verdict, judge
from live_requests import answer_in
from live_soak import growth_of
from program import Answer
from words import distance, misspelt


class Fake:
    """A program that always answers the same."""

    def __init__(self, code: int, err: str = "", out: str = "") -> None:
        self.answer = Answer(["weft"], code, out, err, 1.0)

    def ask(self, folder: Path, *arguments: str) -> Answer:
        return self.answer


def verdict_of(expected: list[Expected], fake: Fake) -> Verdict:
    mutant = Mutant("pipeline", {"p.yaml": b"x"}, ["check", "p.yaml"], expected)
    with tempfile.TemporaryDirectory() as folder:
        return judge(mutant, fake, Path(folder))[0]


TYPO = Expected("typo", "p.yaml", 2, 5, "seed")
RANGE = Expected("range", "p.yaml", 4, 9)
TYPO_LINE = "p.yaml:2:5: no key 'sede'; did you mean 'seed'?\n"


class Judging(unittest.TestCase):
    def test_finds_nothing_wrong_with_a_right_answer(self) -> None:
        right = verdict_of([TYPO, RANGE], Fake(2, TYPO_LINE + "p.yaml:4:9: is 7\n"))
        self.assertEqual(right.faults, [])
        self.assertTrue(Rates([right]).met())

    def test_notices_another_place_a_missing_mistake_and_a_follow_up(self) -> None:
        for err in ("p.yaml:2:6: did you mean 'seed'?\n", "",
                    TYPO_LINE + "p.yaml:9:1: something else\n"):
            wrong = verdict_of([TYPO], Fake(2, err))
            self.assertFalse(wrong.complete, err)
            self.assertFalse(Rates([wrong]).met(), err)

    def test_notices_a_wrong_suggestion(self) -> None:
        wrong = verdict_of([TYPO], Fake(2, "p.yaml:2:5: did you mean 'sinks'?\n"))
        self.assertEqual((wrong.suggestions, wrong.right_suggestions), (1, 0))

    def test_notices_what_is_accepted_or_refused_in_error(self) -> None:
        self.assertFalse(verdict_of([TYPO], Fake(0)).answered)
        self.assertFalse(verdict_of([], Fake(2, TYPO_LINE)).answered)
        self.assertTrue(verdict_of([], Fake(0)).answered)

    def test_notices_crashes_raw_text_and_control_characters(self) -> None:
        for fake in (Fake(-11, TYPO_LINE), Fake(2, TYPO_LINE + "what(): std::bad_alloc"),
                     Fake(2, TYPO_LINE + "\x1b[31m"), Fake(2, TYPO_LINE + "\u0085")):
            self.assertFalse(verdict_of([TYPO], fake).answered)


class Documents(unittest.TestCase):
    def test_know_the_place_of_each_value(self) -> None:
        for seed in range(50):
            rng = Random(seed)
            root = bases.pipeline(rng)
            lines = write(root, Style.random(rng)).split("\n")
            for node in nodes(root):
                if isinstance(node, Text):
                    rest = lines[node.at[0] - 1][node.at[1] - 1:]
                    spelt = (plain(node.value), f'"{node.value}"')
                    self.assertTrue(rest.startswith(spelt), f"seed {seed}: {node}: {rest}")


class Words(unittest.TestCase):
    def test_are_nearest_to_the_right_one(self) -> None:
        for seed in range(200):
            wrong = misspelt(Random(seed), "stages", bases.ROOT_KEYS)
            near = min(bases.ROOT_KEYS, key=lambda key: distance(wrong, key))
            self.assertEqual(near, "stages", f"seed {seed}: {wrong}")


class JudgingTheLiveView(unittest.TestCase):
    OPEN = b"HTTP/1.1 101 Switching Protocols\r\n\r\n"

    def test_reads_statuses_and_codes(self) -> None:
        self.assertEqual(answer_in(b""), 0)
        self.assertEqual(answer_in(b"HTTP/1.1 403 Forbidden\r\n\r\nno"), 403)
        self.assertEqual(answer_in(self.OPEN + b"\x81\x02{}\x88\x02\x03\xea"), 1002)
        self.assertEqual(answer_in(self.OPEN + b"\x82\x7e\x01\x00" + b"x" * 256), 0)
        self.assertEqual(answer_in(self.OPEN + b"\x82\x7e\x01\x00" + b"cut off"), 0)

    def test_notices_what_is_no_answer(self) -> None:
        close = b"\x88\x02\x03\xea"
        for wrong in [b"hello", b"HTTP/1.1 999 ?\r\n\r\n", self.OPEN + b"\x83\x00",
                      self.OPEN + b"\x81\x82abcd{}", self.OPEN + close + close]:
            with self.assertRaises(ValueError):
                answer_in(wrong)

    def test_notices_memory_that_grows(self) -> None:
        self.assertEqual(growth_of([900, 100, 100, 100, 100, 100, 900, 100, 100]), 0)
        self.assertEqual(growth_of([100 + 10 * i for i in range(9)]), 60)


if __name__ == "__main__":
    sys.exit(unittest.main())
