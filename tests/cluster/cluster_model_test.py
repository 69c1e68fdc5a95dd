#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The model of a cluster in cases that can be worked out by hand, and what it says of folders."""

import contextlib
import io
import json
import os
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import cluster_model  # noqa: E402
from cluster_model import Costs, drawn_tasks, simulate  # noqa: E402

FREE = Costs(*[0.0] * len(Costs._fields))


class ClusterModel(unittest.TestCase):
    def test_wastes_nothing_where_nothing_costs_anything(self):
        outcome = simulate(FREE, [[2.0, 3.0]] * 8, workers=4)
        self.assertAlmostEqual(outcome.seconds, 10.0)
        self.assertAlmostEqual(outcome.efficiency, 1.0)

    def test_adds_up_what_one_worker_does(self):
        costs = FREE._replace(controller_s=0.1, launch_s=0.4, start_s=0.5, claim_s=0.01, keep_s=0.02,
                              read_s=0.001, folder_read_s=0.003)
        # Two tasks of three cells: of 0, 3, 3 and 6 results each reading takes 4 ms.
        outcome = simulate(costs, [[1.0] * 3] * 2, workers=1)
        self.assertAlmostEqual(outcome.seconds, 2 * (1.0 + 3 * 1.03) + 0.004 * (0 + 3 + 3 + 6))

    def test_waits_for_the_last_task(self):
        self.assertAlmostEqual(simulate(FREE, [[1.0], [1.0], [1.0]], workers=2).efficiency, 0.75)

    def test_finds_the_shared_folder_at_its_limit(self):
        outcome = simulate(FREE._replace(keep_s=0.1), [[0.1] * 40] * 64, workers=64)
        self.assertAlmostEqual(outcome.seconds, 64 * 40 * 0.1, delta=1.0)
        self.assertGreater(outcome.busy["folder"], 0.99)

    def test_finds_the_controller_at_its_limit(self):
        outcome = simulate(FREE._replace(controller_s=1.0), [[2.0]] * 100, workers=50)
        self.assertAlmostEqual(outcome.seconds, 100 + 2.0)
        self.assertGreater(outcome.busy["slurm"], 0.97)

    def test_keeps_the_work_of_tasks_of_many_cells_in_few_steps(self):
        tasks = [[0.1] * 999] * 4
        outcome = simulate(FREE._replace(keep_s=0.001), tasks, workers=1)
        self.assertAlmostEqual(outcome.seconds, 4 * 999 * 0.101)

    def test_draws_cells_of_the_wanted_mean(self):
        print(f"seed {cluster_model.SEED}")
        for cell_s in (0.1, 60.0):
            tasks = drawn_tasks(cell_s, minutes=10.0, count=2000, spread=0.5)
            cells = [cell for task in tasks for cell in task]
            self.assertAlmostEqual(sum(cells) / len(cells), cell_s, delta=0.02 * cell_s)
            self.assertAlmostEqual(len(tasks[0]) * cell_s, 600.0)

    def test_measures_a_folder_and_leaves_nothing_there(self):
        with tempfile.TemporaryDirectory() as folder:
            costs = cluster_model.measured(Path(folder), FREE, cells=3)
            self.assertEqual(os.listdir(folder), [])
        self.assertGreater(costs.claim_s, 0.0)
        self.assertGreater(costs.keep_s, costs.claim_s)


class Check(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.results = Path(folder.name)

    def submission(self, seconds):
        """Two tasks of two cells, of which the last report came so many seconds after the order."""
        folder = self.results / "slurm/000001"
        folder.mkdir(parents=True)
        (folder / "order.json").write_text(json.dumps({"tasks": [[["a", "b"]], [["c"], ["d"]]]}))
        (self.results / "results").mkdir()
        lines = [json.dumps({"key": key, "machine": {"seconds": 5.0}}) for key in "abcd"]
        (self.results / "results/cached-1_0-000001.jsonl").write_text("\n".join(lines) + "\n")
        os.utime(folder / "order.json", (1000, 1000))
        for task, at in enumerate(seconds):
            (folder / f"task_{task}.json").write_text("{}")
            os.utime(folder / f"task_{task}.json", (1000 + at, 1000 + at))

    def check(self):
        with contextlib.redirect_stdout(io.StringIO()) as out, \
                contextlib.redirect_stderr(io.StringIO()) as err:
            code = cluster_model.check(FREE, self.results, workers=1)
        return code, out.getvalue() + err.getvalue()

    def test_accepts_a_submission_that_took_what_the_model_says(self):
        self.submission([11.0, 21.0])
        self.assertEqual(self.check(), (
            0, "2 tasks, 4 cells of 20.0 s in all, 1 workers: 21.0 s measured, 20.0 s by the model\n"))

    def test_tells_a_submission_that_took_longer(self):
        self.submission([11.0, 30.0])
        self.assertEqual(self.check()[0], 1)

    def test_needs_a_submission_that_has_ended(self):
        self.assertIn("has no submission", self.check()[1])
        self.submission([11.0])
        code, said = self.check()
        self.assertEqual(code, 2)
        self.assertIn("1 tasks of", said)


if __name__ == "__main__":
    unittest.main()
