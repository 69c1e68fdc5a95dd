#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants mistakes in pages and expects each to be found."""

import pathlib
import tempfile
import unittest

import documentation

CODE = "// first\nint f() {\n  return 1;\n}\n// last\n"


class Documentation(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = pathlib.Path(self.folder.name).resolve()
        (self.root / "a.cpp").write_text(CODE)

    def tearDown(self):
        self.folder.cleanup()

    def found(self, text):
        (self.root / "page.md").write_text(text)
        return list(documentation.problems(self.root))

    def test_accepts_true_quotes_whole_and_in_part(self):
        self.assertEqual(self.found(f"<!-- quote: a.cpp -->\n```cpp\n{CODE}```\n"), [])
        part = "<!-- quote: a.cpp from: int f to: } -->\n```cpp\nint f() {\n  return 1;\n}\n```\n"
        self.assertEqual(self.found(part), [])
        inner = "<!-- quote: a.cpp from: return to: } -->\n```cpp\n  return 1;\n}\n```\n"
        self.assertEqual(self.found(inner), [])

    def test_finds_a_quote_that_differs_from_its_file(self):
        changed = CODE.replace("1", "2")
        self.assertEqual(self.found(f"x\n<!-- quote: a.cpp -->\n```cpp\n{changed}```\n"),
                         ["page.md:2: the code block differs from a.cpp"])

    def test_finds_quotes_of_what_is_not_there(self):
        block = "\n```cpp\n```\n"
        self.assertIn("no file b.cpp", self.found("<!-- quote: b.cpp -->" + block)[0])
        self.assertIn("begins with 'g'", self.found("<!-- quote: a.cpp from: g -->" + block)[0])
        self.assertIn("begins with 'g'",
                      self.found("<!-- quote: a.cpp from: int to: g -->" + block)[0])
        self.assertIn("no code block follows", self.found("<!-- quote: a.cpp -->\ntext\n")[0])

    def test_finds_links_to_missing_files_and_headings(self):
        self.assertEqual(self.found("# One two\n[a](a.cpp) [b](#one-two) [c](http://x.y/z)\n"), [])
        self.assertEqual(self.found("[a](b.cpp)\n"), ["page.md:1: there is no b.cpp"])
        self.assertEqual(self.found("# One\n[a](#two)\n"),
                         ["page.md:2: the page has no heading '#two'"])

    def test_leaves_code_alone(self):
        self.assertEqual(self.found("```\n[a](b.cpp)\n```\nand `[a](b.cpp)`\n"), [])

    def test_finds_names_that_do_not_exist(self):
        plugin = self.root / "plugins" / "filters" / "near" / "near.cpp"
        header = self.root / "framework" / "include" / "weft" / "core" / "rng.hpp"
        for file in (plugin, header):
            file.parent.mkdir(parents=True)
        plugin.write_text('WEFT_PLUGIN(Near, "filters/near");  p.read("min_matches", n);\n')
        header.write_text("int f();\n")
        self.assertEqual(self.found(
            "`filters/near` reads `min_matches` (`weft/core/rng.hpp`), tested by"
            " `filters_near_test`; `frames/NNNNNN.npz` of `plain_101`, `filters/acme.near`,"
            " `plugins/filters/near/near.cpp`, s_i as `s_i`.\n"), [])
        for name, message in (("filters/far", "there is no filters/far"),
                              ("weft/core/rgn.hpp", "there is no weft/core/rgn.hpp"),
                              ("plugins/filters/far", "there is no plugins/filters/far"),
                              ("max_matches: 3", "no source has the name max_matches"),
                              ("filters_far_test", "no source has the name filters_far_test")):
            self.assertEqual(self.found(f"see\n`{name}`\n"), [f"page.md:2: {message}"])

    def test_finds_files_and_folders_that_an_index_lacks(self):
        ablations = self.root / "pipelines" / "ablations"
        ablations.mkdir(parents=True)
        (self.root / "plugins" / "filters" / "near").mkdir(parents=True)
        for file in ("pipelines/a.yaml", "pipelines/ablations/b.yaml", "pipelines/ablations/b.csv",
                     "plugins/filters/near/near.cpp"):
            (self.root / file).write_text("weft: 1\n")
        (self.root / "pipelines" / "README.md").write_text("[a](a.yaml)\n")
        (self.root / "plugins" / "README.md").write_text("none\n")
        self.assertEqual(list(documentation.problems(self.root)), [
            "pipelines/README.md:1: does not link to pipelines/ablations/b.yaml",
            "plugins/README.md:1: does not link to plugins/filters"])


if __name__ == "__main__":
    unittest.main()
