# SPDX-License-Identifier: Apache-2.0
"""The network of filters/learned in PyTorch. plugins/filters/learned has the same forward pass in C++.

A batch holds sets of equal size. Names of its arrays: B sets, N matches, C channels, K neighbours.
"""
from __future__ import annotations

import torch
from torch import Tensor, nn

CHANNELS = 64
BLOCKS = 6
STAGES = 3  # logits after each third of the blocks
NEIGHBOURS = 16  # in the template, for votes and shared neighbours
SHARED = 8
LOCAL = 12  # trusted neighbours of a local fit
INPUTS = 15
FIT_INPUTS = 9
RIDGE = (1e-3, 0.03, 0.1)  # of the affine part, the curved part and the local part
RESIDUAL_PX = 0.3  # keeps logarithms of residuals finite


def gather(values: Tensor, index: Tensor) -> Tensor:
    """values [B,N,D] at index [B,N,K]: [B,N,K,D]."""
    b, n, k = index.shape
    flat = index.reshape(b, n * k, 1).expand(-1, -1, values.shape[-1])
    return torch.gather(values, 1, flat).reshape(b, n, k, values.shape[-1])


def nearest(points: Tensor, count: int, among: Tensor | None = None) -> tuple[Tensor, Tensor]:
    """Indices [B,N,K] of the nearest other points, and which of them exist."""
    distance = torch.cdist(points, points)
    n = points.shape[1]
    distance.diagonal(dim1=1, dim2=2).fill_(torch.inf)
    if among is not None:
        distance = distance.masked_fill(~among[:, None, :], torch.inf)
    value, index = distance.topk(min(count, n - 1), dim=2, largest=False, sorted=True)
    return index, torch.isfinite(value)


def frames(template_px: Tensor, image_px: Tensor, half_diagonal_px: Tensor) -> dict[str, Tensor]:
    """Normalised positions. The image is turned by the best rotation from the template."""
    p = (template_px - template_px.mean(1, keepdim=True)) / half_diagonal_px[:, None, None]
    q = image_px - image_px.mean(1, keepdim=True)
    rms_px = q.square().sum(2).mean(1).sqrt().clamp_min(1e-6)
    q = q / rms_px[:, None, None]
    cross = q.transpose(1, 2) @ p
    turn = torch.atan2(cross[:, 1, 0] - cross[:, 0, 1], cross[:, 0, 0] + cross[:, 1, 1])
    c, s = turn.cos(), turn.sin()
    back = torch.stack([torch.stack([c, s], 1), torch.stack([-s, c], 1)], 1)
    return {"p": p, "q": q @ back.transpose(1, 2), "rms_px": rms_px, "turn": turn}


def inputs(batch: dict[str, Tensor]) -> tuple[Tensor, dict[str, Tensor]]:
    """Inputs of the network [B,N,INPUTS] and what the fits need."""
    found = frames(batch["template_px"], batch["image_px"], batch["half_diagonal_px"])
    p, q, rms_px = found["p"], found["q"], found["rms_px"]
    n = p.shape[1]
    has_scale, has_angle, has_ratio = (batch[name] for name in ("has_scale", "has_angle", "has_ratio"))
    scale = (batch["log_scale"] - batch["log_scale"].mean(1, keepdim=True)).clamp(-3, 3) * has_scale
    angle = batch["angle_rad"] - found["turn"][:, None]
    near, _ = nearest(p, NEIGHBOURS)
    both = has_scale * has_angle
    vote = votes(batch, near) * both
    shared_from, _ = nearest(p, SHARED)
    shared_to, _ = nearest(q, SHARED)
    shared = (shared_from[..., :, None] == shared_to[..., None, :]).any(3).float().mean(2)
    one = torch.ones_like(scale)
    size = torch.log(torch.tensor(float(n))) / 5 - 1
    columns = [p[..., 0], p[..., 1], q[..., 0], q[..., 1], scale, angle.sin() * has_angle,
               angle.cos() * has_angle, batch["ratio"] * has_ratio, has_scale * one, has_angle * one,
               has_ratio * one, size * one, vote, shared, torch.log(rms_px / 100)[:, None] * one]
    found.update(scale=scale, angle=angle, has_scale=has_scale, has_angle=has_angle)
    return torch.stack(columns, 2), found


