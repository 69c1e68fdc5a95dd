#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a network of fixed filters for detectors/onnx: it needs no training and no weights.

The scores are the absolute difference of two Gaussians, the descriptors the first coefficients of a
discrete cosine transform of windows of 24 x 24 px. Usage: fixed_filters.py FOLDER
"""

import math
import sys
from pathlib import Path

import torch
import xxhash

WIDTH_PX, HEIGHT_PX = 640, 480
WINDOW_PX, STEP_PX, ORDERS = 24, 4, 8
DESCRIPTION = """\
weft_network: 1
kind: detector
onnx: fixed.onnx
onnx_hash: {hash}
image: {{input: image, width_px: {width}, height_px: {height}, colours: grey, scale: 0.00392157}}
heat_map: {{output: scores, nms_px: 2, border_px: 8}}
descriptors: {{output: descriptors, metric: l2, normalise: true}}
licence: Apache-2.0
"""


def gaussian(sigma_px: float, size_px: int) -> torch.Tensor:
    """A Gaussian filter of sum 1, [size_px, size_px]."""
    place = torch.arange(size_px) - 0.5 * (size_px - 1)
    row = torch.exp(-place * place / (2.0 * sigma_px**2))
    return torch.outer(row, row) / row.sum() ** 2


def cosines() -> torch.Tensor:
    """Windowed cosines of mean 0, [ORDERS^2 - 1, 1, WINDOW_PX, WINDOW_PX]."""
    place = (torch.arange(WINDOW_PX) + 0.5) / WINDOW_PX
    rows = [torch.cos(math.pi * order * place) for order in range(ORDERS)]
    window = gaussian(WINDOW_PX / 4.0, WINDOW_PX)
    filters = []
    for i in range(1, ORDERS * ORDERS):
        wave = torch.outer(rows[i // ORDERS], rows[i % ORDERS]) * window
        filters.append(wave - window * wave.sum())
    return torch.stack(filters)[:, None]


class FixedFilters(torch.nn.Module):
    """Scores [1,1,H,W] and descriptors [1,D,H/4,W/4] of a grey image [1,1,H,W], 0 to 1."""

    def __init__(self) -> None:
        super().__init__()
        blob = 8.0 * (gaussian(1.5, 15) - gaussian(2.4, 15))
        self.register_buffer("blobs", torch.stack([blob, -blob])[:, None])
        self.register_buffer("cosines", cosines())

    def forward(self, image: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        bright_dark = torch.relu(torch.nn.functional.conv2d(image, self.blobs, padding=7))
        scores = bright_dark[:, :1] + bright_dark[:, 1:]
        # Window (i, j) is centred on cell (i, j) of 4 px.
        padding = (WINDOW_PX - STEP_PX) // 2
        return scores, torch.nn.functional.conv2d(
            image, self.cosines, stride=STEP_PX, padding=padding
        )


def main() -> None:
    """Writes fixed.onnx and fixed.yaml."""
    folder = Path(sys.argv[1])
    onnx = folder / "fixed.onnx"
    image = torch.zeros(1, 1, HEIGHT_PX, WIDTH_PX)
    torch.onnx.export(
        FixedFilters().eval(),
        (image,),
        str(onnx),
        opset_version=11,
        input_names=["image"],
        output_names=["scores", "descriptors"],
    )
    digest = xxhash.xxh3_64_hexdigest(onnx.read_bytes())
    text = DESCRIPTION.format(hash=digest, width=WIDTH_PX, height=HEIGHT_PX)
    (folder / "fixed.yaml").write_text(text)


if __name__ == "__main__":
    main()
