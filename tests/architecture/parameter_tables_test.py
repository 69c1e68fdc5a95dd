#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants mistakes in pages and their parameter tables and expects each to be named."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import parameter_tables  # noqa: E402

THETA = {"name": "theta", "type": "f64", "list": False, "required": False, "default": 0.75,
         "unit": "px", "range": [0.0, 1.0], "help": "kept if |d| is below"}
TABLE = ["", "| parameter | meaning | type and range | default |", "|---|---|---|---|",
         r"| `theta` | kept if \|d\| is below | number, px, 0 to 1 | 0.75 |", ""]
PAGE = "plugins/filters/near/README.md"


def page(*lines: str) -> str:
    return "\n".join(["# filters/near", "<!-- parameters -->", *lines, "<!-- /parameters -->", ""])


class ParameterTables(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name).resolve()
        (self.root / PAGE).parent.mkdir(parents=True)
        near = parameter_tables.Component(PAGE, parameter_tables.table_of([THETA]))
        self.components = {"filters/near": near}

    def tearDown(self):
        self.folder.cleanup()

    def found(self, text, write=False):
        (self.root / PAGE).write_text(text)
        return list(parameter_tables.mistakes_of(self.root, self.components, write))

    def test_accepts_a_table_that_is_up_to_date(self):
        self.assertEqual(self.found(page(*TABLE)), [])

    def test_names_the_page_of_an_outdated_table_and_the_fix(self):
        mistakes = self.found(page(*TABLE[:-2], "| `theta` | kept | number | 0.5 |", ""))
        self.assertEqual(len(mistakes), 1)
        self.assertIn(f"{PAGE}:2: the table of filters/near is out of date", mistakes[0])
        self.assertIn("--write", mistakes[0])

    def test_writes_tables_anew_and_nothing_else(self):
        self.assertEqual(self.found(page("old") + "behind\n", write=True), [])
        self.assertEqual((self.root / PAGE).read_text(), page(*TABLE) + "behind\n")

    def test_names_a_component_without_a_table(self):
        mistakes = self.found("# filters/near\n")
        self.assertEqual(len(mistakes), 1)
        self.assertIn(f"{PAGE}: no table of filters/near", mistakes[0])

    def test_asks_for_the_table_of_each_component_of_a_library(self):
        self.components["matchers/near"] = parameter_tables.Component(
            PAGE, parameter_tables.table_of([]))
        self.assertIn("no table of matchers/near", self.found(page(*TABLE))[0])
        second = "<!-- parameters: matchers/near -->\n\nIt has no parameters.\n\n<!-- /parameters -->\n"
        self.assertEqual(self.found(page(*TABLE) + second), [])

    def test_leaves_out_what_another_component_has_too(self):
        other = {**THETA, "name": "beta"}
        self.components["matchers/near"] = parameter_tables.Component(
            PAGE, parameter_tables.table_of([THETA, {**other, "default": 0.5}]))
        self.components["filters/near"] = parameter_tables.Component(
            PAGE, parameter_tables.table_of([THETA, other]))
        begin = "<!-- parameters: matchers/near besides filters/near -->\n"
        self.found("<!-- parameters -->\n<!-- /parameters -->\n" + begin + "<!-- /parameters -->\n", write=True)
        written = (self.root / PAGE).read_text().split(begin)[1]
        self.assertEqual(written.count("`theta`"), 0)
        self.assertIn("| `beta` | kept if \\|d\\| is below | number, px, 0 to 1 | 0.5 |", written)
        self.assertIn("\nBesides, those of `filters/near` but `beta`.\n", written)
        self.assertEqual(self.found((self.root / PAGE).read_text()), [])

    def test_names_components_that_do_not_exist(self):
        far = "<!-- parameters: filters/far -->\n<!-- /parameters -->\n"
        self.assertEqual(self.found(page(*TABLE) + far),
                         [f"{PAGE}:9: there is no component filters/far"])

    def test_names_a_table_without_an_end(self):
        mistakes = self.found("<!-- parameters -->\n", write=True)
        self.assertIn(f"{PAGE}:1: no line <!-- /parameters --> follows", mistakes)
        self.assertEqual((self.root / PAGE).read_text(), "<!-- parameters -->\n")

    def test_names_a_page_that_is_missing(self):
        far = parameter_tables.Component("plugins/filters/far/README.md", [])
        self.components["filters/far"] = far
        self.assertEqual(self.found(page(*TABLE)),
                         ["plugins/filters/far/README.md: there is no such page, and filters/far needs one"])

    def test_looks_at_a_page_of_a_plugin_that_lives_elsewhere(self):
        file = self.root / "README.md"
        file.write_text(page("old").replace("<!-- parameters -->", "<!-- parameters: filters/near -->"))
        mistakes = list(parameter_tables.mistakes_of_page(file, self.components, False))
        self.assertEqual(len(mistakes), 1)
        self.assertIn(f"{file}:2: the table of filters/near is out of date", mistakes[0])
        self.assertEqual(list(parameter_tables.mistakes_of_page(file, self.components, True)), [])
        self.assertIn("\n".join(TABLE), file.read_text())
        file.write_text("# filters/near\n")
        self.assertIn(f"{file}: no table of a component",
                      list(parameter_tables.mistakes_of_page(file, self.components, False))[0])

    def test_knows_the_page_of_a_library_and_says_types_in_words(self):
        self.assertEqual(parameter_tables.page_of("/lib/detectors_sift_gpu.so"),
                         "plugins/detectors/sift_gpu/README.md")
        for parameter, words in (({"type": "bool"}, "true or false"),
                                 ({"type": "choice", "choices": ["a", "b"]}, "`a`, `b`"),
                                 ({"type": "component", "role": "warps"}, "component of `warps`"),
                                 ({"type": "i64", "list": True, "range": [0.0, 1e6]},
                                  "list of whole numbers, 0 to 1000000")):
            self.assertEqual(parameter_tables.type_of({"list": False, **parameter}), words)
        for value, words in ((0.00002, "2e-05"), (True, "true"), ("", "none"), ([20, 0.5], "[20, 0.5]"),
                             (9007199254740992, "9007199254740992"), ("warps/bbs", "`warps/bbs`")):
            self.assertEqual(parameter_tables.value_of(value), words)


if __name__ == "__main__":
    unittest.main()
