# SPDX-License-Identifier: Apache-2.0
"""The training loop: a schedule by samples, checkpoints, and a curve that no interruption changes."""

import dataclasses
import math
import os
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
import torch

from .batches import Augmentation, read_batch
from .curves import curve_text
from .errors import InputError, Stopped
from .losses import PARTS, Grid, loss_parts, total
from .metrics import evaluate
from .network import SIZES, RegistrationNetwork, Shape
from .shards import Description, Shards, order_of_epoch

WARM_UP = 0.03  # share of the steps
GRADIENT_NORM = 5.0
WEIGHT_DECAY = 1e-4
VALIDATION_SAMPLES = 400  # for the curve; the end uses all
VALIDATE_FIRST = (1000, 2000, 5000, 10000)  # samples seen; then every VALIDATE_EVERY
VALIDATE_EVERY = 20000
START_SAMPLES = 256  # whose mean both heads start at
SLOWEST_NORM = 0.02  # momentum of batch norm after the first steps
CHECKPOINT = "checkpoint.pt"


@dataclasses.dataclass(frozen=True)
class Settings:
    """All that determines the curve, beside the shards themselves."""

    size: str
    samples: int
    epochs: int
    batch: int
    seed: int
    learning_rate: float = 3e-3


def identity(shards: Shards) -> dict[str, Any]:
    """What must not change between two starts of one training; more frames may be added."""
    content = dataclasses.asdict(shards.description)
    del content["frames"]
    return content


def make_network(size: str, description: Description) -> RegistrationNetwork:
    """An untrained network for these shards."""
    shape = Shape(description.width_px, description.height_px, description.columns, description.rows)
    return RegistrationNetwork(SIZES[size], shape).to(memory_format=torch.channels_last)


def write_atomically(path: Path, write: Any) -> None:
    """Calls `write(temporary)` and renames, so that a kill leaves the old file or the new one."""
    temporary = path.with_name(path.name + ".part")
    write(temporary)
    with open(temporary, "rb") as file:
        os.fsync(file.fileno())
    os.replace(temporary, path)


def load_checkpoint(folder: Path) -> dict[str, Any] | None:
    """Content of the checkpoint of a folder, if there is one."""
    path = folder / CHECKPOINT
    if not path.exists():
        return None
    try:
        return torch.load(path, map_location="cpu")
    except Exception as error:  # torch.load raises many types for a damaged file.
        raise InputError(f"{path}: cannot be read ({error}); remove it to train from the start") from None


def samples_of_checkpoint(folder: Path) -> int | None:
    """Number of samples of a training that began before, so that the same command continues it."""
    state = load_checkpoint(folder)
    return state["settings"]["samples"] if state else None