def votes(batch: dict[str, Tensor], near: Tensor) -> Tensor:
    """How many neighbours are where scale and angle of the match put them: mean over K, [B,N]."""
    template_px, image_px = batch["template_px"], batch["image_px"]
    away = gather(template_px, near) - template_px[:, :, None]
    moved = gather(image_px, near) - image_px[:, :, None]
    size = batch["log_scale"].clamp(-6, 6).exp()
    c, s = (size * batch["angle_rad"].cos())[..., None], (size * batch["angle_rad"].sin())[..., None]
    du = moved[..., 0] - (c * away[..., 0] - s * away[..., 1])
    dv = moved[..., 1] - (s * away[..., 0] + c * away[..., 1])
    reach2 = (size[..., None] ** 2) * away.square().sum(3) + 4.0
    return torch.exp(-(du * du + dv * dv) / (0.16 * reach2)).mean(2)


def curved_basis(p: Tensor) -> Tensor:
    """1, x, y and the monomials of second and third order: [B,N,10]."""
    x, y = p[..., 0], p[..., 1]
    return torch.stack([torch.ones_like(x), x, y, x * x, x * y, y * y, x**3, x * x * y, x * y * y, y**3], 2)


def global_fit(basis: Tensor, q: Tensor, weight: Tensor, ridge: Tensor) -> tuple[Tensor, Tensor]:
    """Coefficients [B,D,2] of a weighted ridge regression, and residuals [B,N,2] without the match itself."""
    weighted = basis * weight[..., None]
    normal = weighted.transpose(1, 2) @ basis + torch.diag(ridge)
    inverse = torch.linalg.inv(normal.double()).float()
    coefficients = inverse @ (weighted.transpose(1, 2) @ q)
    leverage = ((basis @ inverse) * weighted).sum(2).clamp(0, 0.95)
    residual = (q - basis @ coefficients) / (1 - leverage)[..., None]
    return coefficients, residual


def local_fit(p: Tensor, residual: Tensor, weight: Tensor, among: Tensor) -> Tensor:
    """What remains of residuals [B,N,2] beside an affine map of those of trusted neighbours."""
    near, exists = nearest(p, LOCAL, among)
    away = gather(p, near) - p[:, :, None]
    w = gather(weight[..., None], near)[..., 0] * exists
    reach2 = (away.square().sum(3) * exists).amax(2, keepdim=True).clamp_min(1e-8)[..., None]
    basis = torch.cat([torch.ones_like(away[..., :1]), away / reach2.sqrt()], 3)  # [B,N,K,3]
    weighted = basis * w[..., None]
    ridge = torch.diag(torch.tensor([RIDGE[2], 3 * RIDGE[2], 3 * RIDGE[2]]))
    normal = weighted.transpose(2, 3) @ basis + ridge
    right = weighted.transpose(2, 3) @ gather(residual, near)
    # The map at the match itself is its constant part.
    constant = torch.linalg.solve(normal, right)[..., 0, :]
    return residual - constant


def fit_inputs(found: dict[str, Tensor], logit: Tensor) -> Tensor:
    """Inputs [B,N,FIT_INPUTS] from fits to the matches, weighted by a logit [B,N]."""
    p, q, rms_px = found["p"], found["q"], found["rms_px"]
    weight = torch.sigmoid(logit)
    basis = curved_basis(p)
    ridge = torch.full((10,), RIDGE[1])
    ridge[:3] = RIDGE[0]
    _, affine = global_fit(basis[..., :3], q, weight, ridge[:3])
    coefficients, curved = global_fit(basis, q, weight, ridge)
    local = local_fit(p, curved, weight, weight.detach() >= weight.detach().mean(1, keepdim=True))
    columns = []
    total = weight.sum(1, keepdim=True) + 1e-6
    for residual in (affine, curved, local):
        px = (residual.square().sum(2) + 1e-12).sqrt() * rms_px[:, None]
        sigma = ((weight * px * px).sum(1, keepdim=True) / total).sqrt()
        columns += [torch.log((px + RESIDUAL_PX) / 3), torch.log((px + RESIDUAL_PX) / (sigma + RESIDUAL_PX))]
    columns += orientation(found, p, coefficients)
    columns.append(weight)
    return torch.stack(columns, 2)


