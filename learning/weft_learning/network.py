# SPDX-License-Identifier: Apache-2.0
"""The registration network: one encoder, a dense head over cells and a head for the vertices of the template."""

import dataclasses
import math

import torch
from torch import nn
from torch.nn import functional

CELL_CHANNELS = 6  # mask logit, u, v, log error of uv, log depth, log error of it
STEP_PX = 4  # side of a cell in the small image
COARSEST = 32  # the encoder halves the image five times


@dataclasses.dataclass(frozen=True)
class Size:
    """Widths of one variant of the network."""

    widths: tuple[int, ...]  # channels at 1/2, 1/4, 1/8, 1/16, 1/32 of the image
    top: int  # channels of the decoder at 1/4
    blocks: int  # residual blocks of each level from the second on
    merge: str  # how the decoder takes in a map of the encoder: "concat" or "sum"
    vertex_channels: int
    vertex_hidden: int


SIZES = {
    "tiny": Size((8, 8, 12, 16, 24), 8, 0, "sum", 8, 24),
    "standard": Size((16, 32, 48, 72, 96), 48, 1, "sum", 32, 192),
    "large": Size((16, 32, 64, 96, 128), 48, 1, "concat", 48, 256),
}


@dataclasses.dataclass(frozen=True)
class Shape:
    """Sizes of the tensors that the data determine."""

    width_px: int
    height_px: int
    columns: int  # of the grid of vertices
    rows: int


class Convolution(nn.Module):
    """3 x 3 convolution with batch norm; `folded` replaces both by one convolution with a bias."""

    def __init__(self, inputs: int, outputs: int, stride: int = 1, padding: tuple[int, int] = (1, 1)) -> None:
        super().__init__()
        self.convolution = nn.Conv2d(inputs, outputs, 3, stride, padding, bias=False)
        self.norm = nn.BatchNorm2d(outputs)
        nn.init.kaiming_normal_(self.convolution.weight, nonlinearity="relu")

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.norm(self.convolution(x))

    def folded(self) -> nn.Conv2d:
        """The same map at inference as one convolution."""
        old, norm = self.convolution, self.norm
        new = nn.Conv2d(old.in_channels, old.out_channels, old.kernel_size, old.stride, old.padding)
        scale = norm.weight.double() / torch.sqrt(norm.running_var.double() + norm.eps)
        new.weight.data = (old.weight.double() * scale[:, None, None, None]).float()
        new.bias.data = (norm.bias.double() - norm.running_mean.double() * scale).float()
        return new


class Residual(nn.Module):
    """Two convolutions whose output is added to the input."""

    def __init__(self, channels: int) -> None:
        super().__init__()
        self.first = Convolution(channels, channels)
        self.second = Convolution(channels, channels)
        nn.init.constant_(self.second.norm.weight, 0.2)  # Near the identity at first: deep networks start faster.

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        y = functional.relu(self.first(x), inplace=True)
        return functional.relu(self.second(y) + x, inplace=True)


class Level(nn.Module):
    """One halving of the encoder with its residual blocks."""

    def __init__(self, inputs: int, outputs: int, blocks: int) -> None:
        super().__init__()
        self.halve = Convolution(inputs, outputs, stride=2)
        self.blocks = nn.Sequential(*(Residual(outputs) for _ in range(blocks)))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.blocks(functional.relu(self.halve(x), inplace=True))


class Rise(nn.Module):
    """One doubling of the decoder: takes the coarser map and the encoder's map of the finer level."""

    def __init__(self, coarse: int, fine: int, outputs: int, merge: str) -> None:
        super().__init__()
        self.concat = merge == "concat"
        if self.concat:
            self.narrow, self.widen = nn.Identity(), nn.Identity()
            self.merge = Convolution(coarse + fine, outputs)
        else:
            self.narrow = nn.Conv2d(coarse, outputs, 1)
            self.widen = nn.Identity() if fine == outputs else nn.Conv2d(fine, outputs, 1, bias=False)
            self.merge = Convolution(outputs, outputs)

    def forward(self, coarse: torch.Tensor, fine: torch.Tensor) -> torch.Tensor:
        up = functional.interpolate(self.narrow(coarse), scale_factor=2.0, mode="nearest")
        fine = self.widen(fine)
        merged = torch.cat([up, fine], 1) if self.concat else functional.relu(up + fine, inplace=True)
        return functional.relu(self.merge(merged), inplace=True)


