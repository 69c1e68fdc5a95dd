# SPDX-License-Identifier: Apache-2.0
"""Writes a trained network as ONNX with its description, and checks that OpenCV computes the same."""
from __future__ import annotations

import copy
import warnings
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
import xxhash
import yaml
from torch import nn

from ..errors import InputError
from ..export import OPSET, TOLERANCE, plain_numbers
from ..network import STEP_PX, folded, parameters
from ..trainer import write_atomically
from .network import CANVAS_PX, IMAGE_PX, AnyTextureNetwork


class Stacked(nn.Module):
    """The network with one input: the image, and below it the canvas of the texture."""

    def __init__(self, network: AnyTextureNetwork) -> None:
        super().__init__()
        self.network = network

    def forward(self, both: torch.Tensor) -> torch.Tensor:
        height = IMAGE_PX[1]
        return self.network(both[:, :, :height], both[:, :, height:, :CANVAS_PX])[0]


def stacked(image: np.ndarray, canvas: np.ndarray) -> np.ndarray:
    """The input of the exported network from [3,H,W] and [3,S,S]."""
    both = np.zeros((1, 3, IMAGE_PX[1] + CANVAS_PX, IMAGE_PX[0]), np.float32)
    both[0, :, :IMAGE_PX[1]], both[0, :, IMAGE_PX[1]:, :CANVAS_PX] = image, canvas
    return both


def write_onnx(network: AnyTextureNetwork, path: Path) -> None:
    """Writes the network for one image, with batch norm folded into the convolutions."""
    plain = Stacked(folded(copy.deepcopy(network)).to(memory_format=torch.contiguous_format))
    plain.train()  # Otherwise torch replaces equal initialisers by Identity nodes, which OpenCV refuses.
    empty = torch.zeros(1, 3, IMAGE_PX[1] + CANVAS_PX, IMAGE_PX[0])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(plain, empty, str(path), opset_version=OPSET, input_names=["image"], output_names=["cells"],
                          training=torch.onnx.TrainingMode.PRESERVE, do_constant_folding=True)


def difference(network: AnyTextureNetwork, path: Path, inputs: list[np.ndarray]) -> float:
    """Largest difference between torch and OpenCV, relative to the largest value."""
    try:
        opencv = cv2.dnn.readNetFromONNX(str(path))
    except cv2.error as error:
        raise InputError(f"{path}: OpenCV {cv2.__version__} cannot read it ({error})") from None
    plain, found = Stacked(copy.deepcopy(network).eval()), []
    for values in inputs:
        with torch.no_grad():
            wanted = plain(torch.from_numpy(values)).numpy()
        opencv.setInput(values, "image")
        found.append(float(np.abs(opencv.forward("cells") - wanted).max() / np.abs(wanted).max()))
    return max(found) if np.isfinite(found).all() else float("inf")


def export(training: Any, name: str) -> dict[str, Any]:
    """Writes NAME.onnx and NAME.yaml to the folder of a training; returns the description."""
    network, folder = training.network, training.options.out
    batch, canvas = training.other.batch(training.validation[:3], np.random.default_rng(0))
    inputs = [stacked(i, c) for i, c in zip(batch.image.clamp(0, 255).numpy(), canvas.numpy())]
    path = folder / f"{name}.onnx"

    def write_checked(temporary: Path) -> None:
        write_onnx(network, temporary)
        found = difference(network, temporary, inputs)
        if found > TOLERANCE:
            raise InputError(f"{path}: OpenCV and torch differ by {found:.2g}; the network was not exported")

    write_atomically(path, write_checked)
    metrics = training.evaluate()
    description = {
        "weft_network": 1, "kind": "registration", "onnx": path.name,
        "onnx_hash": xxhash.xxh3_64_hexdigest(path.read_bytes()),
        "image": {"input": "image", "width_px": IMAGE_PX[0], "height_px": IMAGE_PX[1], "colours": "rgb"},
        "camera": training.scenes[0].camera,
        "cells": {"output": "cells", "step_px": STEP_PX, "columns": IMAGE_PX[0] // STEP_PX,
                  "rows": IMAGE_PX[1] // STEP_PX},
        "texture": {"side_px": CANVAS_PX},
        "uv_error_factor": float(f"{metrics['uv_error_factor']:.5g}"),
        "training": {
            "size": training.options.size, "parameters": parameters(network),
            "scenes": sum(s.count for s in training.scenes), "textures": training.options.textures,
            "samples_seen": training.step * training.options.batch, "complete": training.step == training.steps,
            "batch": training.options.batch, "learning_rate": training.options.rate, "seed": training.options.seed,
            "torch": str(torch.__version__), "opencv": cv2.__version__, "cpu_seconds": round(training.seconds, 1),
            "validation": plain_numbers(metrics)},
        "licence": "Apache-2.0"}
    text = yaml.safe_dump(description, sort_keys=False, width=120, default_flow_style=None)
    write_atomically(folder / f"{name}.yaml", lambda temporary: temporary.write_text(text, encoding="utf-8"))
    return description