class Training:
    """One training of one folder; continues from its checkpoint."""

    def __init__(self, shards: Shards, folder: Path, settings: Settings) -> None:
        self.shards, self.folder, self.settings = shards, folder, settings
        self.train = shards.indices("train")
        self.validation = shards.indices("validation")[:VALIDATION_SAMPLES]
        self.steps_per_epoch = len(self.train) // settings.batch
        self.steps = self.steps_per_epoch * settings.epochs
        if not self.steps:
            raise InputError(f"{shards.folder}: {len(self.train)} training samples for batches of {settings.batch}; "
                             "give more samples or a smaller --batch")
        self.report_steps = max(1, min(100, self.steps // 50))
        self.validation_steps = self._validation_steps()
        torch.manual_seed(settings.seed)
        self.network = make_network(settings.size, shards.description)
        self.optimiser = torch.optim.AdamW(self.network.parameters(), lr=settings.learning_rate,
                                           weight_decay=WEIGHT_DECAY)
        self.augmentation = Augmentation(settings.seed, shards.description)
        self.grid = Grid.of(shards.description)
        self.step, self.seconds = 0, 0.0
        self.curve: list[dict[str, float]] = []
        self.sums, self.counted = dict.fromkeys((*PARTS, "loss", "gradient"), 0.0), 0
        state = load_checkpoint(folder)
        if state:
            self._continue(state)
        else:
            self._start_at_mean()

    def _validation_steps(self) -> set[int]:
        batch = self.settings.batch
        seen = [*VALIDATE_FIRST, *range(VALIDATE_EVERY, self.steps * batch, VALIDATE_EVERY)]
        return {math.ceil(s / batch) for s in seen} | {self.steps}

    def _start_at_mean(self) -> None:
        """Starts the heads at the mean of the first samples."""
        batch = read_batch(self.shards, self.train[:min(START_SAMPLES, self.shards.length * 9 // 10)])
        present = batch.weight.amax(dim=1) > 0
        if not present.any():
            raise InputError(f"{self.shards.folder}/000000: no sample has the object; make the shards again")
        vertices = batch.vertices[present].mean(dim=0)
        self.network.start_at(float(vertices[2].mean()), vertices)

    def _continue(self, state: dict[str, Any]) -> None:
        """Takes the state of a checkpoint that has the same settings."""
        wanted = {**dataclasses.asdict(self.settings), **identity(self.shards)}
        for name, value in wanted.items():
            there = state["settings"].get(name)
            if there != value:
                raise InputError(f"{self.folder / CHECKPOINT}: {name} is {there!r} there and {value!r} here; use the "
                                 "same settings or another --out")
        self.network.load_state_dict(state["network"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.step, self.seconds, self.curve = state["step"], state["seconds"], state["curve"]
        self.sums, self.counted = state["sums"], state["counted"]

    def save(self) -> None:
        """Writes the checkpoint."""
        state = {"settings": {**dataclasses.asdict(self.settings), **identity(self.shards)},
                 "network": self.network.state_dict(), "optimiser": self.optimiser.state_dict(),
                 "step": self.step, "steps": self.steps, "seconds": self.seconds, "curve": self.curve,
                 "sums": self.sums, "counted": self.counted}
        write_atomically(self.folder / CHECKPOINT, lambda path: torch.save(state, path))

    def run(self, checkpoint_samples: int, check: Any) -> None:
        """Trains to the end. `check()` raises Stopped; then a checkpoint is written first."""
        every = max(1, checkpoint_samples // self.settings.batch)
        self._write_curve()
        order, epoch = None, -1
        try:
            while self.step < self.steps:
                check()
                if self.step // self.steps_per_epoch != epoch:
                    epoch = self.step // self.steps_per_epoch
                    order = order_of_epoch(self.train, self.settings.seed, epoch)
                begin = self.step % self.steps_per_epoch * self.settings.batch
                self._train_step(order[begin:begin + self.settings.batch])
                if self.step % every == 0:
                    self.save()
        finally:
            self.save()

    def _rate(self) -> float:
        warm_up = max(1, round(WARM_UP * self.steps))
        if self.step < warm_up:
            return self.settings.learning_rate * (self.step + 1) / warm_up
        done = (self.step - warm_up) / max(1, self.steps - warm_up)
        return self.settings.learning_rate * 0.5 * (1 + math.cos(math.pi * done))

    def _train_step(self, indices: np.ndarray) -> None:
        batch = read_batch(self.shards, indices)
        began = time.process_time()
        self.augmentation(batch, self.step)
        for module in self.network.modules():
            if isinstance(module, torch.nn.BatchNorm2d):
                module.momentum = max(SLOWEST_NORM, 1 / (self.step + 1))
        for group in self.optimiser.param_groups:
            group["lr"] = self._rate()
        parts = loss_parts(*self.network(batch.image), batch, self.grid)
        loss = total(parts)
        self.optimiser.zero_grad(set_to_none=True)
        loss.backward()
        gradient = torch.nn.utils.clip_grad_norm_(self.network.parameters(), GRADIENT_NORM)
        found = {**{name: float(part.detach()) for name, part in parts.items()}, "loss": float(loss.detach()),
                 "gradient": float(gradient)}
        if not all(map(math.isfinite, found.values())):
            raise InputError(f"{self.folder}: the loss is not finite at step {self.step} ({found}); lower the rate "
                             "with --rate or check the shards")
        self.optimiser.step()
        for name, value in found.items():
            self.sums[name] += value
        self.counted += 1
        self.step += 1
        self.seconds += time.process_time() - began
        if self.step % self.report_steps == 0 or self.step in self.validation_steps:
            self._report()

    def _report(self) -> None:
        """Adds a row to the curve."""
        row = {"step": self.step, "samples": self.step * self.settings.batch,
               **{name: value / self.counted for name, value in self.sums.items()}}
        self.sums, self.counted = dict.fromkeys(self.sums, 0.0), 0
        if self.step in self.validation_steps and len(self.validation):
            row.update({f"val_{k}": v for k, v in evaluate(self.network, self.shards, self.validation).items()})
        self.curve.append(row)
        self._write_curve()
        print(f"{row['samples']} of {self.steps * self.settings.batch} samples seen, loss {row['loss']:.3f}, "
              f"{1000 * self.seconds / row['samples']:.1f} ms CPU a sample" + "".join(
                  f", {name[4:]} {row[name]:.3f}" for name in ("val_iou", "val_uv_median_mm", "val_vertex_median_mm")
                  if name in row), flush=True)

    def _write_curve(self) -> None:
        write_atomically(self.folder / "curve.csv", lambda path: path.write_text(curve_text(self.curve)))


class Watch:
    """Stops a training at a signal or after some minutes."""

    def __init__(self, minutes: float | None) -> None:
        self.end = time.monotonic() + 60 * minutes if minutes is not None else math.inf
        self.minutes, self.signal, self.said = minutes, 0, 0.0
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._receive)

    def _receive(self, number: int, _: Any) -> None:
        if self.signal:
            os._exit(128 + number)
        self.signal = number

    def check(self) -> None:
        """Raises Stopped if the training must stop now."""
        if self.signal:
            raise Stopped(f"stopped by {signal.Signals(self.signal).name}")
        if time.monotonic() > self.end:
            raise Stopped(f"stopped after {self.minutes:g} minutes")

    def wait(self, message: str) -> None:
        """Waits a second for a shard; prints the message each minute."""
        self.check()
        if time.monotonic() - self.said > 60 or not self.said:
            print(message, flush=True)
            self.said = time.monotonic()
        time.sleep(1)
