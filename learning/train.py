#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains a registration network from shards: train.py SHARDS --out FOLDER; continues from FOLDER/checkpoint.pt."""

import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

PRESETS = {"tiny": {"size": "tiny", "epochs": 4}}


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("shards", type=Path, help="folder that sinks/shards writes; it may still grow")
    parser.add_argument("--out", type=Path, required=True, help="folder of checkpoint, curve and network")
    parser.add_argument("--name", help="name of the network (default: that of the folder)")
    parser.add_argument("--samples", type=int, help="number of samples to use (default: all of shards.json)")
    parser.add_argument("--epochs", type=int, default=4, help="passes over the training samples")
    parser.add_argument("--minutes", type=float, help="stop after these minutes with a checkpoint")
    parser.add_argument("--seed", type=int, default=1, help="seed of weights, order and augmentation")
    parser.add_argument("--threads", type=int, default=1, help="threads of torch; another number changes rounding")
    parser.add_argument("--size", choices=("standard", "large", "tiny"), default="standard", help="network")
    parser.add_argument("--batch", type=int, default=16, help="samples of a step")
    parser.add_argument("--rate", type=float, default=3e-3, help="largest learning rate")
    parser.add_argument("--preset", choices=PRESETS, help="settings for a quick trial; overrides --size and --epochs")
    parser.add_argument("--checkpoint-samples", type=int, default=16000, help="samples between two checkpoints")
    parsed = parser.parse_args()
    for name, value in PRESETS.get(parsed.preset, {}).items():
        setattr(parsed, name, value)
    for name in ("epochs", "threads", "batch", "checkpoint_samples"):
        if getattr(parsed, name) < 1:
            parser.error(f"--{name.replace('_', '-')} must be at least 1")
    if parsed.seed < 0 or not parsed.rate > 0:
        parser.error("--seed must not be negative and --rate must be positive")
    return parsed


def main() -> int:
    """Trains and exports; 0 also if it stopped early, 2 for wrong input, 130 or 143 after a signal."""
    options = arguments()
    try:
        import torch
    except ImportError:
        print("train.py needs PyTorch (Debian: python3-torch)", file=sys.stderr)
        return 2
    from weft_learning.errors import InputError, Stopped
    from weft_learning.export import export
    from weft_learning.shards import Shards
    from weft_learning.trainer import Settings, Training, Watch, samples_of_checkpoint

    torch.set_num_threads(options.threads)
    torch.use_deterministic_algorithms(True)
    watch = Watch(options.minutes)
    try:
        samples = options.samples or samples_of_checkpoint(options.out)
        shards = Shards(options.shards, samples, watch.wait)
        options.out.mkdir(parents=True, exist_ok=True)
        training = Training(shards, options.out, Settings(options.size, shards.samples, options.epochs, options.batch,
                                                          options.seed, options.rate))
        training.run(options.checkpoint_samples, watch.check)
        name = options.name or options.out.resolve().name
        metrics = export(shards, options.out, name)["training"]["validation"]
    except InputError as error:
        print(f"train.py: {error}", file=sys.stderr)
        return 2
    except Stopped as stop:
        print(f"{stop}; the same command continues from {options.out}/checkpoint.pt", flush=True)
        return 128 + watch.signal if watch.signal else 0
    print(f"{options.out / name}.onnx: validation " + ", ".join(f"{k} {v}" for k, v in metrics.items()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
