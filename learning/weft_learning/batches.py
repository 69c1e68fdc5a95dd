# SPDX-License-Identifier: Apache-2.0
"""Turns samples into tensors: images, labels of cells and labels of vertices, with light augmentation."""

import dataclasses

import numpy as np
import torch

from .shards import DEPTH_UNIT_M, NO_LABEL, UV_SCALE, Description, Shards

OCCLUDED_SHARE = 0.3  # of the images get a rectangle
NOISE_VALUES = 1 << 22


@dataclasses.dataclass
class Batch:
    """Tensors of some samples; B samples, R x C cells, V vertices."""

    image: torch.Tensor  # f32 [B,3,H,W], 0 to 255, channels last
    mask: torch.Tensor  # f32 [B,R,C], share of the cell that shows the object
    uv: torch.Tensor  # f32 [B,2,R,C], 0 to 1
    log_depth: torch.Tensor  # f32 [B,R,C], of m
    labelled: torch.Tensor  # bool [B,R,C], where uv and depth exist
    vertices: torch.Tensor  # f32 [B,3,V], X/Z, Y/Z, ln Z
    weight: torch.Tensor  # f32 [B,V], 1 visible, 0.5 hidden, 0 without an object


def read_batch(shards: Shards, indices: np.ndarray) -> Batch:
    """The samples with these indices as tensors, without augmentation."""
    arrays = shards.gather(indices)
    uv, depth = arrays["uv"], arrays["depth"]
    labelled = (uv != NO_LABEL).all(axis=3) & (depth > 0)
    present = ~np.isnan(arrays["vertices_m"][:, 0, 0])
    vertices_m = np.where(present[:, None, None], arrays["vertices_m"], np.float32(1))
    x, y, z = np.moveaxis(vertices_m, 2, 0)
    weight = np.where(arrays["visible"] > 0, 1.0, 0.5) * present[:, None]
    return Batch(
        torch.from_numpy(arrays["image"]).permute(0, 3, 1, 2).float(),
        torch.from_numpy(arrays["mask"]).float() / 255,
        torch.from_numpy(np.moveaxis(uv.astype(np.float32), 3, 1) / np.float32(UV_SCALE)),
        torch.from_numpy(np.log(np.maximum(depth, 1).astype(np.float32) * np.float32(DEPTH_UNIT_M))),
        torch.from_numpy(labelled),
        torch.from_numpy(np.stack([x / z, y / z, np.log(z)], 1)),
        torch.from_numpy(weight.astype(np.float32)))


class Augmentation:
    """Light, noise and rectangles over the image; every draw depends on (seed, step) only."""

    def __init__(self, seed: int, description: Description) -> None:
        self.seed = seed
        self.cell_px = description.cell_px
        # Drawing normals for each image would cost more than the rest of the augmentation. One bank, entered at a
        # random place, is as good.
        self.noise = torch.randn(NOISE_VALUES, generator=torch.Generator().manual_seed(seed))

    def __call__(self, batch: Batch, step: int) -> None:
        """Changes the batch in place."""
        random = np.random.default_rng([self.seed, 2, step])
        count = len(batch.image)
        gain = random.uniform(0.7, 1.3, (count, 1)) * random.uniform(0.9, 1.1, (count, 3))
        offset = random.uniform(-15, 15, (count, 1)) * np.ones((1, 3))
        sigma = random.uniform(0, 6, count)
        occluded = random.random(count) < OCCLUDED_SHARE
        for k in np.flatnonzero(occluded):
            self._cover(batch, int(k), random)
        image = batch.image
        image.mul_(_per_channel(gain)).add_(_per_channel(offset))
        image.addcmul_(self._noise_like(image, random), _per_channel(sigma[:, None]))
        image.clamp_(0, 255)

    def _noise_like(self, image: torch.Tensor, random: np.random.Generator) -> torch.Tensor:
        begin = int(random.integers(0, max(1, NOISE_VALUES - image.numel())))
        count, channels, height, width = image.shape
        noise = self.noise[begin:begin + image.numel()]
        return noise.view(count, height, width, channels).permute(0, 3, 1, 2)

    def _cover(self, batch: Batch, k: int, random: np.random.Generator) -> None:
        """Covers a random rectangle with a colour or noise and removes the labels of the cells below it."""
        image = batch.image[k]
        height, width = image.shape[1:]
        spans = []
        for length in (height, width):
            side = int(random.uniform(0.1, 0.5) * length)
            begin = int(random.integers(0, length - side + 1))
            spans.append((begin, begin + side))
        (top, bottom), (left, right) = spans
        colour = torch.from_numpy(random.uniform(0, 255, (3, 1, 1)).astype(np.float32))
        target = image[:, top:bottom, left:right]
        target.copy_(colour.expand_as(target))
        if random.random() < 0.5:
            target.add_(self._noise_like(target[None], random)[0], alpha=float(random.uniform(10, 80)))
        down = torch.from_numpy(covered_share(top, bottom, height // self.cell_px, self.cell_px))
        across = torch.from_numpy(covered_share(left, right, width // self.cell_px, self.cell_px))
        share = down[:, None] * across[None, :]
        batch.mask[k] *= 1 - share
        batch.labelled[k] &= share == 0


def covered_share(begin_px: int, end_px: int, cells: int, cell_px: int) -> np.ndarray:
    """Share of each cell of a line that the pixels from `begin_px` up to but not `end_px` cover."""
    first = np.arange(cells) * cell_px
    covered = np.minimum(end_px, first + cell_px) - np.maximum(begin_px, first)
    return np.clip(covered, 0, cell_px).astype(np.float32) / np.float32(cell_px)


def _per_channel(values: np.ndarray) -> torch.Tensor:
    return torch.from_numpy(values.astype(np.float32))[:, :, None, None]
