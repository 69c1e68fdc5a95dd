# SPDX-License-Identifier: Apache-2.0
"""Random textures of several kinds: blobs, prints, fine grain, weak contrast and repeated details."""
from __future__ import annotations

import cv2
import numpy as np

KINDS = ("blobs", "print", "grain", "weak", "repeated", "stripes")
SHARES = (0.12, 0.24, 0.12, 0.26, 0.22, 0.04)  # of the scenes


def smooth_noise(rng: np.random.Generator, size: tuple[int, int], sigma_px: float) -> np.ndarray:
    """Blurred noise of mean 0 and standard deviation 1."""
    noise = cv2.GaussianBlur(rng.normal(0, 1, size), (0, 0), sigma_px)
    return (noise - noise.mean()) / noise.std()


def glyph(rng: np.random.Generator, side_px: int) -> np.ndarray:
    """A small random drawing on white."""
    image = np.full((side_px, side_px), 255, np.uint8)
    for _ in range(rng.integers(2, 6)):
        ends = rng.integers(0, side_px, (2, 2))
        cv2.line(image, tuple(map(int, ends[0])), tuple(map(int, ends[1])), int(rng.integers(0, 160)),
                 int(rng.integers(1, 4)), cv2.LINE_AA)
    centre = tuple(map(int, rng.integers(0, side_px, 2)))
    cv2.circle(image, centre, int(rng.integers(2, max(3, side_px // 3))), int(rng.integers(0, 200)), 2, cv2.LINE_AA)
    return image


def mark(rng: np.random.Generator, grey: np.ndarray, level: float) -> None:
    """Draws a small disc, ring, cross or triangle at a random place."""
    at = rng.uniform(0.03, 0.97, 2) * grey.shape[::-1]
    centre, radius = tuple(map(int, at)), int(rng.integers(3, 14))
    turn = rng.uniform(0, 2 * np.pi)
    shape = rng.integers(4)
    ends = lambda count: [tuple(map(int, at + radius * np.array([np.cos(turn + a), np.sin(turn + a)])))
                          for a in np.arange(count) * 2 * np.pi / count]
    if shape < 2:
        cv2.circle(grey, centre, radius, level, -1 if shape == 0 else 2, cv2.LINE_AA)
    elif shape == 2:
        a, b, c, d = ends(4)
        cv2.line(grey, a, c, level, 2, cv2.LINE_AA)
        cv2.line(grey, b, d, level, 2, cv2.LINE_AA)
    else:
        cv2.fillPoly(grey, [np.array(ends(3))], level, cv2.LINE_AA)


def texture(kind: str, seed: int) -> np.ndarray:
    """A grey image of about 850 x 600 px."""
    rng = np.random.default_rng(seed)
    height, width = int(rng.integers(480, 680)), int(rng.integers(760, 920))
    size = (height, width)
    if kind == "blobs":
        grey = 128 + 60 * smooth_noise(rng, size, rng.uniform(5, 16)) + 15 * smooth_noise(rng, size, 3)
    elif kind == "grain":
        grey = 128 + 40 * smooth_noise(rng, size, rng.uniform(1.5, 3)) + 30 * smooth_noise(rng, size, 12)
    elif kind == "weak":
        grey = 190 + rng.uniform(4, 12) * smooth_noise(rng, size, rng.uniform(10, 60))
        for _ in range(rng.integers(8, 60)):
            mark(rng, grey, float(rng.uniform(40, 170)))
    else:
        grey = np.full(size, 235.0) + 8 * smooth_noise(rng, size, 20)
        side = int(rng.integers(28, 64))
        glyphs = [glyph(rng, side) for _ in range(int(rng.integers(1, 3)) if kind == "repeated" else 60)]
        for row, y in enumerate(range(0, height - side, side + 6)):
            for column, x in enumerate(range(0, width - side, side + 6)):
                which = (row + column) % len(glyphs) if kind == "repeated" else rng.integers(len(glyphs))
                grey[y:y + side, x:x + side] -= 255.0 - glyphs[which]
        if kind == "stripes":
            u = np.arange(width)[None] + 0.4 * np.arange(height)[:, None]
            grey += 40 * np.sign(np.sin(2 * np.pi * u / rng.uniform(14, 40)))
        if kind == "repeated":  # a few marks tell places apart
            for _ in range(rng.integers(0, 16)):
                mark(rng, grey, float(rng.uniform(20, 160)))
    return np.clip(grey, 0, 255).astype(np.uint8)
