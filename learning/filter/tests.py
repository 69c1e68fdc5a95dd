#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests of the training of filters/learned: tests.py; exits 77 where PyTorch is missing."""
from __future__ import annotations

import argparse
import io
import sys
import tempfile
import unittest
import unittest.mock
from contextlib import redirect_stdout
from pathlib import Path

import numpy as np

try:
    import torch
except ImportError:
    print("skipped: the Python module torch is missing (Debian: python3-torch)")
    sys.exit(77)

import evaluate
import export
import network
import train
from batches import Batches, augmented
from frex_sets import load, store
from match_sets import TOLERANCE_PX, draw, draw_many


class MatchSets(unittest.TestCase):
    """The generator by formula."""

    def test_same_seed_same_sets(self) -> None:
        first, second, other = draw_many(3, 5), draw_many(3, 5), draw_many(3, 6)
        for a, b in zip(first, second):
            np.testing.assert_array_equal(a.image_px, b.image_px)
        self.assertFalse(np.array_equal(first[0].image_px, other[0].image_px))

    def test_sets_have_inliers_and_mismatches(self) -> None:
        shares = [np.mean(one.label == 1) for one in draw_many(200, 7)]
        self.assertLess(np.percentile(shares, 10), 0.3)
        self.assertGreater(np.percentile(shares, 90), 0.7)

    def test_inliers_follow_a_smooth_map(self) -> None:
        for one in draw_many(20, 8):
            right = one.label == 1
            if right.sum() < 60:
                continue
            p = (one.template_px[right] - one.template_px.mean(0)) / one.half_diagonal_px
            basis = network.curved_basis(torch.tensor(p)[None])[0].numpy()
            map_, *_ = np.linalg.lstsq(basis, one.image_px[right], rcond=None)
            residual = np.linalg.norm(basis @ map_ - one.image_px[right], axis=1)
            self.assertLess(np.median(residual), 5 * TOLERANCE_PX)

    def test_stored_sets_are_read_again(self) -> None:
        sets = draw_many(3, 9)
        with tempfile.TemporaryDirectory() as folder:
            store(Path(folder) / "sets.npz", sets)
            again = load(Path(folder) / "sets.npz")
        for a, b in zip(sets, again):
            np.testing.assert_array_equal(a.label, b.label)
            self.assertEqual(a.half_diagonal_px, b.half_diagonal_px)


class TheNetwork(unittest.TestCase):
    """Forward pass, loss and export."""

    def setUp(self) -> None:
        torch.manual_seed(3)
        self.network = network.Network().eval()
        self.set = next(one for one in draw_many(50, 10) if 60 < len(one.label) < 200)

    def test_order_does_not_matter(self) -> None:
        order = np.random.default_rng(4).permutation(len(self.set.label))
        first = evaluate.scores_of(self.network, self.set)
        other = evaluate.scores_of(self.network, self.set.rows(order))
        np.testing.assert_allclose(other, first[order], atol=2e-3)
        self.assertGreater(first.std(), 1e-3)

    def test_translation_turn_and_shift_do_not_matter(self) -> None:
        first = evaluate.scores_of(self.network, self.set)
        c, s = np.cos(1.1), np.sin(1.1)
        self.set.image_px = self.set.image_px @ np.array([[c, s], [-s, c]]) + [50.0, -20.0]
        self.set.angle_rad = self.set.angle_rad + 1.1
        np.testing.assert_allclose(evaluate.scores_of(self.network, self.set), first, atol=5e-3)

    def test_training_lowers_the_loss(self) -> None:
        batches = Batches([(draw_many(60, 11), 1.0)], rows=600)
        optimiser = torch.optim.AdamW(self.network.parameters(), 3e-3)
        losses = []
        for step in range(60):
            batch = batches.draw(np.random.default_rng([12, step]))
            loss = network.loss_of(self.network(batch), batch["label"])
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            losses.append(loss.item())
        self.assertLess(np.mean(losses[-10:]), 0.7 * np.mean(losses[:10]))

    def test_perfect_scores_have_the_whole_area(self) -> None:
        class Perfect(torch.nn.Module):
            def forward(self, batch: dict[str, torch.Tensor]) -> list[torch.Tensor]:
                return [10 * batch["label"] - 5]

        class Constant(torch.nn.Module):
            def forward(self, batch: dict[str, torch.Tensor]) -> list[torch.Tensor]:
                return [0 * batch["label"]]

        sets = draw_many(5, 13)
        self.assertAlmostEqual(evaluate.area_percent(Perfect(), sets), 100.0)
        self.assertAlmostEqual(evaluate.area_percent(Constant(), sets), 50.0)

    def test_export_refuses_nan(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            export.write(self.network, Path(folder), {})
            arrays = np.load(Path(folder) / "weights.npz")
            self.assertEqual(arrays["blocks.5.linear.weight"].shape, (64, 64))
            self.network.heads[0].bias.data[0] = torch.nan
            with self.assertRaisesRegex(ValueError, "heads.0.bias"):
                export.write(self.network, Path(folder), {})


class Killed(Exception):
    """Stands for the end of a process."""


class KilledOnce:
    """Batches that end the training at a step."""

    def __init__(self, batches: Batches, killed_at: int):
        self.batches, self.left = batches, killed_at

    def draw(self, rng: np.random.Generator) -> dict[str, torch.Tensor]:
        self.left -= 1
        if self.left < 0:
            raise Killed
        return self.batches.draw(rng)


class Training(unittest.TestCase):
    """Checkpoints."""

    def test_a_killed_training_ends_with_the_same_weights(self) -> None:
        sets = draw_many(20, 16)
        batches = Batches([(sets, 1.0)], rows=300)
        with tempfile.TemporaryDirectory() as whole, tempfile.TemporaryDirectory() as parts, \
                unittest.mock.patch.object(train, "CHECK_STEPS", 4), redirect_stdout(io.StringIO()) as printed:
            args = lambda folder: argparse.Namespace(work=Path(folder), steps=10, plain=False)
            expected = train.train(args(whole), batches, {"formula": sets[:3]}).state_dict()
            with self.assertRaises(Killed):
                train.train(args(parts), KilledOnce(batches, 7), {"formula": sets[:3]})
            resumed = train.train(args(parts), batches, {"formula": sets[:3]}).state_dict()
        self.assertIn("resumed at step 4", printed.getvalue())
        for name, value in expected.items():
            self.assertTrue(torch.equal(value, resumed[name]), name)


class Augmentation(unittest.TestCase):
    """Random changes of sets."""

    def test_keeps_inliers_on_the_turned_surface(self) -> None:
        rng = np.random.default_rng(14)
        one = next(drawn for drawn in (draw(rng) for _ in range(50)) if len(drawn.label) > 100)
        changed = augmented(np.random.default_rng(15), one, 80)
        self.assertEqual(changed["label"].shape, (80,))
        self.assertTrue(np.isfinite(changed["image_px"]).all())
        self.assertLessEqual((changed["label"] == 1).sum(), (one.label == 1).sum())


if __name__ == "__main__":
    unittest.main()
