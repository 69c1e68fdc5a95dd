# SPDX-License-Identifier: Apache-2.0
"""A registration network for any texture: the texture is its second input."""
from __future__ import annotations

import dataclasses
import math

import torch
from torch import nn
from torch.nn import functional

from ..network import Convolution, Level, Rise

CELL_CHANNELS = 6  # mask logit, x, y of the texture's canvas, log error of them, log of depth / width, log error of it
IMAGE_PX = (160, 120)
PADDING_PX = 4  # zero rows above and below the image, so that its height is a multiple of 32
CANVAS_PX = 96  # side of the square that contains the texture
PLACES = CANVAS_PX // 8  # cells along a side of the canvas in which the network searches


@dataclasses.dataclass(frozen=True)
class Size:
    """Widths of one variant of the network."""

    widths: tuple[int, int, int, int]  # channels of the encoder at 1/2, 1/4, 1/8 and 1/16
    decoder: tuple[int, int, int, int]  # channels at 1/4, 1/8, 1/16 and 1/32
    blocks: int  # residual blocks of each level from 1/8 on


SIZES = {"tiny": Size((8, 12, 16, 16), (12, 16, 16, 16), 0), "standard": Size((16, 24, 48, 64), (40, 64, 80, 96), 1)}


class Encoder(nn.Module):
    """Maps an image to features at 1/4 and 1/8, and to descriptors at 1/8 that contain the surroundings."""

    def __init__(self, size: Size, padding_px: int) -> None:
        super().__init__()
        w = size.widths
        self.first = Convolution(3, w[0], stride=2, padding=(1 + padding_px, 1))
        self.fine = Level(w[0], w[1], 0)
        self.coarse, self.coarsest = Level(w[1], w[2], size.blocks), Level(w[2], w[3], size.blocks)
        self.rise = Rise(w[3], w[2], w[2], "sum")
        self.describe = nn.Conv2d(w[2], w[2], 1)

    def forward(self, image: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor, torch.Tensor]:
        fine = self.fine(functional.relu(self.first(image * (1 / 255) - 0.5), inplace=True))
        coarse = self.coarse(fine)
        coarse = self.rise(self.coarsest(coarse), coarse)
        described = self.describe(coarse)
        length = ((described * described).sum(1, keepdim=True) + 1e-6).sqrt()
        return fine, coarse, described / length


def tie(encoder: Encoder, other: Encoder) -> None:
    """Gives `other` the weights of the convolutions. Its batch norm stays its own: both inputs differ in statistics."""
    for mine, theirs in zip(encoder.modules(), other.modules()):
        if isinstance(mine, nn.Conv2d):
            theirs.weight, theirs.bias = mine.weight, mine.bias


class AnyTextureNetwork(nn.Module):
    """Maps images [B,3,120,160] and textures [B,3,96,96], RGB from 0 to 255, to cells [B,6,30,40].

    The texture is in the upper left corner of its canvas and touches two of the other sides.
    """

    def __init__(self, size: Size) -> None:
        super().__init__()
        d, w = size.decoder, size.widths
        self.columns, self.rows = IMAGE_PX[0] // 8, IMAGE_PX[1] // 8 + 1  # with the zero rows
        self.image, self.texture = Encoder(size, PADDING_PX), Encoder(size, 0)
        tie(self.image, self.texture)
        x, y = grid(PLACES, PLACES)
        self.register_buffer("values", torch.stack([x, y, x * x, y * y], 1), persistent=False)
        coordinates = 2 * torch.stack(grid(self.columns, self.rows)) - 1
        self.register_buffer("coordinates", coordinates.view(1, 2, self.rows, self.columns), persistent=False)
        self.sharpness = nn.Parameter(torch.full((1, 1, 1, 1), 12.0))
        self.hypotheses = nn.Conv2d(PLACES * PLACES, w[2], 1)
        self.entry = Convolution(2 * w[2] + 6, d[1])
        self.down, self.downmost = Level(d[1], d[2], size.blocks), Level(d[2], d[3], size.blocks)
        self.up, self.up_coarse = Rise(d[3], d[2], d[2], "sum"), Rise(d[2], d[1], d[1], "sum")
        self.up_fine = Rise(d[1], w[1], d[0], "sum")
        self.cells = nn.Conv2d(d[0], CELL_CHANNELS, 1)
        with torch.no_grad():
            self.cells.weight.mul_(0.3)
            self.cells.bias.copy_(torch.tensor([0.0, 0.4, 0.4, math.log(0.25), 0.7, math.log(0.2)]))

    def forward(self, image: torch.Tensor, texture: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """The cells, and the correlation of each cell of 8 px with each place of the canvas, [B,320,144]."""
        fine, coarse, seen = self.image(image)
        channels = self.hypotheses.out_channels
        known = self.texture(texture)[2].reshape(-1, channels, PLACES * PLACES)
        # OpenCV 4.6 ignores a factor of a tensor with three axes, so that the descriptors get it.
        seen = (seen * self.sharpness).reshape(-1, channels, self.rows * self.columns)
        correlation = torch.matmul(seen.transpose(1, 2), known)
        moments = torch.matmul(torch.softmax(correlation, 2), self.values).transpose(1, 2)
        moments = moments.reshape(-1, 4, self.rows, self.columns)
        volume = correlation.transpose(1, 2).reshape(-1, PLACES * PLACES, self.rows, self.columns)
        count = image.shape[0]
        coordinates = self.coordinates if count == 1 else self.coordinates.expand(count, -1, -1, -1)
        x = torch.cat([functional.relu(self.hypotheses(volume)), coarse, moments, coordinates], 1)
        x = functional.relu(self.entry(x), inplace=True)
        down = self.down(x)
        x = self.up_fine(self.up_coarse(self.up(self.downmost(down), down), x), fine)
        return self.cells(x)[:, :, 1:-1], correlation


def grid(columns: int, rows: int) -> tuple[torch.Tensor, torch.Tensor]:
    """x and y of the centres of cells as shares of the sides, row by row."""
    y, x = torch.meshgrid((torch.arange(rows) + 0.5) / rows, (torch.arange(columns) + 0.5) / columns, indexing="ij")
    return x.reshape(-1), y.reshape(-1)
