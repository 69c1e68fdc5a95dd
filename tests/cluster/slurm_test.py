#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`weft ablate --engine slurm` against a Slurm that is none: its tasks run on this machine, are
killed, lost and put into the queue again. loopback_test.py does it with Slurm itself.

Usage: slurm_test.py --weft PROGRAM --plugin-path FOLDER [--seed N]
"""

from __future__ import annotations

import argparse
import os
import shutil
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path
from random import Random, SystemRandom

import fake_slurm
from fake_nodes import Killer, Nodes
from planned import CELLS, TASKS, Planned, Program, differing, other_build

OPTIONS = argparse.Namespace()


class SlurmTest(unittest.TestCase):
    frame_ms = 0

    @classmethod
    def setUpClass(cls) -> None:
        cls.scratch = tempfile.TemporaryDirectory(prefix="weft_slurm_")
        cls.folder = Path(cls.scratch.name)
        cls.path = os.environ["PATH"]
        bin_folder = cls.folder / "bin"
        bin_folder.mkdir()
        for name in ("sbatch", "squeue", "sinfo", "scancel"):
            (bin_folder / name).symlink_to(Path(fake_slurm.__file__).resolve())
        os.environ["PATH"] = f"{bin_folder}:{cls.path}"
        cls.plugins = cls.folder / "plugins"
        cls.plugins.mkdir()
        for file in Path(OPTIONS.plugin_path).iterdir():
            if file.suffix in (".so", ".yaml"):
                shutil.copy2(file, cls.plugins)
        program = Program(OPTIONS.weft, [str(cls.plugins)])
        cls.planned = Planned(program, cls.folder, cls.frame_ms)
        cls.out, cls.outs = "out00", 0  # names of one length: tables are aligned
        outcome = cls.planned.ask(cls.out, "--quiet")
        assert outcome.code == 0, outcome.text
        cls.local_s = outcome.ms / 1000.0
        cls.expected = cls.planned.results(cls.out)

    @classmethod
    def tearDownClass(cls) -> None:
        os.environ["PATH"] = cls.path
        cls.scratch.cleanup()

    def setUp(self) -> None:
        type(self).outs += 1
        self.out = f"out{self.outs:02}"
        self.new_queue("queue")

    def new_queue(self, name: str) -> None:
        queue = self.folder / f"{name}_{self.out}"
        queue.mkdir()
        os.environ["FAKE_SLURM"] = str(queue)
        self.nodes = Nodes(queue, dict(os.environ))

    def submit(self, *arguments: str) -> str:
        outcome = self.planned.submit(self.out, *arguments)
        self.assertEqual(outcome.code, 0, outcome.text)
        return outcome.out

    def status(self, *arguments: str) -> str:
        outcome = self.planned.submit(self.out, "--status", *arguments)
        self.assertIn(outcome.code, (0, 1), outcome.text)
        return outcome.out

    def assert_kept(self, before: dict[str, object]) -> dict[str, object]:
        """What was finished is still there; returns what is now."""
        now = self.planned.finished(self.out)
        self.assertEqual({name: now.get(name) for name in before}, before)
        return now

    def assert_whole(self) -> None:
        outcome = self.planned.submit(self.out)
        self.assertEqual(outcome.code, 0, outcome.text)
        self.assertIn(f"{CELLS} done, 0 failed, 0 left", outcome.out)
        self.assertEqual(differing(self.planned.results(self.out), self.expected), [])


class GivesTheTablesOfTheLocalEngine(SlurmTest):
    def test_in_tasks_of_so_many_minutes_with_a_summary_at_their_end(self) -> None:
        said = self.submit()
        self.assertIn(f"job 1: {CELLS} cells in {TASKS} tasks", said)
        tasks = self.planned.tasks(self.out)
        self.assertEqual([len(keys) for keys in tasks], [CELLS // TASKS] * TASKS)
        self.assertEqual(len({key for keys in tasks for key in keys}), CELLS)
        self.assertIn(f"0 tasks run, {TASKS} wait, 0 ended; {CELLS} cells are on their way",
                      self.status())
        self.nodes.run()
        summary = self.folder / self.out / "slurm/000001/summary.txt"
        self.assertIn(f"{CELLS} done, 0 failed, 0 left", summary.read_text())
        self.assertEqual(self.planned.lines(self.out), CELLS)
        self.assertFalse((self.folder / self.out / "index.sqlite").exists())
        self.assert_whole()

    def test_after_some_cells_were_run_here_with_the_options_of_the_plan(self) -> None:
        outcome = self.planned.ask(self.out, "--quiet", "--without", "every.4")
        self.assertEqual(outcome.code, 0, outcome.text)
        self.assertTrue((self.folder / self.out / "index.sqlite").exists())
        plan = self.folder / "with_cluster.yaml"
        plan.write_text((self.folder / "plan.yaml").read_text() + "cluster: {partition: gpu, "
                        "sbatch: [--mem=4G], chunk_minutes: 1, cell_seconds: 60}\n")
        outcome = self.planned.program.ask(self.folder, "ablate", plan.name, "--out", self.out,
                                        "--engine", "slurm", "--set", "cluster.cell_seconds=30",
                                        "--sbatch=--time=10", "--jobs", "2")
        self.assertIn("job 1: 4 cells in 1 task", outcome.out, outcome.err)
        job = (self.folder / f"queue_{self.out}/jobs/1/job.json").read_text()
        for option in ('"partition": "gpu"', '"mem": "4G"', '"time": "10"', '"cpus-per-task": "2"'):
            self.assertIn(option, job)
        self.assertFalse((self.folder / self.out / "index.sqlite").exists(), "it knows too little")
        self.nodes.run()
        self.assert_whole()

    def test_and_their_times_where_they_are_asked_for(self) -> None:
        self.submit("--timing", "--without", "every.3", "--without", "every.4")
        self.nodes.run()
        files = sorted(file.name for file in (self.folder / self.out / "results").iterdir())
        self.assertEqual(len(files), 4)
        self.assertTrue(all(name.startswith("alone-1_") for name in files), files)
        self.assertIn("4 done, 0 failed, 0 left", self.status("--timing", "--without", "every.3",
                                                              "--without", "every.4"))


class GoesOnWhereAnOrderIsLost(SlurmTest):
    def test_and_submits_its_cells_again(self) -> None:
        for text in ("", None):
            self.setUp()
            self.submit()
            order = self.folder / self.out / "slurm/000001/order.json"
            order.unlink()
            if text is not None:
                order.write_text(text)
            self.assertIn(str(order), self.status())
            said = self.submit()
            self.assertIn(str(order), said)
            self.assertIn(f"job 3: {CELLS} cells", said)  # job 2 collects what job 1 comes to
            self.nodes.run()
            self.assert_whole()


class SurvivesWhateverBecomesOfTasks(SlurmTest):
    frame_ms = 20

    def test_lost_requeued_thought_lost_killed_and_ended(self) -> None:
        seed = OPTIONS.seed
        print(f"seed {seed}")
        killer = Killer(Random(seed), share=0.6, longest_s=self.local_s)
        known: dict[str, object] = {}
        for rounds in range(1, 30):
            self.submit()
            self.nodes.run(killer)
            known = self.assert_kept(known)
            if self.planned.cells(self.out) == CELLS:
                break
        print(f"{rounds} submissions, {self.planned.lines(self.out)} lines, {killer.done}")
        self.assert_whole()

    def test_a_task_that_ended_early_is_reported_and_only_its_cells_run_again(self) -> None:
        self.submit()
        self.nodes.run(Killer(Random(1), share=1.0, longest_s=0.0, kinds=("lost",)), most=1)
        self.nodes.run()
        self.assertRegex(self.status(), "left: 2 cells of a task that ended early; .*/task_0.txt")
        self.assertIn("2 cells in 1 task", self.submit())
        self.nodes.run()
        self.assert_whole()


class RunsACellOnce(SlurmTest):
    frame_ms = 10

    def test_in_spite_of_two_submissions_at_once(self) -> None:
        outcome = []
        threads = [threading.Thread(target=lambda: outcome.append(self.planned.submit(self.out)))
                   for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for each in [each for each in outcome if "is in use by another" in each.err]:
            outcome[outcome.index(each)] = self.planned.submit(self.out)  # it had no more patience
        self.assertEqual([each.code for each in outcome], [0, 0], [each.text for each in outcome])
        keys = [key for task in self.planned.tasks(self.out) for key in task]
        self.assertEqual(len(keys), CELLS)
        self.assertEqual(len(set(keys)), CELLS)
        self.assertTrue(any(f"{CELLS} cells wait or run already" in each.out for each in outcome))

    def test_or_counts_it_once_where_submissions_cannot_see_each_other(self) -> None:
        self.submit()
        first = self.nodes
        self.new_queue("other")
        (self.nodes.folder / "jobs/1").mkdir(parents=True)  # its jobs have other numbers
        self.submit()
        self.assertEqual(sum(len(keys) for keys in self.planned.tasks(self.out)), 2 * CELLS)
        beside = threading.Thread(target=first.run)
        beside.start()
        self.nodes.run()
        beside.join()
        print(f"{self.planned.lines(self.out)} lines of {CELLS} cells")
        self.assert_whole()


class CopesWithTheHabitsOfSites(SlurmTest):
    def site(self, *habits: str) -> None:
        (self.folder / f"queue_{self.out}/site").write_text(" ".join(habits))

    def assert_known_until_it_is_done(self, *arguments: str) -> None:
        """No second call submits what is queued, and the results are whole at the end."""
        self.assertIn(f"0 tasks run, {TASKS} wait, 0 ended; {CELLS} cells are on their way",
                      self.status(*arguments))
        self.assertIn(f"{CELLS} cells wait or run already", self.submit(*arguments))
        self.assertEqual(len(self.planned.tasks(self.out)), TASKS)
        self.nodes.run()
        outcome = self.planned.submit(self.out, *arguments)
        self.assertEqual(outcome.code, 0, outcome.text)
        self.assertIn(f"{CELLS} done, 0 failed, 0 left", outcome.out)

    def test_that_print_lines_of_their_own(self) -> None:
        self.site("talks")
        self.assertIn(f"job 1: {CELLS} cells in {TASKS} tasks", self.submit())
        self.assert_known_until_it_is_done()

    def test_whose_sbatch_says_more_than_a_number(self) -> None:
        self.site("long", "talks")
        self.assertIn(f"job 1: {CELLS} cells in {TASKS} tasks", self.submit())
        self.assert_known_until_it_is_done()

    def test_of_several_clusters(self) -> None:
        for habit in ("talks", "long clusters"):
            self.setUp()
            self.site(habit)
            arguments = ["--sbatch=--clusters=nautilus"]
            self.assertIn("job 1: ", self.submit(*arguments))
            self.assert_known_until_it_is_done(*arguments)

    def test_and_cancels_on_the_cluster_of_the_job(self) -> None:
        self.site("clusters")
        self.submit("--sbatch=--clusters=nautilus")
        outcome = self.planned.submit(self.out, "--cancel")
        self.assertIn(f"{TASKS} tasks ended", outcome.out, outcome.err)
        self.assertIn("0 tasks run, 0 wait, 6 ended", self.status())

    def test_where_the_number_of_a_job_is_lost(self) -> None:
        for habit in ("loses", "mute"):
            self.setUp()
            self.site(habit)
            self.assertIn(f"job 1: {CELLS} cells in {TASKS} tasks", self.submit())
            self.site()
            self.assert_known_until_it_is_done()

    def test_where_it_is_unknown_whether_a_job_is_queued(self) -> None:
        self.site("loses")
        outcome = self.planned.submit(self.out)  # its queue can be read before
        self.assertEqual(outcome.code, 0, outcome.text)
        self.setUp()
        self.site("mute")
        squeue = self.folder / "bin/squeue"
        fake = squeue.readlink()
        squeue.unlink()  # reads once that nothing is queued, and then is out of reach
        squeue.write_text("#!/bin/sh\n[ -e $FAKE_SLURM/jobs/1 ] || exit 0\n"
                          "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2\n")
        squeue.chmod(0o755)
        try:
            outcome = self.planned.submit(self.out)
        finally:
            squeue.unlink()
            squeue.symlink_to(fake)
        self.assertEqual(outcome.code, 3, outcome.text)
        self.assertRegex(outcome.err, "sbatch named no job; .* the job may be queued as weft-")
        self.site()
        self.assert_known_until_it_is_done()

    def test_that_have_one_line_for_all_tasks_of_a_job(self) -> None:
        self.submit()
        self.site("lumps")
        self.assertIn(f"{CELLS} cells wait or run already", self.submit())
        self.assertIn(f"{CELLS} cells are on their way", self.status())

    def test_whose_controller_is_out_of_reach(self) -> None:
        self.submit()
        self.site("down")
        outcome = self.planned.submit(self.out)
        self.assertEqual(outcome.code, 3, outcome.text)
        self.assertIn("Socket timed out", outcome.err)
        self.assertEqual(len(self.planned.tasks(self.out)), TASKS, "nothing is submitted again")
        self.site()
        self.assert_known_until_it_is_done()


class Cancels(SlurmTest):
    def test_all_tasks_and_leaves_what_is_finished(self) -> None:
        self.submit()
        self.nodes.run(most=2)
        before = self.planned.finished(self.out)
        gate = self.folder / "gate"  # holds the next tasks
        gate.touch()
        nodes = threading.Thread(target=self.nodes.run)
        nodes.start()
        try:
            while not (self.folder / "gate.arrived").exists():
                time.sleep(0.01)
            self.assertRegex(self.status(), r"[12] tasks? run, [23] wait, 2 ended; 8 cells are on ")
            outcome = self.planned.submit(self.out, "--cancel")
        finally:
            gate.unlink()
            nodes.join()
        self.assertRegex(outcome.out, r"4 tasks ended; run again", outcome.err)
        self.assert_kept(before)
        self.assertIn("0 tasks run, 0 wait, 6 ended; 0 cells are on their way", self.status())
        self.submit()
        self.nodes.run()
        self.assert_whole()


class SaysWhatIsWrong(SlurmTest):
    def refused(self, code: int, *arguments: str, out: str = "") -> str:
        outcome = self.planned.submit(out or self.out, *arguments)
        self.assertEqual(outcome.code, code, outcome.text)
        self.assertEqual(outcome.dirt(), "")
        self.assertFalse(list(self.folder.glob(f"queue_{self.out}/jobs/*")), "nothing is submitted")
        return outcome.err

    def test_before_it_submits(self) -> None:
        self.assertIn("Slurm has no partition 'man'; did you mean 'main'?",
                      self.refused(2, "--partition", "man"))
        self.assertIn("cannot be made a folder", self.refused(2, out="plan.yaml/out"))
        self.assertIn("unrecognized option '--frob'", self.refused(3, "--sbatch=--frob=1"))
        self.assertFalse(list((self.folder / self.out).glob("slurm/0*")), "no trace of it")
        fakes, os.environ["PATH"] = os.environ["PATH"], self.path_without_slurm()
        try:
            said = self.refused(3)
        finally:
            os.environ["PATH"] = fakes
        self.assertIn("there is no sbatch on this machine", said)
        self.assertIn("--engine local", said)

    def path_without_slurm(self) -> str:
        empty = self.folder / "empty"
        empty.mkdir()
        return str(empty)

    def test_in_a_plan_and_on_the_command_line(self) -> None:
        outcome = self.planned.ask(self.out, "--partition", "main")
        self.assertEqual(outcome.code, 2)
        self.assertIn("need --engine slurm", outcome.err)
        for cluster, message in (("{partitio: main}", "did you mean 'partition'"),
                                 ("{sbatch: [mem]}", "begins with a dash"),
                                 ("{chunk_minutes: 0}", "must be above 0")):
            plan = self.folder / "wrong.yaml"
            plan.write_text((self.folder / "plan.yaml").read_text() + f"cluster: {cluster}\n")
            outcome = self.planned.program.ask(self.folder, "check", plan.name)
            self.assertEqual(outcome.code, 2)
            self.assertRegex(outcome.err, r"wrong.yaml:\d+:\d+: .*" + message)

    def test_of_a_task_that_slurm_holds_back(self) -> None:
        self.submit()
        held = self.folder / f"queue_{self.out}/jobs/1/3.held"
        held.touch()
        self.assertIn("left: Slurm holds task 1_3 back (launch failed requeued held); "
                      "`scontrol release 1_3` lets it go", self.status())
        held.unlink()
        self.assertNotIn("holds", self.status())

    def test_of_nodes_with_other_plugins(self) -> None:
        self.submit()
        here = self.folder / "here"
        shutil.copytree(self.plugins, here)
        for library in self.plugins.glob("*.so"):
            other_build(library)
        self.nodes.run(most=1)
        for library in self.plugins.glob("*.so"):
            library.unlink()
        self.nodes.run()
        shutil.rmtree(self.plugins)
        here.rename(self.plugins)
        self.assertEqual(self.planned.lines(self.out), 0)
        said = self.status()
        self.assertRegex(said, r"left: .*: 2 cells have other keys here: components from another "
                               r"build: \w+/test\.\w+")
        self.assertIn("plugin 'sources/test.scripted'", said)
        self.assertIn(f"{CELLS} left", said)
        self.submit()
        self.nodes.run()
        self.assert_whole()


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("--weft", required=True)
    parser.add_argument("--plugin-path", required=True)
    parser.add_argument("--seed", type=int, default=SystemRandom().randrange(10**6))
    global OPTIONS
    OPTIONS, rest = parser.parse_known_args()
    return 0 if unittest.main(argv=[sys.argv[0], *rest], exit=False).result.wasSuccessful() else 1


if __name__ == "__main__":
    sys.exit(main())
