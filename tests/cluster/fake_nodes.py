# SPDX-License-Identifier: Apache-2.0
"""Nodes of the fake Slurm: they run its tasks on this machine, and may be lost."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import threading
import time
from pathlib import Path
from random import Random

from fake_slurm import write

PATIENCE_S = 120.0


class Killer:
    """What happens to tasks: each time one starts, `share` of them are disturbed."""

    # The node fails. The same, and Slurm puts the task into the queue again. Slurm reports a failed
    # node, but the node continues the task. Only the program is killed. The time limit is reached.
    KINDS = ("lost", "requeued", "thought lost", "killed", "ended")

    def __init__(self, random: Random, share: float, longest_s: float,
                 kinds: tuple[str, ...] = KINDS) -> None:
        self.random, self.share, self.longest_s, self.kinds = random, share, longest_s, kinds
        self.done = dict.fromkeys(kinds, 0)

    def plan(self) -> tuple[str, float]:
        """A kind, "" for none, and after how long."""
        if self.random.random() >= self.share:
            return "", 0.0
        return self.random.choice(self.kinds), self.random.random() * self.longest_s


class Nodes:
    """Runs what is in the queue, two tasks at a time."""

    def __init__(self, folder: Path, environment: dict[str, str]) -> None:
        self.folder, self.environment = folder, environment
        self.lock = threading.Lock()
        self.started = 0
        self.zombies: list[subprocess.Popen] = []

    def run(self, killer: Killer | None = None, most: int = 10**6) -> None:
        """Until the queue is empty, or so many tasks have started."""
        most += self.started
        threads = [threading.Thread(target=self._serve, args=(killer, most)) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for zombie in self.zombies:
            zombie.wait(PATIENCE_S)
        self.zombies.clear()

    def _serve(self, killer: Killer | None, most: int) -> None:
        while True:
            with self.lock:
                job, task = self._next() if self.started < most else (None, "")
                if job is not None:
                    self.started += 1
                    write(job / f"{task}.state", "RUNNING")
                    kind, after_s = killer.plan() if killer else ("", 0.0)
                elif not self._busy() or self.started >= most:
                    return
            if job is None:
                time.sleep(0.01)
                continue
            state = self._run(job, task, kind, after_s)
            with self.lock:
                write(job / f"{task}.state", state)
                if killer and kind:
                    killer.done[kind] += 1

    def _jobs(self) -> list[Path]:
        return sorted((file.parent for file in self.folder.glob("jobs/*/job.json")),
                      key=lambda folder: int(folder.name))

    def _states(self, job: Path) -> list[str]:
        return [file.read_text() for file in job.glob("*.state")]

    def _busy(self) -> bool:
        return any("RUNNING" in self._states(job) for job in self._jobs())

    def _next(self) -> tuple[Path | None, str]:
        for job in self._jobs():
            options = json.loads((job / "job.json").read_text())
            before = self.folder / "jobs" / options["after"]
            if options["after"] and {"PENDING", "RUNNING"} & set(self._states(before)):
                continue
            for task in options["tasks"]:
                if (job / f"{task}.state").read_text() == "PENDING":
                    return job, task
        return None, ""

    def _run(self, job: Path, task: str, kind: str, after_s: float) -> str:
        options = json.loads((job / "job.json").read_text())
        environment = self.environment | {"SLURM_JOB_ID": job.name}
        if task != "alone":
            environment |= {"SLURM_ARRAY_JOB_ID": job.name, "SLURM_ARRAY_TASK_ID": task}
        output = options["output"].replace("%a", task).replace("%%", "%")
        mode = "ab" if options["open-mode"] == "append" else "wb"
        with open(output, mode) as log:
            process = subprocess.Popen(["/bin/sh", options["script"]], cwd=options["chdir"],
                                       env=environment, stdin=subprocess.DEVNULL, stdout=log,
                                       stderr=log, start_new_session=True)
        until = time.monotonic() + (after_s if kind else PATIENCE_S)
        while process.poll() is None and time.monotonic() < until:
            if (job / "cancelled").exists():
                kind = "ended"
                break
            time.sleep(0.005)
        return self._disturb(process, kind)

    def _disturb(self, process: subprocess.Popen, kind: str) -> str:
        """The state of the task after it."""
        if process.poll() is not None:
            return "COMPLETED"
        if kind == "thought lost":
            self.zombies.append(process)
            return "PENDING"
        if kind == "killed":
            process.kill()
        else:
            os.killpg(process.pid, signal.SIGTERM if kind == "ended" else signal.SIGKILL)
        process.wait(PATIENCE_S)
        return "PENDING" if kind == "requeued" else "FAILED"