class RegistrationNetwork(nn.Module):
    """Maps images [B,3,H,W], RGB from 0 to 255, to cells [B,6,H/4,W/4] and vertices [B,3,V]."""

    def __init__(self, size: Size, shape: Shape) -> None:
        super().__init__()
        self.shape = shape
        beside = -shape.height_px % COARSEST // 2
        if shape.width_px % COARSEST or shape.height_px % (2 * STEP_PX):
            raise ValueError(f"an image of {shape.width_px} x {shape.height_px} px does not suit the network; its "
                             f"width must be a multiple of {COARSEST} and its height one of {2 * STEP_PX}")
        self.above = beside // STEP_PX  # rows of cells above the image, and as many below
        y, x = torch.meshgrid(torch.linspace(-1, 1, shape.height_px), torch.linspace(-1, 1, shape.width_px),
                              indexing="ij")
        self.register_buffer("coordinates", torch.stack([x, y])[None].contiguous(), persistent=False)
        w = size.widths
        # Zero rows above and below make the height a multiple of 32. As padding of the first convolution they need no
        # layer of their own.
        self.first = Convolution(5, w[0], stride=2, padding=(1 + beside, 1))
        self.levels = nn.ModuleList(Level(a, b, size.blocks) for a, b in zip(w, w[1:]))
        outputs = (size.top, w[2], w[3])
        self.rises = nn.ModuleList(
            Rise((outputs + (w[4],))[i + 1], w[i + 1], outputs[i], size.merge) for i in (2, 1, 0))
        self.cells = nn.Conv2d(size.top, CELL_CHANNELS, 1)
        places = (shape.height_px + 2 * beside) // COARSEST * (shape.width_px // COARSEST)
        self.squeeze = nn.Conv2d(w[4], size.vertex_channels, 1)
        self.hidden = nn.Linear(size.vertex_channels * places, size.vertex_hidden)
        self.vertices = nn.Linear(size.vertex_hidden, 3 * shape.columns * shape.rows)

    def start_at(self, log_depth: float, vertices: torch.Tensor) -> None:
        """Starts both heads at a mean answer, so that the first steps need not find it: `vertices` is [3,V]."""
        with torch.no_grad():
            self.cells.weight.mul_(0.3)
            self.cells.bias.copy_(torch.tensor([0.0, 0.5, 0.5, math.log(0.25), log_depth, math.log(0.2)]))
            self.vertices.weight.mul_(0.3)
            self.vertices.bias.copy_(vertices.reshape(-1))

    def forward(self, image: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        count = image.shape[0]
        coordinates = self.coordinates if count == 1 else self.coordinates.expand(count, -1, -1, -1)
        x = torch.cat([image * (1 / 255) - 0.5, coordinates], 1)
        x = functional.relu(self.first(x), inplace=True)
        maps = []
        for level in self.levels:
            x = level(x)
            maps.append(x)
        y = functional.relu(self.squeeze(x), inplace=True).flatten(1)
        vertices = self.vertices(functional.relu(self.hidden(y), inplace=True))
        for rise, fine in zip(self.rises, maps[-2::-1]):
            x = rise(x, fine)
        cells = self.cells(x)[:, :, self.above:self.above + self.shape.height_px // STEP_PX]
        return cells, vertices.view(-1, 3, self.shape.rows * self.shape.columns)


def folded(network: RegistrationNetwork) -> RegistrationNetwork:
    """Replaces each convolution with batch norm of `network` in place by one with a bias; for inference only."""
    for parent in list(network.modules()):
        for name, child in list(parent.named_children()):
            if isinstance(child, Convolution):
                setattr(parent, name, child.folded())
    return network


def parameters(network: nn.Module) -> int:
    """Number of trained values."""
    return sum(p.numel() for p in network.parameters())


def multiplications(network: RegistrationNetwork) -> int:
    """Multiply-accumulates of convolutions and linear layers for one image."""
    total = 0

    def count(module: nn.Module, _: tuple, output: torch.Tensor) -> None:
        nonlocal total
        total += output[0].numel() * module.weight[0].numel()

    hooks = [m.register_forward_hook(count) for m in network.modules() if isinstance(m, (nn.Conv2d, nn.Linear))]
    training = network.training
    network.eval()
    with torch.no_grad():
        network(torch.zeros(1, 3, network.shape.height_px, network.shape.width_px))
    network.train(training)
    for hook in hooks:
        hook.remove()
    return total
