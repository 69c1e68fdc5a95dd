# SPDX-License-Identifier: Apache-2.0
"""Scenes with a grey object. Each sample of each epoch gets another texture on it."""
from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import torch

from ..batches import Batch
from ..errors import InputError
from ..shards import DEPTH_UNIT_M, NO_LABEL, UV_SCALE
from .network import CANVAS_PX, IMAGE_PX
from .textures import random_texture

CELL_PX = 2  # of the shards: fine enough for the map of the texture
GREY = 160.0  # of the object in the shards
ARRAYS = ("image", "uv", "depth", "mask")


class Scenes:
    """The samples of one folder that sinks/shards wrote with cells of 2 px and a grey texture."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        try:
            content = json.loads((folder / "shards.json").read_text(encoding="utf-8"))
            image, template = content["image"], content["template"]
            wrong = (image["width_px"], image["height_px"], image["cell_px"]) != (*IMAGE_PX, CELL_PX)
            self.size_m = (float(template["width_m"]), float(template["height_m"]))
            self.camera = content["camera"]
        except (OSError, ValueError, KeyError) as error:
            raise InputError(f"{folder}/shards.json: cannot be read ({error}); write the shards again") from None
        if wrong:
            raise InputError(f"{folder}/shards.json: the network needs images of 160 x 120 px and cell_px: 2; write "
                             "the shards again with --set sinks.cell_px=2")
        self.arrays: list[dict[str, np.ndarray]] = []
        for shard in sorted(folder.glob("[0-9]" * 6)):
            self.arrays.append({name: np.load(shard / f"{name}.npy", mmap_mode="r") for name in ARRAYS})
        if not self.arrays:
            raise InputError(f"{folder}: has no shards; write them first")
        self.length = len(self.arrays[0]["image"])
        self.count = sum(len(arrays["image"]) for arrays in self.arrays)
        self.side_m = max(self.size_m)

    def sample(self, index: int) -> dict[str, np.ndarray]:
        """The arrays of one sample."""
        arrays = self.arrays[index // self.length]
        return {name: arrays[name][index % self.length] for name in ARRAYS}


def on_canvas(texture: np.ndarray, side_px: int) -> np.ndarray:
    """The texture in the upper left corner of a square; its border is repeated."""
    height, width = texture.shape[:2]
    scale = side_px / max(height, width)
    small = cv2.resize(texture, (round(width * scale), round(height * scale)), interpolation=cv2.INTER_AREA)
    return cv2.copyMakeBorder(small, 0, side_px - small.shape[0], 0, side_px - small.shape[1], cv2.BORDER_REPLICATE)


def _map_of(uv: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """uv of each pixel; cells without one take that of their neighbours."""
    filled, weight = uv * seen[..., None], seen.astype(np.float32)
    for _ in range(2):
        around = cv2.blur(weight, (3, 3))
        mean = cv2.blur(filled, (3, 3)) / np.maximum(around, 1e-6)[..., None]
        filled = np.where(weight[..., None] > 0, filled, mean)
        weight = ((weight > 0) | (around > 1e-6)).astype(np.float32)
    return cv2.resize(filled, IMAGE_PX, interpolation=cv2.INTER_LINEAR)


def textured(image: np.ndarray, uv: np.ndarray, seen: np.ndarray, mask: np.ndarray, texture: np.ndarray,
             blur_px: float) -> np.ndarray:
    """The image with a texture in place of the grey, f32 [H,W,3], in the same light."""
    height, width = texture.shape[:2]
    there = _map_of(uv, seen)
    step = np.diff(uv, axis=1) * [width, height]
    inside = seen[:, 1:] & seen[:, :-1]
    texels = float(np.median(np.linalg.norm(step[inside], axis=1))) / CELL_PX if inside.any() else 1.0
    sigma = 0.45 * np.hypot(max(texels, 0.3), texels * blur_px)
    smooth = cv2.GaussianBlur(texture, (0, 0), sigma) if sigma > 0.4 else texture
    seen_texture = cv2.remap(smooth, (there[..., 0] * width - 0.5).astype(np.float32),
                             (there[..., 1] * height - 0.5).astype(np.float32), cv2.INTER_LINEAR,
                             borderMode=cv2.BORDER_REPLICATE).astype(np.float32)
    if (image[::7, ::7, 0] == image[::7, ::7, 1]).all():  # a camera without colours
        seen_texture = np.repeat(seen_texture @ np.float32([[0.299], [0.587], [0.114]]), 3, axis=2)
    share = cv2.resize(mask.astype(np.float32), IMAGE_PX, interpolation=cv2.INTER_LINEAR)[..., None]
    return image * (1 + share * (seen_texture / GREY - 1))


class Maker:
    """Batches of scenes with random textures; every draw depends on (seed, step) only."""

    def __init__(self, scenes: list[Scenes], seed: int, pool: int) -> None:
        self.scenes = scenes
        self.pools = [[random_texture(np.random.default_rng([seed, 5, n, k]), s.size_m[0] / s.size_m[1])
                       for k in range(pool)] for n, s in enumerate(scenes)]

    def batch(self, samples: list[tuple[int, int]], random: np.random.Generator) -> tuple[Batch, torch.Tensor]:
        """Samples, given as (folder, index), with a texture each: the batch and the canvases [B,3,96,96]."""
        parts = [self._sample(self.scenes[n], self.pools[n], index, random) for n, index in samples]
        image, canvas, mask, uv, log_depth, labelled = (torch.from_numpy(np.stack(part)) for part in zip(*parts))
        batch = Batch(image.permute(0, 3, 1, 2), mask, uv, log_depth, labelled, torch.zeros(0), torch.zeros(0))
        return batch, canvas.permute(0, 3, 1, 2).float()

    @staticmethod
    def _sample(scenes: Scenes, pool: list[np.ndarray], index: int, random: np.random.Generator) -> tuple:
        sample = scenes.sample(index)
        texture = pool[random.integers(len(pool))]
        texture = texture[:, :, random.permutation(3)]
        if random.random() < 0.5:
            texture = texture[::-1]
        if random.random() < 0.5:
            texture = texture[:, ::-1]
        if random.random() < 0.1:
            texture = 255 - texture
        texture = np.ascontiguousarray(texture)
        uv = sample["uv"].astype(np.float32) / np.float32(UV_SCALE)
        seen = (sample["uv"] != NO_LABEL).all(axis=2) & (sample["depth"] > 0)
        mask = sample["mask"].astype(np.float32) / 255
        blur_px = max(0.0, random.normal(-0.5, 1.5))
        image = textured(sample["image"].astype(np.float32), uv, seen, mask, texture, blur_px)
        quarters = lambda x: x.reshape(x.shape[0] // 2, 2, x.shape[1] // 2, 2, *x.shape[2:])
        labelled = quarters(seen).all(axis=(1, 3))
        shares = np.float32(scenes.size_m) / np.float32(scenes.side_m)
        depth = np.maximum(sample["depth"], 1).astype(np.float32)
        depth_m = quarters(depth).mean(axis=(1, 3)) * np.float32(DEPTH_UNIT_M)
        place = np.moveaxis(quarters(uv).mean(axis=(1, 3)) * shares, 2, 0)
        return (image, on_canvas(texture, CANVAS_PX), quarters(mask).mean(axis=(1, 3)), place,
                np.log(depth_m / np.float32(scenes.side_m)), labelled)
