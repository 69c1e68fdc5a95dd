#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes tables of methods from manifests and results that are known, and plants mistakes in them."""

import json
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import method_table  # noqa: E402

NEAR = {"version": "1.2.0", "reference": "Near, Far, Title, CVPR (2011); Other, TPAMI (2014)",
        "implements": "paper", "needs": ["correspondences"], "reads": [], "parameters": []}
FOLLOWS = {"version": "2.0.0", "reference": "Last, Title, ECCV 2015", "implements": "reconstruction",
           "needs": ["image"], "reads": ["previous.shape"],
           "parameters": [{"name": "training_seed"},
                          {"name": "start", "role": "solvers", "default": "solvers/near"}]}


class MethodTable(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name).resolve()
        for folder in ("docs/evidence", "plugins/solvers/near", "plugins/solvers/follows"):
            (self.root / folder).mkdir(parents=True)
        self.solvers = {"solvers/near": NEAR, "solvers/follows": FOLLOWS}
        self.put({"solvers_first_test": {"near": 1.5, "follows": 0.25}})
        self.page = self.root / method_table.PAGE
        self.page.write_text("# Methods\n\n<!-- methods -->\n<!-- /methods -->\nbehind\n")

    def tearDown(self):
        self.folder.cleanup()

    def put(self, figures):
        names = {name for column in figures.values() for name in column}
        words = {"settings": dict.fromkeys(names, "author's"),
                 "verified_against": dict.fromkeys(names, "paper")}
        (self.root / method_table.FIGURES).write_text(json.dumps({**figures, **words}))

    def figures(self):
        return json.loads((self.root / method_table.FIGURES).read_text())

    def found(self, write=False):
        return method_table.mistakes_of(self.root, self.solvers, write)

    def test_writes_the_methods_of_papers_first_and_is_then_content(self):
        self.assertEqual(len(self.found()), 1)
        self.assertIn("--write", self.found()[0])
        self.assertEqual(self.found(write=True), [])
        self.assertEqual(self.found(), [])
        rows = [line for line in self.page.read_text().splitlines() if line.startswith("| `")]
        self.assertEqual([row.split("`")[1] for row in rows], ["near", "follows"])
        self.assertTrue(self.page.read_text().endswith("<!-- /methods -->\nbehind\n"))

    def test_reads_the_facts_from_the_manifests(self):
        self.found(write=True)
        rows = self.page.read_text()
        self.assertIn("| `near` | Near 2011 | paper | author's | paper | matches | yes | none | none | 1.50 | - |", rows)
        self.assertIn("| `follows` | Last 2015 | reconstruction | author's | paper | texture and matches | yes, and follows | "
                      "simulated shapes | `near` | 0.25 |", rows)
        self.assertIn("[1.2.0](../plugins/solvers/near)", rows)
        self.assertEqual(method_table.baseline_of({"needs": ["previous.shape"], "reads": []}), "no")

    def test_calls_own_methods_those_of_weft_and_takes_the_year_of_the_row(self):
        self.assertEqual(method_table.author_of("near", {**NEAR, "implements": "own"}), "Weft")
        self.assertEqual(method_table.author_of("near_2017", NEAR), "Near 2017")

    def test_writes_the_most_exact_of_a_group_first(self):
        (self.root / "plugins/solvers/other").mkdir()
        self.solvers["solvers/other"] = NEAR
        self.put({"solvers_first_test": {"near": 1.5, "follows": 0.25, "other": 0.5}})
        self.found(write=True)
        rows = [line for line in self.page.read_text().splitlines() if line.startswith("| `")]
        self.assertEqual([row.split("`")[1] for row in rows], ["other", "near", "follows"])

    def test_names_a_component_with_a_reference_that_does_not_say_what_it_implements(self):
        self.assertEqual(method_table.unsaid(self.solvers), [])
        silent = {**NEAR, "implements": ""}
        mistakes = method_table.unsaid({"filters/silent": silent, "sinks/none": {**silent, "reference": ""}})
        self.assertEqual(len(mistakes), 1)
        self.assertIn("filters/silent: has a reference", mistakes[0])

    def test_names_components_without_a_row_and_rows_without_a_component(self):
        catalogue = self.root / "plugins/README.md"
        catalogue.write_text("| plugin | what |\n|---|---|\n| [solvers/near](solvers/near) | good |\n"
                             "| [solvers/gone](solvers/gone) | - |\n| [solvers](solvers) | a role |\n")
        self.assertEqual(method_table.unlisted(self.root, self.solvers),
                         ["plugins/README.md: no row begins with [solvers/follows]",
                          "plugins/README.md:4: there is no component solvers/gone"])

    def test_names_rows_that_do_not_carry_the_word(self):
        (self.root / "plugins/README.md").write_text("| [solvers/near](solvers/near) | good | |\n")
        readme = self.root / "README.md"
        readme.write_text("| [solvers/near](x) | good | paper |\n| `solvers/follows` (2015) | paper |\n"
                          "| `solvers/unknown` | - |\n| the paper's `solvers/near`, alone | 1.5 |\n")
        mistakes = method_table.unmarked(self.root, self.solvers)
        self.assertEqual([mistake.split(" lacks")[0] for mistake in mistakes],
                         ["README.md:2: the row of solvers/follows",
                          "plugins/README.md:1: the row of solvers/near"])
        self.assertIn("'reconstruction'", mistakes[0])

    def test_names_rows_without_settings_or_verification(self):
        (self.root / method_table.FIGURES).write_text(
            json.dumps({"solvers_kinect": {"near": 1.0}, "settings": {"near": "ours"}}))
        self.assertEqual([mistake for mistake in self.found(write=True) if "says nothing" in mistake],
                         ["docs/evidence/methods.json: 'verified_against' says nothing of near"])

    def test_notices_a_manifest_that_changed(self):
        self.found(write=True)
        self.solvers["solvers/near"] = {**NEAR, "version": "1.3.0"}
        self.assertIn("out of date", self.found()[0])

    def test_names_figures_of_a_solver_that_is_not_there(self):
        self.put({"solvers_kinect": {"gone": 2.0, "chhatkuli_2014": 1.0}})
        mistakes = self.found(write=True)
        self.assertEqual(len(mistakes), 2)
        self.assertIn("there is no solver chhatkuli_2014", mistakes[0])
        self.assertIn("there is no solver gone", mistakes[1])

    def test_names_a_page_without_a_place_for_the_table(self):
        self.page.write_text("<!-- methods -->\n")
        self.assertIn("are missing", self.found(write=True)[0])

    def results(self, file, lines, plan="solvers_kinect"):
        folder = self.root / "run"
        (folder / "results").mkdir(parents=True)
        cells = [{"axes": {"solver": line["solver"]}, "key": line["key"]} for line in lines]
        (folder / "plan.json").write_text(json.dumps({"name": plan, "cells": cells}))
        (folder / "results" / file).write_text("".join(json.dumps(line) + "\n" for line in lines))
        return str(folder)

    def test_measures_means_over_the_cells_that_are_done(self):
        def line(key, solver, mean_mm, outcome="done"):
            return {"key": key, "solver": solver, "outcome": outcome,
                    "metrics": {"all": {"error_solved": {"mean_mm": mean_mm}}}}

        folder = self.results("cached-000001.jsonl", [
            line("a", "near", 1.0), line("b", "near", 2.0), line("c", "near", 90.0, "failed"),
            line("d", "follows", None), line("e", "two_of_them", 3.0)])
        self.assertEqual(method_table.measure(self.root, [folder]), [])
        self.assertEqual(self.figures()["solvers_kinect"], {"near": 1.5})
        self.assertEqual(self.figures()["solvers_first_test"], {"near": 1.5, "follows": 0.25})

    def test_measures_the_processor_time_of_warp_pass_and_solver(self):
        stages = [{"stage": stage, "mean_processor_ms": ms}
                  for stage, ms in (("detectors", 40.0), ("warps", 1.0), ("solvers", 3.0))]
        folder = self.results("alone-000001.jsonl", [
            {"key": "a", "solver": "near", "outcome": "done", "timing": {"stages": stages}}])
        self.assertEqual(method_table.measure(self.root, [folder]), [])
        self.assertEqual(self.figures()["solvers_times"], {"near": 4.0})

    def test_names_results_of_a_plan_without_a_column(self):
        folder = self.results("cached-000001.jsonl", [], plan="solvers_noise")
        self.assertIn("solvers_noise has no column", method_table.measure(self.root, [folder])[0])


if __name__ == "__main__":
    unittest.main()
