#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants a finding of each kind in a small tree and expects it to be reported."""

import contextlib
import io
import json
import tempfile
import unittest
from pathlib import Path

import prose

PAGE = """# What a filter is

A filter rejects matches. It reads `what nobody knows` and writes a report; e.g. Smith et al. use it.
By default, the run stops. What is a match?

```sh
weft run  # nobody asks, says the mistake
```

<!-- parameters -->

| name | meaning |
|---|---|
| `a` | of which nobody knows |

<!-- /parameters -->

| file | contents |
|---|---|
| `a.csv` | one row per frame |
"""
SOURCE = """// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Rejects matches whose residual exceeds the threshold.
struct Filter {
  int size;   ///< number of matches
  int count;  ///< number of frames

  explicit Filter(Params& p) {
    p.read("size", size, "px", {0, 100}, "size of the window; 0: no limit");
    p.read("rotate", rotate, "rotation of the window");
    p.choice("mode", mode, {{"a", Mode::a}}, "computation of "
             "the distance");
    if (x == '"') fail("the size exceeds the limit");  // see the paper's section 2
  }
};
"""
LONG = "One two three four five six seven eight nine ten " * 3 + "and the end."
TREE = {"docs/page.md": PAGE, "plugins/filters/near/near.hpp": SOURCE,
        "CHANGELOG.md": "Nobody knows who asks.\n"}


class Prose(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name).resolve()
        for name, text in TREE.items():
            self.write(name, text)
        self.write(prose.BUDGET, "{}\n")

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def run_prose(self, *arguments: str) -> tuple[int, list[str]]:
        """The exit status and the printed lines."""
        out = io.StringIO()
        with contextlib.redirect_stdout(out):
            status = prose.main([str(self.root), *arguments])
        return status, out.getvalue().splitlines()

    def test_clean_text_passes(self) -> None:
        self.assertEqual(self.run_prose(), (0, ["0 findings, 0 allowed"]))

    def test_finds_each_kind(self) -> None:
        page, source = "docs/page.md", "plugins/filters/near/near.hpp"
        for path, old, new, expected in [
            (page, "A filter rejects", "Nobody\nknows. A filter", ["page term: 'Nobody'", "4: page term: 'knows'"]),
            (page, "one row per frame", "the frames of which none failed", ["page term: 'of which'"]),
            (page, "writes a report", "is of\nno use", ["3: page term: 'is of': belongs to"]),
            (page, "# What a", "# Mistakes of a", ["1: page term: 'Mistakes': error"]),
            (page, "A filter rejects", f"{LONG} A filter rejects", ["page length: a sentence of 33 words"]),
            (page, "A filter rejects matches", "What matters is this", ["page start: begins with 'What'"]),
            (page, "the run stops.", "the run stops. So it ends.", ["4: page start: begins with 'So'"]),
            (page, "| one row", "| Of each run one row", ["page start: begins with 'Of'"]),
            (source, "/// Rejects", "/// Who\n/// rejects", ["comment start: begins with 'Who'",
                                                            "4: comment term: 'Who': name the component"]),
            (source, "whose residual", "laid\n/// over", ["4: comment term: 'laid over': merged, overrides"]),
            (source, "number of frames", "of all frames", ["7: comment start: begins with 'of'"]),
            (source, "Rejects matches", LONG, ["comment length: a sentence of"]),
            (source, "see the", "told by the", ["14: comment term: 'told'"]),
            (source, "size of the window", "of the window", ["10: help form: 'of the window"]),
            (source, "rotation of", "turn", ["11: help form: 'turn"]),
            (source, "the distance", "the distance.", ["help form: 'computation of the distance.'"]),
            (source, "computation of ", "print of a picture, ", ["help term: 'picture': image"]),
            (source, "the size exceeds", "a mistake: exceeds", ["14: message term: 'mistake': error"]),
        ]:
            with self.subTest(new):
                self.write(path, TREE[path].replace(old, new, 1))
                status, lines = self.run_prose()
                self.assertEqual(status, 1)
                for each in expected:
                    self.assertTrue(any(each in line and line.startswith(path + ":") for line in lines),
                                    "\n".join(lines))
                self.write(path, TREE[path])

    def test_keeps_a_budget(self) -> None:
        self.write("docs/page.md", PAGE + "\nNobody asks.\n")
        status, lines = self.run_prose("--write-budget")
        self.assertEqual((status, lines[-2]), (1, "page term: docs: 2 findings, 0 allowed; all: --list docs"))
        self.assertEqual(json.loads((self.root / prose.BUDGET).read_text()), {})
        self.assertEqual(self.run_prose("--write-budget", "--force")[0], 0)
        self.assertEqual(json.loads((self.root / prose.BUDGET).read_text()), {"page term": {"docs": 2}})
        self.assertEqual(self.run_prose()[0], 0)
        self.write("docs/page.md", PAGE + "\nNobody calls.\n")
        self.assertEqual(self.run_prose(), (0, [
            "page term: docs: lower the budget to 1 (--write-budget)", "1 findings, 2 allowed"]))
        self.run_prose("--write-budget")
        self.assertEqual(json.loads((self.root / prose.BUDGET).read_text()), {"page term": {"docs": 1}})

    def test_lists_findings(self) -> None:
        self.write("docs/page.md", PAGE + "\nNobody asks.\n")
        status, lines = self.run_prose("--list", "docs/")
        self.assertEqual((status, len(lines), lines[-1]), (0, 3, "page term: 2"))
        self.assertEqual(self.run_prose("--list", "plugins"), (0, [""]))


if __name__ == "__main__":
    unittest.main()
