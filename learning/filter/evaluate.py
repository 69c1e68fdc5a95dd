# SPDX-License-Identifier: Apache-2.0
"""The area under the mean ROC curve over sets, as `weft report` has it: each set has the same weight."""
from __future__ import annotations

import numpy as np
import torch

from batches import stacked
from match_sets import MatchSet

FEWEST = 4


def tensors(one: MatchSet) -> dict[str, torch.Tensor]:
    """A batch of one whole set."""
    known = [bool(np.isfinite(values).all()) for values in (one.log_scale, one.angle_rad, one.ratio)]
    columns = [values if has else np.zeros(len(values))
               for has, values in zip(known, (one.log_scale, one.angle_rad, one.ratio))]
    names = ("scale", "angle", "ratio")
    return stacked([{"template_px": one.template_px, "image_px": one.image_px, "log_scale": columns[0],
                     "angle_rad": columns[1], "ratio": columns[2], "label": one.label,
                     "half_diagonal_px": one.half_diagonal_px,
                     **{f"has_{name}": [float(has)] for name, has in zip(names, known)}}])


def scores_of(network: torch.nn.Module, one: MatchSet) -> np.ndarray:
    """Logits; the lowest possible where there are too few matches."""
    if len(one.label) < FEWEST:
        return np.full(len(one.label), -1e3)
    with torch.no_grad():
        return network(tensors(one))[-1][0].numpy()


def area_percent(network: torch.nn.Module, sets: list[MatchSet]) -> float:
    """Area under the curve of mean rejected mismatches over mean rejected inliers."""
    thresholds = np.concatenate([[-1e4], np.linspace(-14, 14, 281), [1e4]])
    wrong, right = [], []
    for one in sets:
        logit = scores_of(network, one)
        for label, curves in ((0, wrong), (1, right)):
            chosen = np.sort(logit[one.label == label])
            if len(chosen) > 0:
                curves.append(np.searchsorted(chosen, thresholds) / len(chosen))
    return round(float(100 * np.trapz(np.mean(wrong, 0), np.mean(right, 0))), 3)
