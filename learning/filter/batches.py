# SPDX-License-Identifier: Apache-2.0
"""Batches of match sets of equal size, with random changes that keep the labels."""
from __future__ import annotations

import numpy as np
import torch

from match_sets import MatchSet


def augmented(rng: np.random.Generator, chosen: MatchSet, count: int) -> dict[str, np.ndarray]:
    """`count` matches of a set, with the image turned and scaled, and values left out, at random."""
    rows = rng.permutation(len(chosen.label))[:count]
    part = chosen.rows(rows)
    turn = rng.uniform(-np.pi, np.pi)
    scale = np.exp(rng.normal(0, 0.2))
    c, s = scale * np.cos(turn), scale * np.sin(turn)
    image = part.image_px @ np.array([[c, s], [-s, c]])
    log_scale, angle = part.log_scale + np.log(scale), part.angle_rad + turn
    label, template = part.label.copy(), part.template_px
    if rng.random() < 0.5:  # template and image mirrored
        template, image, angle = template * [-1, 1], image * [-1, 1], -angle
    if rng.random() < 0.3:  # further mismatches
        more = rng.random(count) < rng.uniform(0, 0.6)
        low, high = image.min(0), image.max(0)
        image[more] = rng.uniform(low, high, (more.sum(), 2))
        log_scale[more] += rng.normal(0, 0.7, more.sum())
        angle[more] = rng.uniform(-np.pi, np.pi, more.sum())
        label[more] = 0
    keeps = rng.random(3) < 0.85 if rng.random() < 0.5 else np.ones(3, bool)
    known = [bool(np.isfinite(values).all()) and keep
             for values, keep in zip((log_scale, angle, part.ratio), keeps)]
    values = [np.where(has, column, 0.0) if has else np.zeros(count)
              for has, column in zip(known, (log_scale, angle, part.ratio))]
    return {"template_px": template, "image_px": image, "log_scale": values[0],
            "angle_rad": values[1], "ratio": values[2], "label": label, "half_diagonal_px": part.half_diagonal_px,
            **{name: [float(has)] for name, has in zip(("has_scale", "has_angle", "has_ratio"), known)}}


def stacked(sets: list[dict[str, np.ndarray]]) -> dict[str, torch.Tensor]:
    """Tensors of sets of equal size."""
    return {name: torch.tensor(np.stack([one[name] for one in sets]).astype(np.float32)) for name in sets[0]}


class Batches:
    """Draws batches of one set size each; large and small sets get the same share of steps."""

    def __init__(self, groups: list[tuple[list[MatchSet], float]], rows: int = 3000):
        self.groups, self.rows = groups, rows
        self.sizes = [np.array([len(one.label) for one in sets]) for sets, _ in groups]
        self.shares = np.array([share for _, share in groups])

    def draw(self, rng: np.random.Generator) -> dict[str, torch.Tensor]:
        """A random batch."""
        count = int(np.exp(rng.uniform(np.log(8), np.log(1000))))
        sets = min(max(self.rows // count, 3), 48)
        drawn = []
        while len(drawn) < sets:
            group = rng.choice(len(self.groups), p=self.shares / self.shares.sum())
            fitting = np.flatnonzero(self.sizes[group] >= count)
            if len(fitting) == 0:
                continue
            # A small set is more often a small frame than a part of a large one.
            near = fitting[self.sizes[group][fitting] < 4 * count]
            pool = near if len(near) > 0 and rng.random() < 0.6 else fitting
            drawn.append(augmented(rng, self.groups[group][0][rng.choice(pool)], count))
        return stacked(drawn)
