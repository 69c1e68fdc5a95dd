# SPDX-License-Identifier: Apache-2.0
"""Writes shards of a flat textured rectangle under random poses, with labels that are exact by construction."""

import json
from pathlib import Path

import cv2
import numpy as np

WIDTH_PX, HEIGHT_PX, CELL_PX = 160, 120, 4
CELL_COLUMNS, CELL_ROWS = WIDTH_PX // CELL_PX, HEIGHT_PX // CELL_PX
WIDTH_M, HEIGHT_M = 0.297, 0.1782
COLUMNS, ROWS = 10, 7
CAMERA = np.array([[205.0, 0, 79.5], [0, 205.0, 59.5], [0, 0, 1]])
FINER = 4  # times the small image, before area averaging
ABSENT, BACK = 0.1, 0.05  # shares of samples without the object and with its back side


def describe(frames: int | None) -> dict:
    """Content of shards.json."""
    return {"format": "weft.shards/1", "frames": frames,
            "image": {"width_px": WIDTH_PX, "height_px": HEIGHT_PX, "cell_px": CELL_PX},
            "camera": {"fx": CAMERA[0, 0], "fy": CAMERA[1, 1], "cx": CAMERA[0, 2], "cy": CAMERA[1, 2]},
            "template": {"width_m": WIDTH_M, "height_m": HEIGHT_M, "columns": COLUMNS, "rows": ROWS,
                         "texture_hash": "0123456789abcdef"}}


def cell_centres_px() -> tuple[np.ndarray, np.ndarray]:
    """x and y of the centres of all cells in the small image, [R,C] each: pixel centres at integers."""
    x = CELL_PX * np.arange(CELL_COLUMNS) + (CELL_PX - 1) / 2
    y = CELL_PX * np.arange(CELL_ROWS) + (CELL_PX - 1) / 2
    return tuple(np.meshgrid(x, y))


def random_texture(random: np.random.Generator) -> np.ndarray:
    """Coloured blobs of several sizes, u8 [357,594,3]."""
    texture = np.zeros((357, 594, 3), np.float32)
    for cells in (3, 8, 20):
        texture += cv2.resize(random.uniform(0, 90, (cells, 2 * cells, 3)).astype(np.float32), (594, 357),
                              interpolation=cv2.INTER_CUBIC)
    return np.clip(texture, 0, 255).astype(np.uint8)


def random_pose(random: np.random.Generator, tilt_rad: float = 0.4) -> np.ndarray:
    """Columns: camera-frame directions of the template's x and y, and its origin (m), [3,3]."""
    rotation = cv2.Rodrigues(np.append(random.normal(0, tilt_rad, 2), random.normal(0, 0.3)))[0]
    z = random.uniform(0.35, 0.7)
    centre = np.array([random.uniform(-0.2, 0.2) * z, random.uniform(-0.15, 0.15) * z, z])
    origin = centre - rotation[:, :2] @ [WIDTH_M / 2, HEIGHT_M / 2]
    return np.column_stack([rotation[:, :2], origin])


def _finer() -> np.ndarray:
    """Maps px of the small image to px of the finer one."""
    half = (FINER - 1) / 2
    return np.array([[FINER, 0, half], [0, FINER, half], [0, 0, 1.0]])


def render(texture: np.ndarray | None, pose: np.ndarray, background: np.ndarray, random: np.random.Generator,
           back: bool = False) -> dict[str, np.ndarray]:
    """One sample: image and labels. `texture` None: no object."""
    size = (WIDTH_PX * FINER, HEIGHT_PX * FINER)
    image, cover = background.astype(np.float32), np.zeros(size[::-1], np.float32)
    if texture is not None:
        height, width = texture.shape[:2]
        # Texel t covers [t, t+1] of the texture's length; its centre is t + 0.5.
        to_m = np.array([[WIDTH_M / width, 0, 0.5 * WIDTH_M / width], [0, HEIGHT_M / height, 0.5 * HEIGHT_M / height],
                         [0, 0, 1]])
        warp = _finer() @ CAMERA @ pose @ to_m
        shown = np.full_like(texture, 200) if back else texture
        paper = cv2.warpPerspective(shown.astype(np.float32), warp, size, flags=cv2.INTER_LINEAR,
                                    borderMode=cv2.BORDER_REPLICATE)
        cover = cv2.warpPerspective(np.ones((height, width), np.float32), warp, size, flags=cv2.INTER_NEAREST)
        image = np.where(cover[..., None] > 0, paper, image)
    small = cv2.resize(image, (WIDTH_PX, HEIGHT_PX), interpolation=cv2.INTER_AREA) + random.normal(0, 2)
    share = cv2.resize(cover, (CELL_COLUMNS, CELL_ROWS), interpolation=cv2.INTER_AREA)
    sample = {"image": np.clip(np.rint(small), 0, 255).astype(np.uint8),
              "mask": np.rint(255 * share * (not back)).astype(np.uint8)}
    return {**sample, **_labels(pose, texture is not None, back)}


