# SPDX-License-Identifier: Apache-2.0
"""The loss: likelihoods of mask, texture coordinates and depth, and distances of vertices and edges."""

import dataclasses

import torch
from torch.nn import functional

from .batches import Batch
from .shards import Description

PARTS = {"mask": 1.0, "uv": 0.3, "depth": 0.15, "vertices": 10.0, "edges": 0.1}  # name -> weight
LOG_ERROR_RANGE = (-6.0, 2.0)
VISIBLE_SHARE = 0.5  # of a cell, from which uv and depth count
LOG_DEPTH_RANGE = (-5.0, 5.0)  # An untrained head must not overflow.


@dataclasses.dataclass(frozen=True)
class Grid:
    """Regular grid of vertices over the template."""

    columns: int
    rows: int
    width_m: float
    height_m: float

    @staticmethod
    def of(description: Description) -> "Grid":
        """The grid that the shards describe."""
        return Grid(description.columns, description.rows, description.width_m, description.height_m)

    @property
    def aspect(self) -> float:
        """Height over width."""
        return self.height_m / self.width_m


def visible_cells(batch: Batch) -> torch.Tensor:
    """Cells whose uv and depth count, [B,R,C]."""
    return batch.labelled & (batch.mask > VISIBLE_SHARE)


def uv_error(cells: torch.Tensor, uv: torch.Tensor, aspect: float) -> torch.Tensor:
    """Mean absolute error of both coordinates as a share of the template's width, [B,R,C]."""
    error = (cells[:, 1:3] - uv).abs()
    return 0.5 * (error[:, 0] + error[:, 1] * aspect)


def points(vertices: torch.Tensor) -> torch.Tensor:
    """Points in m from (X/Z, Y/Z, ln Z), [B,3,V]."""
    z = vertices[:, 2:].clamp(*LOG_DEPTH_RANGE).exp()
    return torch.cat([vertices[:, :2] * z, z], 1)


def _edge_strain(predicted: torch.Tensor, true: torch.Tensor, present: torch.Tensor, grid: Grid) -> torch.Tensor:
    """Mean error of the lengths of the grid's edges, relative to their length at rest."""
    shape = (-1, 3, grid.rows, grid.columns)
    predicted, true = points(predicted).view(shape), points(true).view(shape)
    total = predicted.new_zeros(len(predicted))
    steps = ((3, grid.width_m / (grid.columns - 1)), (2, grid.height_m / (grid.rows - 1)))
    for axis, rest_m in steps:
        lengths = [torch.linalg.vector_norm(torch.diff(p, dim=axis), dim=1) for p in (predicted, true)]
        total = total + 0.5 * ((lengths[0] - lengths[1]).abs() / rest_m).mean(dim=(1, 2))
    return (total * present).sum() / present.sum().clamp(min=1)


def loss_parts(cells: torch.Tensor, vertices: torch.Tensor, batch: Batch, grid: Grid) -> dict[str, torch.Tensor]:
    """Each part of the loss, without its weight."""
    visible = visible_cells(batch).float()
    count = visible.sum().clamp(min=1)
    log_uv = cells[:, 3].clamp(*LOG_ERROR_RANGE)
    log_depth = cells[:, 5].clamp(*LOG_ERROR_RANGE)
    uv = 2 * (uv_error(cells, batch.uv, grid.aspect) * torch.exp(-log_uv) + log_uv)
    depth = (cells[:, 4] - batch.log_depth).abs() * torch.exp(-log_depth) + log_depth
    weight = batch.weight[:, None]
    distance = (vertices - batch.vertices).abs() * weight
    present = (batch.weight.amax(dim=1) > 0).float()
    return {
        "mask": functional.binary_cross_entropy_with_logits(cells[:, 0], batch.mask),
        "uv": (uv * visible).sum() / count,
        "depth": (depth * visible).sum() / count,
        "vertices": distance.sum() / (3 * weight.sum()).clamp(min=1),
        "edges": _edge_strain(vertices, batch.vertices, present, grid),
    }


def total(parts: dict[str, torch.Tensor]) -> torch.Tensor:
    """The weighted sum of all parts."""
    return sum(weight * parts[name] for name, weight in PARTS.items())
