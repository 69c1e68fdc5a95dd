# SPDX-License-Identifier: Apache-2.0
"""Random textures: documents, forms, graphics and images like photographs."""
from __future__ import annotations

import cv2
import numpy as np

LONGEST_PX = 320  # longer side


def _colour(random: np.random.Generator, low: float = 0, high: float = 255) -> tuple[float, ...]:
    if random.random() < 0.4:
        return (float(random.uniform(low, high)),) * 3
    return tuple(map(float, random.uniform(low, high, 3)))


def _cloud(random: np.random.Generator, height: int, width: int, cells: int) -> np.ndarray:
    """Smooth noise, 0 to 1, in three channels."""
    coarse = random.uniform(0, 1, (max(2, cells * height // max(height, width)), max(2, cells), 3)).astype(np.float32)
    return np.clip(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC), 0, 1)


def _photograph(random: np.random.Generator, image: np.ndarray) -> None:
    """Fills an image with clouds of several sizes and some shapes."""
    height, width = image.shape[:2]
    weights = random.dirichlet([1.0, 1.0, 0.7])
    total = sum(w * _cloud(random, height, width, c) for w, c in zip(weights, (3, 8, 24)))
    low, high = np.array(_colour(random)), np.array(_colour(random))
    image[:] = low + (high - low) * np.clip(1.8 * total - 0.4, 0, 1)
    _graphics(random, image, int(random.integers(0, 8)))


def _graphics(random: np.random.Generator, image: np.ndarray, count: int) -> None:
    height, width = image.shape[:2]
    for _ in range(count):
        x, y = int(random.integers(0, width)), int(random.integers(0, height))
        size, colour = int(max(height, width) * random.uniform(0.02, 0.25)), _colour(random)
        thick = -1 if random.random() < 0.6 else int(random.integers(1, 6))
        kind = random.integers(4)
        if kind == 0:
            high = int(size * random.uniform(0.2, 1.5))
            cv2.rectangle(image, (x, y), (x + size, y + high), colour, thick, cv2.LINE_AA)
        elif kind == 1:
            cv2.ellipse(image, (x, y), (size // 2, max(1, int(size * random.uniform(0.1, 0.5)))),
                        float(random.uniform(0, 180)), 0, 360, colour, thick, cv2.LINE_AA)
        elif kind == 2:
            corners = np.rint([x, y] + random.uniform(-size, size, (int(random.integers(3, 7)), 2))).astype(np.int32)
            cv2.fillPoly(image, [corners], colour, cv2.LINE_AA)
        else:
            word = "".join(random.choice(list("ABCDEFGHKLMNPRSTUVWXYZ0123456789"), random.integers(1, 7)))
            cv2.putText(image, word, (x, y), int(random.integers(0, 8)), size / 30, colour, 1 + size // 20, cv2.LINE_AA)


def _lines(random: np.random.Generator, image: np.ndarray, box: tuple[int, int, int, int], ink: tuple) -> None:
    """Lines of text in a box (left, top, right, bottom): small letters become grey strokes."""
    left, top, right, bottom = box
    pitch = random.uniform(4, 11)
    y = top + pitch
    while y < bottom:
        if random.random() < 0.08:
            y += pitch
            continue
        end = right if random.random() < 0.75 else left + random.uniform(0.2, 0.95) * (right - left)
        x = left + (random.uniform(0, 12) if random.random() < 0.1 else 0)
        while x < end:
            length = random.uniform(2, 9) * pitch * 0.45
            if x + length > end:
                break
            height = pitch * 0.5 * random.uniform(0.7, 1)
            cv2.rectangle(image, (int(x), int(y - height)), (int(x + length), int(y)), ink, -1)
            x += length + pitch * 0.4
        y += pitch


def _document(random: np.random.Generator, image: np.ndarray) -> None:
    height, width = image.shape[:2]
    image[:] = _colour(random, 215, 255)
    margin = int(width * random.uniform(0.02, 0.12))
    ink = _colour(random, 60, 170)
    columns = int(random.choice([1, 1, 1, 2, 3]))
    y = margin
    if random.random() < 0.5:  # a coloured head
        high = int(height * random.uniform(0.05, 0.2))
        cv2.rectangle(image, (0, 0), (width, high), _colour(random), -1)
        _graphics(random, image[:high], int(random.integers(1, 4)))
        y = high + 4
    while y < height - margin:
        high = int(height * random.uniform(0.06, 0.35))
        step = (width - 2 * margin) // columns
        for k in range(columns):
            box = (margin + k * step, y, margin + (k + 1) * step - 5, min(height - margin, y + high))
            part = image[box[1]:box[3], box[0]:box[2]]
            kind = random.random()
            if part.shape[0] < 8 or part.shape[1] < 12:
                continue
            if kind < 0.55:
                _lines(random, image, box, ink)
            elif kind < 0.75:
                filled = part.copy()
                _photograph(random, filled)
                part[:] = filled
            elif kind < 0.88:  # a table
                rows, cells = int(random.integers(2, 9)), int(random.integers(2, 6))
                for r in range(rows + 1):
                    row = box[1] + r * (box[3] - box[1]) // rows
                    cv2.line(image, (box[0], row), (box[2], row), ink, 1)
                for c in range(cells + 1):
                    column = box[0] + c * (box[2] - box[0]) // cells
                    cv2.line(image, (column, box[1]), (column, box[3]), ink, 1)
                    if c < cells and random.random() < 0.7:
                        right = column + (box[2] - box[0]) // cells - 3
                        _lines(random, image, (column + 2, box[1], right, box[3]), ink)
            elif kind < 0.95:  # a heading
                letters = list("abcdefghiklmnoprstuvwxyzABCDEFGHKLMNPRST  ")
                word = "".join(random.choice(letters, random.integers(4, 20)))
                cv2.putText(part, word, (0, part.shape[0] // 2), int(random.integers(0, 8)), random.uniform(0.3, 1.2),
                            _colour(random, 0, 130), int(random.integers(1, 3)), cv2.LINE_AA)
        y += high + int(random.integers(0, 12))
    _graphics(random, image, int(random.choice([0, 0, 1, 2, 4])))


def random_texture(random: np.random.Generator, aspect: float) -> np.ndarray:
    """One texture, u8 RGB; `aspect` is width / height, the longer side has LONGEST_PX."""
    width, height = round(LONGEST_PX * min(1, aspect)), round(LONGEST_PX * min(1, 1 / aspect))
    image = np.zeros((height, width, 3), np.float32)
    kind = random.random()
    if kind < 0.5:
        _document(random, image)
    elif kind < 0.75:
        _photograph(random, image)
    else:
        image[:] = _colour(random, 120, 255)
        _graphics(random, image, int(random.integers(8, 60)))
    if random.random() < 0.3:  # weak or strong contrast
        image = 128 + (image - 128) * random.uniform(0.4, 1.3) + random.uniform(-30, 30)
    return np.clip(image, 0, 255).astype(np.uint8)