def _labels(pose: np.ndarray, present: bool, back: bool) -> dict[str, np.ndarray]:
    uv = np.full((CELL_ROWS, CELL_COLUMNS, 2), 65535, np.uint16)
    depth = np.zeros((CELL_ROWS, CELL_COLUMNS), np.uint16)
    vertices = np.full((ROWS * COLUMNS, 3), np.nan, np.float32)
    visible = np.zeros(ROWS * COLUMNS, np.uint8)
    if not present:
        return {"uv": uv, "depth": depth, "vertices_m": vertices, "visible": visible}
    x, y = np.meshgrid(np.linspace(0, WIDTH_M, COLUMNS), np.linspace(0, HEIGHT_M, ROWS))
    vertices = (np.stack([x.ravel(), y.ravel(), np.ones(x.size)], 1) @ pose.T).astype(np.float32)
    if not back:
        px = vertices @ CAMERA.T
        px = px[:, :2] / px[:, 2:]
        visible = ((px >= -0.5) & (px <= np.array([WIDTH_PX, HEIGHT_PX]) - 0.5)).all(axis=1).astype(np.uint8)
        sx, sy = cell_centres_px()
        plane = np.stack([sx, sy, np.ones_like(sx)], 2) @ np.linalg.inv(CAMERA @ pose).T
        at = plane[..., :2] / plane[..., 2:]
        share = at / [WIDTH_M, HEIGHT_M]
        inside = ((share >= 0) & (share <= 1)).all(axis=2)
        uv[inside] = np.rint(65534 * share[inside]).astype(np.uint16)
        depth[inside] = np.rint(1e4 / plane[..., 2][inside]).astype(np.uint16)
    return {"uv": uv, "depth": depth, "vertices_m": vertices, "visible": visible}


def random_sample(random: np.random.Generator, texture: np.ndarray) -> dict[str, np.ndarray]:
    """A sample with a random pose, background and side."""
    coarse = random.uniform(0, 255, (6, 8, 3)).astype(np.float32)
    background = cv2.resize(coarse, (WIDTH_PX * FINER, HEIGHT_PX * FINER), interpolation=cv2.INTER_LINEAR)
    kind = random.random()
    shown = None if kind < ABSENT else texture
    return render(shown, random_pose(random), background, random, back=ABSENT <= kind < ABSENT + BACK)


def write_shard(folder: Path, samples: list[dict[str, np.ndarray]]) -> None:
    """Writes one shard; its folder appears whole."""
    part = folder.with_name(folder.name + ".part")
    part.mkdir()
    for name in samples[0]:
        np.save(part / f"{name}.npy", np.stack([sample[name] for sample in samples]))
    part.rename(folder)


def write_shards(folder: Path, frames: int, seed: int, length: int = 128, written: int | None = None) -> None:
    """Writes `frames` samples in shards of `length`, or only the first `written` shards of them."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "make.yaml").write_text(f"# synthetic rectangle, seed {seed}\n")
    complete = written is None or written * length >= frames
    (folder / "shards.json").write_text(json.dumps(describe(frames if complete else None)))
    texture = random_texture(np.random.default_rng([seed, 0]))
    for number, begin in enumerate(range(0, frames, length)):
        if written is not None and number >= written:
            break
        write_shard(folder / f"{number:06d}", [random_sample(np.random.default_rng([seed, 1, k]), texture)
                                               for k in range(begin, min(begin + length, frames))])


if __name__ == "__main__":
    import sys
    write_shards(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), 1024)
