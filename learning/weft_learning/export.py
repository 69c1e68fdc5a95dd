# SPDX-License-Identifier: Apache-2.0
"""Writes a trained network as ONNX with its description, and checks that OpenCV computes the same."""

import copy
import dataclasses
import math
import warnings
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import torch
import xxhash
import yaml

from .errors import InputError
from .metrics import evaluate
from .network import STEP_PX, RegistrationNetwork, folded, multiplications, parameters
from .shards import Shards
from .trainer import CHECKPOINT, load_checkpoint, make_network, write_atomically

OPSET = 11
TOLERANCE = 1e-4  # of the largest value of an output


def write_onnx(network: RegistrationNetwork, path: Path) -> None:
    """Writes the network for one image, with batch norm folded into the convolutions."""
    plain = folded(copy.deepcopy(network)).to(memory_format=torch.contiguous_format)
    shape = network.shape
    # torch replaces equal initialisers by Identity nodes, which OpenCV refuses, unless the network is in training
    # mode. Without batch norm and dropout, that mode changes nothing else.
    plain.train()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        torch.onnx.export(plain, torch.zeros(1, 3, shape.height_px, shape.width_px), str(path), opset_version=OPSET,
                          input_names=["image"], output_names=["cells", "vertices"],
                          training=torch.onnx.TrainingMode.PRESERVE, do_constant_folding=True)


def difference(network: RegistrationNetwork, path: Path, images: np.ndarray) -> float:
    """Largest difference between torch and OpenCV over u8 images [N,H,W,3], relative to each output's range."""
    try:
        opencv = cv2.dnn.readNetFromONNX(str(path))
    except cv2.error as error:
        raise InputError(f"{path}: OpenCV {cv2.__version__} cannot read it ({error})") from None
    network = copy.deepcopy(network).eval()
    found = [0.0]
    for image in images:
        values = np.ascontiguousarray(image.transpose(2, 0, 1)[None], np.float32)
        with torch.no_grad():
            expected = [output.numpy() for output in network(torch.from_numpy(values))]
        opencv.setInput(values, "image")
        for answer, wanted in zip(opencv.forward(["cells", "vertices"]), expected):
            if answer.shape != wanted.shape:
                raise InputError(f"{path}: OpenCV answers {answer.shape}, torch {wanted.shape}")
            found.append(float(np.abs(answer - wanted).max() / np.abs(wanted).max()))
    return max(found) if all(map(math.isfinite, found)) else math.inf


def plain_numbers(metrics: dict[str, float]) -> dict[str, Any]:
    return {k: (None if not math.isfinite(v) else v if isinstance(v, int) else float(f"{v:.5g}"))
            for k, v in metrics.items()}


def export(shards: Shards, folder: Path, name: str) -> dict[str, Any]:
    """Writes FOLDER/NAME.onnx and NAME.yaml from the checkpoint of the folder; returns the description."""
    path = folder / CHECKPOINT
    state = load_checkpoint(folder)
    if not state:
        raise InputError(f"{path}: missing; run train.py first")
    settings = state["settings"]
    network = make_network(settings["size"], shards.description)
    try:
        network.load_state_dict(state["network"])
    except RuntimeError as error:
        raise InputError(f"{path}: made from other shards ({error}); name the shards of this training") from None
    onnx = folder / f"{name}.onnx"
    images = shards.gather(shards.indices("validation")[:3])["image"]
    write_atomically(onnx, lambda temporary: _write_checked(network, temporary, images))
    metrics = {split: evaluate(network, shards, shards.indices(split)) for split in ("validation", "test")}
    description = _description(shards, network, onnx, metrics, state)
    text = yaml.safe_dump(description, sort_keys=False, width=120, default_flow_style=None)
    write_atomically(folder / f"{name}.yaml", lambda temporary: temporary.write_text(text, encoding="utf-8"))
    return description


def _write_checked(network: RegistrationNetwork, path: Path, images: np.ndarray) -> None:
    write_onnx(network, path)
    found = difference(network, path, images)
    if found > TOLERANCE:
        raise InputError(f"{path}: OpenCV and torch differ by {found:.2g}, more than {TOLERANCE:g} of the largest "
                         "value; the network was not exported")


def _description(shards: Shards, network: RegistrationNetwork, onnx: Path, metrics: dict[str, dict[str, float]],
                 state: dict[str, Any]) -> dict[str, Any]:
    d, settings = shards.description, state["settings"]
    factor = metrics["validation"]["uv_error_factor"]
    return {
        "weft_network": 1, "kind": "registration", "onnx": onnx.name,
        "onnx_hash": xxhash.xxh3_64_hexdigest(onnx.read_bytes()),
        "image": {"input": "image", "width_px": d.width_px, "height_px": d.height_px, "colours": "rgb"},
        "camera": dict(zip(("fx", "fy", "cx", "cy"), d.camera)),
        "cells": {"output": "cells", "step_px": STEP_PX, "columns": d.width_px // STEP_PX,
                  "rows": d.height_px // STEP_PX},
        "vertices": {"output": "vertices", "columns": d.columns, "rows": d.rows},
        "template": {"width_m": d.width_m, "height_m": d.height_m, "texture_hash": d.texture_hash},
        "uv_error_factor": float(f"{factor:.5g}") if math.isfinite(factor) else 1.0,
        "training": {
            "size": settings["size"], "parameters": parameters(network),
            "multiply_accumulates": multiplications(network),
            "samples": settings["samples"], "samples_seen": state["step"] * settings["batch"],
            "complete": state["step"] == state["steps"], "epochs": settings["epochs"], "batch": settings["batch"],
            "learning_rate": settings["learning_rate"], "seed": settings["seed"],
            "recipe_hash": settings["recipe_hash"], "torch": str(torch.__version__), "opencv": cv2.__version__,
            "cpu_seconds": round(state["seconds"], 1), "validation": plain_numbers(metrics["validation"]),
            "test": plain_numbers(metrics["test"])},
        "licence": "Apache-2.0",
    }
