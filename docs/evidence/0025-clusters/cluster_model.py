#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""How well workers of a cluster are used by `weft ablate --engine slurm`, by a model of discrete events.

usage: cluster_model.py [--measure FOLDER] [--costs FILE] [--minutes M] [--tasks N]
       cluster_model.py [--costs FILE] --check RESULTS --workers N

The first prints the efficiency (time in which cells are computed, of all time that workers are held)
over the length of a cell and the number of workers, and what is busiest: `folder`, the shared folder;
`slurm`, its controller; otherwise the workers' own work. Tasks take M minutes (10, as the engine's
default), each worker gets N of them (6).

--check compares the model with the last submission of a results folder, which has ended, was the only
one and was run by N workers of one process. It prints the time from the order to the last report,
measured and by the model, which is given the seconds of the cells, and exits 1 where they differ by
more than a fifth.

--measure does in FOLDER, one that your nodes share, what a task does there for a cell, and takes its
time in place of the costs below. FILE is a JSON object of costs (Costs, below) that you measured.

The model. Slurm's controller starts tasks one after the other. A task is launched, the program starts,
reads the results that there are, claims its cells, computes and keeps one after the other, and reads
the results again. What goes to the shared folder waits its turn there: one queue, first come, first
served, which is too strict for servers that do several things at once. Cells take times of a log-normal distribution. A task is simulated in at most 50 steps.
"""

import argparse
import heapq
import json
import math
import os
import random
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

CELL_SECONDS = (0.1, 1.0, 10.0, 60.0)
WORKERS = (1, 2, 8, 32, 128, 512)
SEED = 1
STEPS = 50  # of a task, at most
TOLERANCE = 0.2


class Costs(NamedTuple):
    """Measured with the two nodes of tests/cluster/loopback_test.py, see docs/evidence/0025-clusters.md."""

    controller_s: float = 0.02  # that Slurm's controller takes for each task
    launch_s: float = 0.25  # until the program of a task runs
    start_s: float = 0.4  # until it has read the plan and loaded the plugins
    read_s: float = 5e-6  # of the reader, for each result that there is
    folder_read_s: float = 2e-6  # of the shared folder, for the same
    claim_s: float = 0.0001  # of the shared folder, to claim a cell and to let go of it
    keep_s: float = 0.002  # of the shared folder, to keep a cell's line and files
    spread: float = 0.5  # standard deviation of the logarithm of a cell's time


class Outcome(NamedTuple):
    seconds: float  # until the last task has ended
    efficiency: float
    busy: dict[str, float]  # share of the time in which it is


class Queue:
    """What serves one after the other."""

    def __init__(self) -> None:
        self.free_s = 0.0
        self.busy_s = 0.0

    def serve(self, now_s: float, takes_s: float) -> float:
        """When what comes now has been served."""
        self.free_s = max(now_s, self.free_s) + takes_s
        self.busy_s += takes_s
        return self.free_s


class Cluster:
    """Workers that take tasks in turn; a task is the seconds of its cells."""

    def __init__(self, costs: Costs, tasks: list[list[float]], workers: int) -> None:
        self.costs, self.tasks = costs, tasks
        self.folder, self.controller = Queue(), Queue()
        self.done = 0  # cells
        self.events: list[tuple[float, int, object]] = []
        self.number = 0  # of events: of two at once, the one that was first
        self.next_task = 0
        self.end_s = 0.0
        for _ in range(workers):
            self.at(0.0, self.worker())

    def at(self, time_s: float, steps: object) -> None:
        heapq.heappush(self.events, (time_s, self.number, steps))
        self.number += 1

    def run(self) -> float:
        while self.events:
            now_s, _, steps = heapq.heappop(self.events)
            self.now_s = now_s
            wakes_s = next(steps, None)  # type: ignore[call-overload]
            if wakes_s is not None:
                self.at(wakes_s, steps)
        return self.end_s

    def worker(self):
        """Yields when it goes on."""
        costs = self.costs
        while self.next_task < len(self.tasks):
            cells = self.tasks[self.next_task]
            self.next_task += 1
            yield self.controller.serve(self.now_s, costs.controller_s)
            yield self.now_s + costs.launch_s + costs.start_s
            yield from self.read()
            yield self.folder.serve(self.now_s, costs.claim_s * len(cells))
            size = math.ceil(len(cells) / STEPS)
            for first in range(0, len(cells), size):
                step = cells[first:first + size]
                yield self.now_s + sum(step)
                yield self.folder.serve(self.now_s, costs.keep_s * len(step))
                self.done += len(step)
            yield from self.read()
            self.end_s = max(self.end_s, self.now_s)

    def read(self):
        yield self.folder.serve(self.now_s, self.costs.folder_read_s * self.done)
        yield self.now_s + self.costs.read_s * self.done


def simulate(costs: Costs, tasks: list[list[float]], workers: int) -> Outcome:
    cluster = Cluster(costs, tasks, workers)
    seconds = cluster.run()
    computed_s = sum(map(sum, tasks))
    held_s = seconds * workers
    busy = {"folder": cluster.folder.busy_s / seconds, "slurm": cluster.controller.busy_s / seconds}
    return Outcome(seconds, computed_s / held_s, busy)


def drawn_tasks(cell_s: float, minutes: float, count: int, spread: float) -> list[list[float]]:
    chance = random.Random(SEED)
    cells = max(1, int(minutes * 60.0 / cell_s))
    middle = math.log(cell_s) - 0.5 * spread * spread
    if cells <= STEPS:
        return [[chance.lognormvariate(middle, spread) for _ in range(cells)] for _ in range(count)]
    # Sums of many: what they spread by is their own, by the central limit.
    deviation = cell_s * math.sqrt(math.exp(spread * spread) - 1.0)
    tasks = []
    for _ in range(count):
        mean = cell_s + deviation / math.sqrt(cells) * chance.gauss(0.0, 1.0)
        tasks.append([max(mean, 0.0)] * cells)
    return tasks


def measured(folder: Path, costs: Costs, cells: int = 100) -> Costs:
    """With what this folder costs, the median over so many cells of two small files each."""
    claims, keeps = [], []
    with tempfile.TemporaryDirectory(prefix="weft_measured_", dir=folder) as scratch:
        lines = os.open(f"{scratch}/lines.jsonl", os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        for cell in range(cells):
            start = time.perf_counter()
            claim = f"{scratch}/claim{cell}"
            os.symlink("12_3", claim)
            os.readlink(claim)
            os.remove(claim)
            claims.append(time.perf_counter() - start)
            start = time.perf_counter()
            own = f"{scratch}/{cell}"
            os.mkdir(own)
            for name in ("pipeline.yaml", "shapes.npz"):
                keep_bytes(f"{scratch}/{name}", bytes(1000))
                os.rename(f"{scratch}/{name}", f"{own}/{name}")
            for each in (own, scratch):
                make_last(os.open(each, os.O_RDONLY))
            os.write(lines, bytes(8000))
            os.fsync(lines)
            keeps.append(time.perf_counter() - start)
        os.close(lines)
    return costs._replace(claim_s=statistics.median(claims), keep_s=statistics.median(keeps))


def keep_bytes(path: str, data: bytes) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT, 0o666)
    os.write(descriptor, data)
    make_last(descriptor)


def make_last(descriptor: int) -> None:
    os.fsync(descriptor)
    os.close(descriptor)


def print_table(costs: Costs, minutes: float, tasks: int) -> None:
    print(f"tasks of {minutes:g} min, {tasks} for each worker; seed {SEED}")
    print("| cell [s] | " + " | ".join(f"{workers} workers" for workers in WORKERS) + " |")
    print("|" + "---|" * (len(WORKERS) + 1))
    for cell_s in CELL_SECONDS:
        row = []
        for workers in WORKERS:
            drawn = drawn_tasks(cell_s, minutes, tasks * workers, costs.spread)
            outcome = simulate(costs, drawn, workers)
            busiest = max(outcome.busy, key=outcome.busy.__getitem__)
            limit = f" {busiest}" if outcome.busy[busiest] > 0.8 else ""
            row.append(f"{100 * outcome.efficiency:.0f} %{limit}")
        print(f"| {cell_s:g} | " + " | ".join(row) + " |")
    print("The shared folder is busy all the time from so many workers on: " + ", ".join(
        f"{(cell_s + costs.keep_s + costs.claim_s) / (costs.keep_s + costs.claim_s):.0f} with cells of "
        f"{cell_s:g} s" for cell_s in CELL_SECONDS))


def seconds_of_cells(results: Path) -> dict[str, float]:
    """By key; files that cells read together count for the first of them."""
    found = {}
    for file in sorted((results / "results").glob("*.jsonl")):
        for line in file.read_text().splitlines():
            cell = json.loads(line)
            found[cell["key"]] = cell["machine"]["seconds"]
    return found


def check(costs: Costs, results: Path, workers: int) -> int:
    orders = sorted((results / "slurm").glob("*/order.json"))
    if not orders:
        print(f"cluster_model.py: {results} has no submission in {results / 'slurm'}", file=sys.stderr)
        return 2
    order = orders[-1]
    seconds = seconds_of_cells(results)
    tasks = [[seconds.get(key, 0.0) for group in chunk for key in group]
             for chunk in json.loads(order.read_text())["tasks"]]
    reports = list(order.parent.glob("task_*.json"))
    if len(reports) < len(tasks):
        print(f"cluster_model.py: {len(tasks) - len(reports)} tasks of {order.parent} have not ended",
              file=sys.stderr)
        return 2
    measured_s = max(report.stat().st_mtime for report in reports) - order.stat().st_mtime
    model_s = simulate(costs, tasks, workers).seconds
    print(f"{len(tasks)} tasks, {sum(map(len, tasks))} cells of {sum(map(sum, tasks)):.1f} s in all, "
          f"{workers} workers: {measured_s:.1f} s measured, {model_s:.1f} s by the model")
    return 0 if abs(measured_s - model_s) <= TOLERANCE * measured_s else 1


def main() -> int:
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("--costs", type=Path)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--tasks", type=int, default=6)
    parser.add_argument("--check", type=Path)
    parser.add_argument("--workers", type=int)
    parser.add_argument("--measure", type=Path)
    given = parser.parse_args()
    costs = Costs(**json.loads(given.costs.read_text())) if given.costs else Costs()
    if given.check is not None:
        if given.workers is None:
            parser.error("--check needs --workers")
        return check(costs, given.check, given.workers)
    if given.measure is not None:
        costs = measured(given.measure, costs)
        print(f"{given.measure}: {1000.0 * costs.claim_s:.2f} ms to claim a cell, "
              f"{1000.0 * costs.keep_s:.2f} ms to keep it")
    print_table(costs, given.minutes, given.tasks)
    return 0


if __name__ == "__main__":
    sys.exit(main())
