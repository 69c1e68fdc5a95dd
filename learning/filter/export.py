# SPDX-License-Identifier: Apache-2.0
"""Writes the weights as weights.npz, which filters/learned reads, with their recipe as weights.yaml."""
from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import torch
import yaml

from network import Network

FORMAT = 1


def arrays_of(network: Network) -> dict[str, np.ndarray]:
    """The arrays by their names: `blocks.0.linear.weight` [out,in]."""
    found = {name: np.ascontiguousarray(value.detach().numpy(), dtype=np.float32)
             for name, value in network.state_dict().items()}
    for name, value in found.items():
        if not np.isfinite(value).all():
            raise ValueError(f"{name} has a value that is not finite: train again with a smaller step")
    return {"format": np.array([FORMAT], np.int32), **found}


def write(network: Network, folder: Path, recipe: dict) -> None:
    """Writes both files into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "weights.npz"
    np.savez(path, **arrays_of(network))
    text = {"format": FORMAT, "sha256": hashlib.sha256(path.read_bytes()).hexdigest(),
            "parameters": int(sum(value.numel() for value in network.parameters())),
            "licence": "Apache-2.0", "torch": torch.__version__.split("+")[0],
            "command": "python3 learning/filter/train.py", **recipe}
    (folder / "weights.yaml").write_text(
        "# SPDX-License-Identifier: Apache-2.0\n# The recipe of weights.npz.\n" + yaml.safe_dump(text, sort_keys=False))
