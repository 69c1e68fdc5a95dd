# SPDX-License-Identifier: Apache-2.0
"""Metrics of a network on validation or test samples, in the units of a user."""

import numpy as np
import torch

from .batches import read_batch
from .losses import LOG_ERROR_RANGE, Grid, points, uv_error, visible_cells
from .network import RegistrationNetwork
from .shards import Shards

EMPTY_CELLS = 0.01  # share of cells below which a mask counts as empty
CHUNK = 32  # samples for each call of the network


def evaluate(network: RegistrationNetwork, shards: Shards, indices: np.ndarray) -> dict[str, float]:
    """Metrics over the samples with these indices; NaN where there is nothing to measure."""
    training = network.training
    network.eval()
    grid = Grid.of(shards.description)
    found: dict[str, list[np.ndarray]] = {}
    with torch.no_grad():
        for begin in range(0, len(indices), CHUNK):
            for name, values in _measure(network, shards, indices[begin:begin + CHUNK], grid).items():
                found.setdefault(name, []).append(values.numpy())
    network.train(training)
    return _summary({name: np.concatenate(values) for name, values in found.items()})


def _measure(network: RegistrationNetwork, shards: Shards, indices: np.ndarray, grid: Grid) -> dict[str, torch.Tensor]:
    """Single values of some samples."""
    batch = read_batch(shards, indices)
    cells, vertices = network(batch.image)
    answered, true = cells[:, 0] > 0, batch.mask > 0.5
    seen = answered & batch.labelled
    scale_mm = 1000 * torch.tensor([grid.width_m, grid.height_m])[:, None, None]
    uv_mm = torch.linalg.vector_norm((cells[:, 1:3] - batch.uv) * scale_mm, dim=1)
    visible = visible_cells(batch)
    present = batch.weight.amax(dim=1) > 0
    away_mm = 1000 * torch.linalg.vector_norm(points(vertices) - points(batch.vertices), dim=1)
    return {
        "intersection": (answered & true).sum(dim=(1, 2)), "union": (answered | true).sum(dim=(1, 2)),
        "uv_mm": uv_mm[seen], "depth_error": (cells[:, 4] - batch.log_depth).abs()[seen],
        "uv_error": uv_error(cells, batch.uv, grid.aspect)[visible],
        "uv_expected": cells[:, 3].clamp(*LOG_ERROR_RANGE).exp()[visible],
        "vertex_mm": away_mm[present].reshape(-1),
        "vertex_visible_mm": away_mm[batch.weight == 1],
        "false_share": answered[~present].float().mean(dim=(1, 2)),
    }


def _summary(found: dict[str, np.ndarray]) -> dict[str, float]:
    def quantile(name: str, share: float) -> float:
        return float(np.quantile(found[name], share)) if found[name].size else float("nan")

    def mean(values: np.ndarray) -> float:
        return float(values.mean()) if values.size else float("nan")

    union, expected = found["union"].sum(), found["uv_expected"].sum(dtype=np.float64)
    return {
        "samples": len(found["union"]),
        "iou": float(found["intersection"].sum() / union) if union else float("nan"),
        "uv_median_mm": quantile("uv_mm", 0.5), "uv_p90_mm": quantile("uv_mm", 0.9),
        "depth_median_percent": 100 * quantile("depth_error", 0.5),
        "vertex_mean_mm": mean(found["vertex_mm"]), "vertex_median_mm": quantile("vertex_mm", 0.5),
        "vertex_visible_median_mm": quantile("vertex_visible_mm", 0.5),
        "empty_share": mean((found["false_share"] < EMPTY_CELLS).astype(float)),
        "uv_error_factor": float(found["uv_error"].sum(dtype=np.float64) / expected) if expected else float("nan"),
    }
