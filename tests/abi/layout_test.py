#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests which changes of the contract layout.py accepts, and the sizes of first_sizes.hpp."""

import re
import unittest
from pathlib import Path

from layout import differences, entries

HERE = Path(__file__).resolve().parent
KEPT = ["struct weft_output 16", "member weft_output.struct_size 0 4 uint32_t struct_size",
        "member weft_output.slot 8 8 const char* slot", "struct weft_value 8",
        "member weft_value.name 0 8 const char* name", "value weft_dtype.WEFT_U8 1",
        "macro WEFT_ABI_MINOR 0", "macro WEFT_SINK_OPEN 0", "record time/1",
        "array time/1.t_s f64 [] required unit s"]


def replaced(old: str, *new: str) -> list[str]:
    at = KEPT.index(old)
    return [*KEPT[:at], *new, *KEPT[at + 1:]]


class Differences(unittest.TestCase):
    def expect(self, lines: list[str], *words: str) -> None:
        found = differences(KEPT, lines)
        self.assertEqual(len(found), len(words), found)
        for text, word in zip(found, words):
            self.assertIn(word, text)

    def test_a_minor_version_may_add_at_the_end(self) -> None:
        self.expect(KEPT)
        self.expect([*replaced("struct weft_output 16", "struct weft_output 24"),
                     "member weft_output.more 16 8 uint64_t more", "value weft_dtype.WEFT_NEW 2",
                     "macro WEFT_NEW 7", "array time/1.offset_s f64 [] optional unit s",
                     "record depth/1", "array depth/1.depth_m f32 [H,W] required unit m"])
        self.expect(replaced("macro WEFT_ABI_MINOR 0", "macro WEFT_ABI_MINOR 1"))

    def test_what_is_kept_stays(self) -> None:
        for line in KEPT[:-2]:
            with self.subTest(line):
                self.expect(replaced(line), "is missing")
        self.expect(replaced(KEPT[-1], "array time/1.t_s f32 [] required unit s"), "it was 'f64")
        self.expect(replaced(KEPT[-1], "array time/1.t_s f64 [] optional unit s"), "it was 'f64")
        self.expect(replaced("macro WEFT_SINK_OPEN 0", "macro WEFT_SINK_OPEN 1"), "SINK_OPEN is '1'")
        self.expect(replaced("struct weft_value 8", "struct weft_value 16"), "weft_value is '16'")
        self.expect(replaced(KEPT[2], "member weft_output.slot 8 8 void* slot"), "is '8 8 void*")

    def test_an_addition_does_not_disturb_what_is_kept(self) -> None:
        self.expect([*KEPT, "array time/1.zone u8 [*] required"], "required in a kept record")
        self.expect([*KEPT, "member weft_output.gap 4 4 int32_t gap"], "not behind the members")
        self.expect([*KEPT, "value weft_dtype.WEFT_NEW 1"], "has the number of")
        self.expect([*KEPT[:-3], KEPT[-1], KEPT[-2], KEPT[-3]], "another order")


class FirstSizes(unittest.TestCase):
    def test_hosts_accept_the_sizes_of_version_1_0(self) -> None:
        header = HERE.parents[1] / "framework/host/guarding/first_sizes.hpp"
        kept = entries((HERE / "kept/1.0/layout.txt").read_text().splitlines())
        sizes = re.findall(r"kFirstSize<(\w+)> = (\d+);", header.read_text())
        growing = {key.split()[1].split(".")[0] for key in kept if key.endswith(".struct_size")}
        made_by_host = {"weft_call", "weft_create", "weft_describe", "weft_error", "weft_host"}
        self.assertEqual({name for name, _ in sizes}, growing - made_by_host)
        for name, size in sizes:
            with self.subTest(name):
                self.assertEqual(kept[f"struct {name}"], size)


if __name__ == "__main__":
    unittest.main()
