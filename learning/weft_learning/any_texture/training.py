# SPDX-License-Identifier: Apache-2.0
"""The training loop and the loss of a network for any texture."""
from __future__ import annotations

import argparse
import math
import time
import types

import numpy as np
import torch
from torch.nn import functional

from ..batches import Augmentation, Batch
from ..curves import curve_text
from ..errors import InputError
from ..losses import LOG_ERROR_RANGE, uv_error, visible_cells
from ..trainer import CHECKPOINT, GRADIENT_NORM, SLOWEST_NORM, WARM_UP, WEIGHT_DECAY, load_checkpoint, write_atomically
from .network import PLACES, SIZES, AnyTextureNetwork
from .scenes import Maker, Scenes

VALIDATION_SHARE = 25  # every 25th sample; its textures are not used for training
VALIDATION_SAMPLES = 384
EVERY = 10000  # samples between two validations and checkpoints
WEIGHTS = {"mask": 1.0, "uv": 0.3, "depth": 0.15, "place": 0.15}


def place_loss(correlation: torch.Tensor, batch: Batch, visible: torch.Tensor) -> torch.Tensor:
    """Cross entropy between the correlation of a cell of 8 px and the place of the canvas that it shows."""
    rows_added = functional.pad(torch.cat([batch.uv * visible[:, None], visible[:, None].float()], 1), (0, 0, 1, 1))
    means = functional.avg_pool2d(rows_added, 2).flatten(2)
    whole = means[:, 2] > 0.999
    if not whole.any():
        return correlation.sum() * 0
    cell = (means[:, :2] * PLACES).long().clamp(0, PLACES - 1)
    return functional.cross_entropy(correlation[whole], (cell[:, 1] * PLACES + cell[:, 0])[whole])


def loss_parts(cells: torch.Tensor, correlation: torch.Tensor, batch: Batch) -> dict[str, torch.Tensor]:
    """Each part of the loss, without its weight."""
    visible = visible_cells(batch)
    count = visible.sum().clamp(min=1)
    log_uv, log_depth = cells[:, 3].clamp(*LOG_ERROR_RANGE), cells[:, 5].clamp(*LOG_ERROR_RANGE)
    uv = 2 * (uv_error(cells, batch.uv, 1.0) * torch.exp(-log_uv) + log_uv)
    depth = (cells[:, 4] - batch.log_depth).abs() * torch.exp(-log_depth) + log_depth
    return {"mask": functional.binary_cross_entropy_with_logits(cells[:, 0], batch.mask),
            "uv": (uv * visible).sum() / count, "depth": (depth * visible).sum() / count,
            "place": place_loss(correlation, batch, visible)}


