#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Trains the network of filters/learned: train.py [--weft PROGRAM] [--work FOLDER] [--export FOLDER]

Makes the data, trains and writes weights.npz and weights.yaml. A killed training resumes from its last
checkpoint in the work folder, and gives the same weights as one that was not killed.
"""
from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
import torch

import evaluate
import export
from batches import Batches
from frex_sets import simulated
from match_sets import draw_many
from network import Network, loss_of

SEED = 20
CHECK_STEPS = 500


def arguments() -> argparse.Namespace:
    """The command line."""
    here = Path(__file__).resolve().parents[2]
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--weft", default=str(here / "build/release/bin/weft"), help="the program")
    parser.add_argument("--work", type=Path, default=Path("runs/learned_filter"), help="data and checkpoints")
    parser.add_argument("--export", type=Path, default=here / "plugins/filters/learned", help="where weights go")
    parser.add_argument("--steps", type=int, default=4000, help="batches of about 3000 matches")
    parser.add_argument("--formula-sets", type=int, default=4000, help="training sets by formula")
    parser.add_argument("--scenes", type=int, default=240, help="simulated training scenes of 6 frames")
    parser.add_argument("--test-scenes", type=int, default=36, help="simulated validation scenes")
    parser.add_argument("--plain", action="store_true", help="no fits and no neighbours, for comparison; no export")
    parser.add_argument("--frex-share", type=float, default=0.6, help="share of simulated sets in a batch")
    return parser.parse_args()


def data(args: argparse.Namespace) -> tuple[Batches, dict[str, list]]:
    """Training batches and validation sets."""
    formula, test = draw_many(args.formula_sets, SEED), {"formula": draw_many(150, SEED + 1)}
    groups = [(formula, 1.0)]
    if args.scenes > 0:
        folder = args.work / "scenes"
        frex = simulated(args.weft, folder, args.scenes, SEED)
        test["frex"] = simulated(args.weft, folder, args.test_scenes, SEED, first=args.scenes)
        groups = [(formula, 1 - args.frex_share), (frex, args.frex_share)]
    for name, sets in [*((f"train {k}", sets) for k, (sets, _) in enumerate(groups)), *test.items()]:
        sizes = [len(one.label) for one in sets]
        print(f"{name}: {len(sets)} sets, {np.mean(sizes):.0f} matches each", flush=True)
    return Batches(groups), test


def train(args: argparse.Namespace, batches: Batches, test: dict[str, list]) -> Network:
    """Trains from the last checkpoint on."""
    torch.manual_seed(SEED)
    network = Network(geometry=not args.plain)
    optimiser = torch.optim.AdamW(network.parameters(), 3e-3, weight_decay=1e-4)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, 3e-3, args.steps, pct_start=0.05)
    checkpoint, first = args.work / "checkpoint.pt", 0
    if checkpoint.exists():
        saved = torch.load(checkpoint)
        network.load_state_dict(saved["network"])
        optimiser.load_state_dict(saved["optimiser"])
        schedule.load_state_dict(saved["schedule"])
        first = saved["step"]
        print(f"resumed at step {first}", flush=True)
    losses, begun = [], time.monotonic()
    for step in range(first, args.steps):
        batch = batches.draw(np.random.default_rng([SEED, step]))
        loss = loss_of(network(batch), batch["label"])
        optimiser.zero_grad()
        loss.backward()
        norm = torch.nn.utils.clip_grad_norm_(network.parameters(), 5.0)
        if torch.isfinite(norm):
            optimiser.step()
        schedule.step()
        losses.append(loss.item())
        if (step + 1) % CHECK_STEPS == 0 or step + 1 == args.steps:
            areas = {name: evaluate.area_percent(network, sets[::3]) for name, sets in test.items()}
            print(f"step {step + 1} loss {np.mean(losses):.4f} areas {areas} {time.monotonic() - begun:.0f} s", flush=True)
            losses = []
            part = checkpoint.with_suffix(".part")
            torch.save({"network": network.state_dict(), "optimiser": optimiser.state_dict(),
                        "schedule": schedule.state_dict(), "step": step + 1}, part)
            part.rename(checkpoint)
    return network


def main() -> None:
    """Data, training, export."""
    args = arguments()
    torch.set_num_threads(1)
    args.work.mkdir(parents=True, exist_ok=True)
    print(f"seed {SEED}", flush=True)
    batches, test = data(args)
    network = train(args, batches, test).eval()
    areas = {name: evaluate.area_percent(network, sets) for name, sets in test.items()}
    print(f"areas {areas}")
    if args.plain:
        return
    export.write(network, args.export, {
        "seed": SEED, "steps": args.steps, "formula_sets": args.formula_sets, "scenes": args.scenes,
        "frex_share": args.frex_share, "validation_area_percent": areas})


if __name__ == "__main__":
    main()
