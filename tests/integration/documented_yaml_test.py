#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What documented_yaml.py says of pages with mistakes: documented_yaml_test.py WEFT SCRIPTED_PLUGINS"""

import os
import pathlib
import sys
import tempfile
import unittest

import documented_yaml

DEMO = """weft: 1
source: {use: sources/test.scripted}
template: {use: templates/test.scripted}
stages:
  - {use: detectors/test.scripted}
  - {use: matchers/test.scripted}
  - {use: filters/test.scripted}
"""
PLAN = """weft: 1
name: plan
pipeline: ../sparse.yaml
data_use: tuning
axes: {every: {set: filters.every, values: [2, 3]}}
data: {all: {}}
"""


def fenced(text, before="", language="yaml"):
    return f"A line.\n\n{before}\n```{language}\n{text}\n```\n"


class DocumentedYaml(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def said(self, page):
        """Problems, and the numbers of blocks and of those not checked, of a page README.md."""
        root, reader = self.folder / "root", self.folder / "reader"
        (root / "pipelines/ablations").mkdir(parents=True)
        (root / "pipelines/sparse.yaml").write_text(DEMO)
        (root / "pipelines/ablations/plan.yaml").write_text(PLAN)
        (root / "README.md").write_text(page)
        reader.mkdir()
        return documented_yaml.check(WEFT, root, "", reader)

    def expect(self, page, *problems):
        said = self.said(page)[0]
        self.assertEqual(len(said), len(problems), said)
        for text, expected in zip(said, problems):
            self.assertIn(expected, text)

    def test_takes_wholes_plans_and_parts(self):
        problems, count, excused = self.said(
            fenced(DEMO) + fenced("- {use: filters/test.scripted, params: {every: 3}}") +
            fenced("  - {use: filters/test.scripted}\n  - {use: filters/test.warped, as: b}") +
            fenced("source: {params: {frames: 2}}") +
            fenced("data: {more: {}}", "<!-- over: pipelines/ablations/plan.yaml -->") +
            fenced("weft: 1\nname: mine\nextends: plan.yaml\naxes: {every: {values: [4]}}") +
            fenced("anything: [", "<!-- quote: pipelines/sparse.yaml from: weft -->") +
            fenced("- {use: filters/mine}", "<!-- not checked: your own -->") +
            fenced('{"no": 1}', language="json"))
        self.assertEqual((problems, count, excused), ([], 8, 1))

    def test_names_the_place_of_a_mistake_in_the_page(self):
        self.expect(fenced("- use: filters/test.scripted\n  params: {interval: 3}"),
                    "README.md:6:12: filters/test.scripted has no parameter 'interval'")

    def test_names_the_place_in_a_block_that_is_indented(self):
        self.expect("  ```yaml\n  weft: 1\n  extends: sparse.yaml\n  sede: 1\n  ```\n",
                    "README.md:4:3: a pipeline has no key 'sede'")

    def test_names_the_mistake_of_a_plan(self):
        self.expect(fenced("axes: {every: {set: filters.interval, values: [1]}}",
                           "<!-- over: pipelines/ablations/plan.yaml -->"), "README.md:5:")

    def test_names_the_block_that_spoils_its_base(self):
        self.expect(fenced("- {use: filters/test.scripted}") +
                    fenced("without: [matchers]") + fenced("seed: 2"),
                    "README.md:11: ", "add one that produces it")

    def test_tells_a_base_that_is_absent(self):
        self.expect(fenced("seed: 1", "<!-- over: pipelines/none.yaml -->"),
                    "README.md:3: there is no pipelines/none.yaml")

    def test_tells_a_quoted_file_that_is_wrong(self):
        self.expect(fenced("weft: 1", "<!-- quote: pipelines/none.yaml -->"), "none.yaml: there is no such file")

    def test_tells_a_component_in_a_block_of_no_language(self):
        self.expect(fenced("- {use: filters/x}", language=""), "README.md:4: is this block YAML?")

    def test_takes_no_excuse_without_a_reason(self):
        self.expect(fenced("- {use: filters/x}", "<!-- not checked: -->"), "README.md:5:")


if __name__ == "__main__":
    WEFT, os.environ["WEFT_PLUGIN_PATH"] = sys.argv[1:3]
    unittest.main(argv=sys.argv[:1])