def orientation(found: dict[str, Tensor], p: Tensor, coefficients: Tensor) -> list[Tensor]:
    """Disagreement of the keypoints' angles and scales with the slope of the curved map."""
    x, y = p[..., :1], p[..., 1:]
    a = coefficients[:, None]  # [B,1,10,2]
    du = a[:, :, 1] + 2 * x * a[:, :, 3] + y * a[:, :, 4] + 3 * x * x * a[:, :, 6] \
        + 2 * x * y * a[:, :, 7] + y * y * a[:, :, 8]
    dv = a[:, :, 2] + x * a[:, :, 4] + 2 * y * a[:, :, 5] + x * x * a[:, :, 7] \
        + 2 * x * y * a[:, :, 8] + 3 * y * y * a[:, :, 9]
    c, s = du[..., 0] + dv[..., 1], du[..., 1] - dv[..., 0]
    length = (c * c + s * s + 1e-12).sqrt()
    cosine = (found["angle"].cos() * c + found["angle"].sin() * s) / length
    size = torch.log(length.clamp_min(1e-4))
    gap = found["scale"] - size
    middle = gap.detach().median(1, keepdim=True).values
    return [cosine * found["has_angle"], (gap - middle).abs().clamp(0, 3) * found["has_scale"]]


class Block(nn.Module):
    """Linear map, context normalisation with attention, ReLU, added to its input."""

    def __init__(self) -> None:
        super().__init__()
        self.linear = nn.Linear(CHANNELS, CHANNELS, bias=False)  # the mean is subtracted
        self.attention = nn.Linear(CHANNELS, 1)
        self.gain = nn.Parameter(torch.ones(CHANNELS))
        self.shift = nn.Parameter(torch.zeros(CHANNELS))

    def forward(self, h: Tensor) -> Tensor:
        x = self.linear(h)
        weight = torch.sigmoid(self.attention(h)) + 1e-6
        weight = weight / weight.sum(1, keepdim=True)
        mean = (weight * x).sum(1, keepdim=True)
        x = x - mean
        variance = (weight * x * x).sum(1, keepdim=True)
        return h + torch.relu(x * torch.rsqrt(variance + 1e-3) * self.gain + self.shift)


class Network(nn.Module):
    """Logits [B,N] of each stage; the last one decides.

    Without `geometry`, for comparison, there are no fits and no inputs from neighbours.
    """

    def __init__(self, geometry: bool = True) -> None:
        super().__init__()
        self.geometry = geometry
        self.input = nn.Linear(INPUTS, CHANNELS)
        self.blocks = nn.ModuleList(Block() for _ in range(BLOCKS))
        self.heads = nn.ModuleList(nn.Linear(CHANNELS, 2) for _ in range(STAGES))
        self.fits = nn.ModuleList(nn.Linear(FIT_INPUTS, CHANNELS) for _ in range(STAGES - 1))

    def forward(self, batch: dict[str, Tensor]) -> list[Tensor]:
        columns, found = inputs(batch)
        if not self.geometry:
            columns = torch.cat([columns[..., :12], 0 * columns[..., 12:14], columns[..., 14:]], 2)
        h = self.input(columns)
        logits = []
        for k, block in enumerate(self.blocks):
            h = block(h)
            if (k + 1) % (BLOCKS // STAGES) != 0:
                continue
            stage = k // (BLOCKS // STAGES)
            out = self.heads[stage](h)
            logits.append(out[..., 0])
            if stage + 1 < STAGES and self.geometry:
                h = h + self.fits[stage](fit_inputs(found, out[..., 1]))
        return logits


def loss_of(logits: list[Tensor], label: Tensor) -> Tensor:
    """Cross entropy in which each set, and each class in it, has the same weight."""
    right, wrong = (label == 1).float(), (label == 0).float()
    right = right / right.sum(1, keepdim=True).clamp_min(1)
    wrong = wrong / wrong.sum(1, keepdim=True).clamp_min(1)
    total = torch.zeros(())
    for stage, logit in enumerate(logits):
        entropy = right * nn.functional.softplus(-logit) + wrong * nn.functional.softplus(logit)
        total = total + (1.0 if stage + 1 == len(logits) else 0.3) * entropy.sum(1).mean()
    return total