class Training:
    """One training, which continues from its checkpoint."""

    def __init__(self, scenes: list[Scenes], options: argparse.Namespace) -> None:
        self.options, self.scenes = options, scenes
        self.steps = options.samples // options.batch
        torch.manual_seed(options.seed)
        self.network = AnyTextureNetwork(SIZES[options.size]).to(memory_format=torch.channels_last)
        self.optimiser = torch.optim.AdamW(self.network.parameters(), lr=options.rate, weight_decay=WEIGHT_DECAY)
        self.maker = Maker(scenes, options.seed, options.textures)
        self.other = Maker(scenes, options.seed + 1000, max(1, options.textures // 10))
        self.augmentation = Augmentation(options.seed, types.SimpleNamespace(cell_px=4))
        places = [(n, k) for n, s in enumerate(scenes) for k in range(s.count)]
        self.train = [p for p in places if p[1] % VALIDATION_SHARE != VALIDATION_SHARE - 1]
        held_out = [p for p in places if p[1] % VALIDATION_SHARE == VALIDATION_SHARE - 1]
        some = np.random.default_rng(options.seed).permutation(len(held_out))[:VALIDATION_SAMPLES]
        self.validation = [held_out[k] for k in some]
        if not self.validation or not self.steps:
            raise InputError(f"{scenes[0].folder}: too few samples; write more")
        self.step, self.seconds, self.curve = 0, 0.0, []
        state = load_checkpoint(options.out)
        if state:
            if state["steps"] != self.steps:
                raise InputError(f"{options.out / CHECKPOINT}: has another schedule; use its --samples and --batch")
            self.network.load_state_dict(state["network"])
            self.optimiser.load_state_dict(state["optimiser"])
            self.step, self.seconds, self.curve = state["step"], state["seconds"], state["curve"]

    def _samples(self, step: int) -> list[tuple[int, int]]:
        random = np.random.default_rng([self.options.seed, 1, step])
        return [self.train[k] for k in random.integers(0, len(self.train), self.options.batch)]

    def rate(self) -> float:
        """The learning rate of this step."""
        warm_up = max(1, round(WARM_UP * self.steps))
        done = max(0.0, (self.step - warm_up) / max(1, self.steps - warm_up))
        return self.options.rate * min(1.0, (self.step + 1) / warm_up) * 0.5 * (1 + math.cos(math.pi * min(1.0, done)))

    def run(self) -> None:
        """Trains to the end."""
        sums: dict[str, float] = {}
        counted, every = 0, max(1, EVERY // self.options.batch)
        while self.step < self.steps:
            began = time.process_time()
            batch, canvas = self.maker.batch(self._samples(self.step),
                                             np.random.default_rng([self.options.seed, 2, self.step]))
            self.augmentation(batch, self.step)
            for module in self.network.modules():
                if isinstance(module, torch.nn.BatchNorm2d):
                    module.momentum = max(SLOWEST_NORM, 1 / (self.step + 1))
            for group in self.optimiser.param_groups:
                group["lr"] = self.rate()
            parts = loss_parts(*self.network(batch.image, canvas), batch)
            loss = sum(WEIGHTS[name] * part for name, part in parts.items())
            if not math.isfinite(float(loss)):
                raise InputError(f"{self.options.out}: the loss is not finite at step {self.step}; lower --rate")
            self.optimiser.zero_grad(set_to_none=True)
            loss.backward()
            torch.nn.utils.clip_grad_norm_(self.network.parameters(), GRADIENT_NORM)
            self.optimiser.step()
            self.step += 1
            self.seconds += time.process_time() - began
            for name, part in (*parts.items(), ("loss", loss)):
                sums[name] = sums.get(name, 0.0) + float(part.detach())
            counted += 1
            if self.step % every == 0 or self.step == self.steps:
                row = {"step": self.step, "samples": self.step * self.options.batch,
                       **{k: v / counted for k, v in sums.items()},
                       **{f"val_{k}": v for k, v in self.evaluate().items()}}
                sums, counted = {}, 0
                self.curve.append(row)
                self.save()
                print(", ".join(f"{k} {v:.4g}" for k, v in row.items()) +
                      f", {1000 * self.seconds / row['samples']:.1f} ms CPU a sample", flush=True)

    def save(self) -> None:
        """Writes checkpoint and curve."""
        state = {"network": self.network.state_dict(), "optimiser": self.optimiser.state_dict(), "step": self.step,
                 "seconds": self.seconds, "curve": self.curve, "steps": self.steps}
        write_atomically(self.options.out / CHECKPOINT, lambda path: torch.save(state, path))
        write_atomically(self.options.out / "curve.csv", lambda path: path.write_text(curve_text(self.curve)))

    def evaluate(self) -> dict[str, float]:
        """Metrics on scenes and textures that no training has seen."""
        self.network.eval()
        intersection = union = 0
        found: dict[str, list[torch.Tensor]] = {"uv_mm": [], "depth": [], "error": [], "expected": []}
        with torch.no_grad():
            for begin in range(0, len(self.validation), 32):
                samples = self.validation[begin:begin + 32]
                batch, canvas = self.other.batch(samples, np.random.default_rng([self.options.seed, 3, begin]))
                cells = self.network(batch.image.clamp(0, 255), canvas)[0]
                answered, true = cells[:, 0] > 0, batch.mask > 0.5
                intersection += int((answered & true).sum())
                union += int((answered | true).sum())
                seen, visible = answered & batch.labelled, visible_cells(batch)
                side_mm = torch.tensor([1000 * self.scenes[n].side_m for n, _ in samples])[:, None, None]
                found["uv_mm"].append((torch.linalg.vector_norm(cells[:, 1:3] - batch.uv, dim=1) * side_mm)[seen])
                found["depth"].append((cells[:, 4] - batch.log_depth).abs()[seen])
                found["error"].append(uv_error(cells, batch.uv, 1.0)[visible])
                found["expected"].append(cells[:, 3].clamp(*LOG_ERROR_RANGE).exp()[visible])
        self.network.train()
        values = {name: torch.cat(parts) for name, parts in found.items()}
        quantile = lambda name, q: float(np.quantile(values[name], q)) if len(values[name]) else math.nan
        return {"iou": intersection / max(1, union), "uv_median_mm": quantile("uv_mm", 0.5),
                "uv_p90_mm": quantile("uv_mm", 0.9), "depth_median_percent": 100 * quantile("depth", 0.5),
                "uv_error_factor": float(values["error"].sum() / values["expected"].sum())}
