# SPDX-License-Identifier: Apache-2.0
"""Disturbs a program while one of its calls is held at the gate of a scripted component.

So each disturbance lands inside a running cell or frame, by construction and not by luck.
"""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import time
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from program import PATIENCE_S, Answer, Program
from small_disk import SmallDisk
from victims import Ablation, Run

@dataclass
class Disturbed:
    """A program that runs, and what is known of it."""

    child: subprocess.Popen
    folder: Path
    held: int = 0  # the process whose call is held
    finished: dict[str, bytes] = field(default_factory=dict)


def wait_for(what, seconds: float = PATIENCE_S) -> bool:
    """Asks every millisecond; False when the time is over."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if what():
            return True
        time.sleep(0.001)
    return False


def is_alive(process: int) -> bool:
    """Whether it runs: one that has ended and is not yet waited for does not."""
    try:
        state = Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state not in "ZX"


def is_waiting(process: int, number: signal.Signals) -> bool:
    """Whether a signal was sent that the process has not yet heard."""
    try:
        lines = Path(f"/proc/{process}/status").read_text().splitlines()
    except OSError:
        return False
    masks = [int(line.split()[1], 16) for line in lines if line.startswith(("SigPnd", "ShdPnd"))]
    return any(mask >> (number - 1) & 1 for mask in masks)


def family_of(process: int) -> list[int]:
    """The process and all below it."""
    found = [process]
    for each in found:
        try:
            found += map(int, Path(f"/proc/{each}/task/{each}/children").read_text().split())
        except OSError:
            pass
    return found


class Gate:
    """The files by which a scripted component holds its calls."""

    def __init__(self, folder: Path) -> None:
        self.closed, self.arrived = folder / "gate", folder / "gate.arrived"
        self.deaf = folder / "gate.deaf"

    def close(self, deaf: bool) -> None:
        self.closed.touch()
        if deaf:
            self.deaf.touch()

    def holds(self) -> int:
        """The process whose call waits, or 0."""
        try:
            return int(self.arrived.read_text().split()[0])
        except (OSError, IndexError):
            return 0

    def let_pass(self) -> None:
        self.arrived.unlink(missing_ok=True)

    def open(self) -> None:
        for file in (self.closed, self.arrived, self.deaf):
            file.unlink(missing_ok=True)


def start(program: Program, victim: Ablation | Run, folder: Path, gate: Gate,
          calls: int) -> Disturbed | None:
    """Runs the victim until so many calls have passed and the next one is held."""
    child = subprocess.Popen(program.command(*victim.command), cwd=folder, start_new_session=True,
                             stdin=subprocess.DEVNULL, stdout=open(folder / "out.txt", "wb"),
                             stderr=open(folder / "err.txt", "wb"))
    for call in range(calls + 1):
        if not wait_for(lambda: gate.holds() or child.poll() is not None) or not gate.holds():
            child.kill()
            child.wait()
            return None
        if call < calls:
            gate.let_pass()
    held = gate.holds()
    if not is_alive(held) or held not in family_of(child.pid):
        return None
    return Disturbed(child, folder, held, victim.finished(folder))


def end(disturbed: Disturbed, command: list[str]) -> Answer:
    """Waits for the program; one that does not end is killed."""
    try:
        disturbed.child.wait(PATIENCE_S)
        hung = False
    except subprocess.TimeoutExpired:
        hung = True
        os.killpg(disturbed.child.pid, signal.SIGKILL)
        disturbed.child.wait()
    out, err = ((disturbed.folder / name).read_bytes().decode(errors="replace")
                for name in ("out.txt", "err.txt"))
    return Answer(command, disturbed.child.returncode, out, err, 0.0, hung)


# --- what is done to the program ------------------------------------------------------------------


def kill_child(state: Disturbed, rng: Random) -> None:
    os.kill(state.held, signal.SIGKILL)
    wait_for(lambda: not is_alive(state.held))


def kill_parent(state: Disturbed, rng: Random) -> None:
    family = family_of(state.child.pid)
    state.child.kill()
    state.child.wait()
    orphans = lambda: [process for process in family if is_alive(process)]
    if not wait_for(lambda: not orphans()):
        raise AssertionError(f"{len(orphans())} processes live on without their parent")


def kill_group(state: Disturbed, rng: Random) -> None:
    os.killpg(state.child.pid, signal.SIGKILL)
    state.child.wait()


def interrupt(state: Disturbed, rng: Random) -> None:
    """As a terminal does; the call that is held asks whether it is cancelled."""
    os.killpg(state.child.pid, rng.choice([signal.SIGINT, signal.SIGTERM]))
    if not wait_for(lambda: state.child.poll() is not None):
        raise AssertionError("does not end after an interrupt")


def interrupt_twice(state: Disturbed, rng: Random) -> None:
    """While a call never asks whether it is cancelled. Signals that wait to be heard are one."""
    os.killpg(state.child.pid, signal.SIGINT)
    if not wait_for(lambda: not is_waiting(state.child.pid, signal.SIGINT)):
        raise AssertionError("does not hear an interrupt")
    os.killpg(state.child.pid, signal.SIGINT)
    if not wait_for(lambda: state.child.poll() is not None):
        raise AssertionError("does not end after a second interrupt")


def stop_and_continue(state: Disturbed, rng: Random) -> None:
    target = rng.choice([state.held, state.child.pid, -state.child.pid])
    deliver = (lambda s: os.killpg(-target, s)) if target < 0 else (lambda s: os.kill(target, s))
    deliver(signal.SIGSTOP)
    time.sleep(0.05)
    deliver(signal.SIGCONT)


def small_files(state: Disturbed, size: int) -> None:
    """No file may grow beyond the size from here on."""
    for process in family_of(state.child.pid):
        resource.prlimit(process, resource.RLIMIT_FSIZE, (size, size))


def full_disk(disk: SmallDisk, size: int) -> None:
    disk.fill(size)
