#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Exports the checkpoint of a training, finished or not: export.py SHARDS FOLDER writes FOLDER/NAME.onnx and .yaml."""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))


def main() -> int:
    """0 done, 2 for wrong input."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("shards", type=Path, help="shards of the training")
    parser.add_argument("folder", type=Path, help="--out of the training")
    parser.add_argument("--name", help="name of the network (default: that of the folder)")
    parser.add_argument("--samples", type=int, help="number of samples to use (default: that of the training)")
    options = parser.parse_args()
    try:
        import torch
    except ImportError:
        print("export.py needs PyTorch (Debian: python3-torch)", file=sys.stderr)
        return 2
    from weft_learning.errors import InputError
    from weft_learning.export import export
    from weft_learning.shards import Shards
    from weft_learning.trainer import samples_of_checkpoint

    def missing(message: str) -> None:
        raise InputError(message.replace("waiting for", "missing:") + "; wait for the writer or lower --samples")

    torch.set_num_threads(1)
    try:
        samples = options.samples or samples_of_checkpoint(options.folder)
        name = options.name or options.folder.resolve().name
        description = export(Shards(options.shards, samples, missing), options.folder, name)
    except InputError as error:
        print(f"export.py: {error}", file=sys.stderr)
        return 2
    for split in ("validation", "test"):
        print(f"{split}: " + ", ".join(f"{k} {v}" for k, v in description["training"][split].items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
