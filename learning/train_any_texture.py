#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains a network for any texture: train_any_texture.py SHARDS... --out FOLDER; continues from its checkpoint.pt."""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))


def main() -> int:
    """0 done, 2 for wrong input."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("shards", type=Path, nargs="+", help="folders that sinks/shards wrote, of a grey object")
    parser.add_argument("--out", type=Path, required=True, help="folder of checkpoint, curve and network")
    parser.add_argument("--name", help="name of the network (default: that of the folder)")
    parser.add_argument("--samples", type=int, default=200000, help="samples to see; determines the schedule")
    parser.add_argument("--size", choices=("standard", "tiny"), default="standard", help="network")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--batch", type=int, default=16, help="samples of a step")
    parser.add_argument("--rate", type=float, default=3e-3, help="largest learning rate")
    parser.add_argument("--textures", type=int, default=1500, help="random textures for each folder")
    parser.add_argument("--export", action="store_true", help="export the checkpoint without training")
    options = parser.parse_args()
    try:
        import torch
    except ImportError:
        print("train_any_texture.py needs PyTorch (Debian: python3-torch)", file=sys.stderr)
        return 2
    from weft_learning.any_texture.export import export
    from weft_learning.any_texture.scenes import Scenes
    from weft_learning.any_texture.training import Training
    from weft_learning.errors import InputError

    torch.set_num_threads(1)
    try:
        options.out.mkdir(parents=True, exist_ok=True)
        training = Training([Scenes(folder) for folder in options.shards], options)
        if not options.export:
            training.run()
        print(export(training, options.name or options.out.resolve().name))
    except InputError as error:
        print(f"train_any_texture.py: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
