#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Fits confidences to frames that are drawn from known weights, and reads folders made by hand."""

import io
import json
import math
import random
import struct
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import fit_confidence  # noqa: E402
from fit_confidence import Frame, SIGNS  # noqa: E402

SEED = 29


def npy(numbers, shape):
    header = repr({"descr": "<f8", "fortran_order": False, "shape": shape}).encode()
    header += b" " * (-(10 + len(header) + 1) % 64) + b"\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header +
            struct.pack(f"<{len(numbers)}d", *numbers))


def drawn(weights, count, solver="mine"):
    """Frames whose signs are normal and which are right as often as the weights say."""
    chance = random.Random(SEED)
    frames = []
    for _ in range(count):
        signs = {name: chance.gauss(-1.0, 1.0) for name in SIGNS}
        frame = Frame(solver, "", 0.0, False, False, 1.0, signs)
        said = fit_confidence.confidence_by(weights, frame)
        frames.append(frame._replace(confidence=said, right=chance.random() < said))
    return frames


class FitConfidence(unittest.TestCase):
    def test_finds_the_weights_that_frames_were_drawn_from(self):
        print(f"seed {SEED}")
        weights = {"bias": 1.0, **dict.fromkeys(SIGNS, 0.0), "strain": -2.0, "coverage": 1.0}
        found = fit_confidence.fit(drawn(weights, 1200))
        for name, weight in weights.items():
            self.assertAlmostEqual(found[name], weight, delta=0.4, msg=name)

    def test_leaves_out_a_sign_that_speaks_the_wrong_way_round(self):
        weights = {"bias": 0.0, **dict.fromkeys(SIGNS, 0.0), "strain": 2.0, "agreeing": 1.0}
        found = fit_confidence.fit(drawn(weights, 600))
        self.assertEqual(found["strain"], 0.0)
        self.assertGreater(found["agreeing"], 0.3)

    def test_ends_where_right_and_wrong_frames_can_be_told_apart(self):
        frames = drawn(dict.fromkeys(["bias", *SIGNS], 0.0), 200)
        frames = [frame._replace(right=frame.signs["strain"] < -1.0) for frame in frames]
        weights = fit_confidence.fit(frames)
        self.assertLess(weights["strain"], -1.0)
        self.assertLess(weights["strain"], min(weights["residual"], weights["roughness"]))

    def test_names_solvers_with_too_few_wrong_frames(self):
        frames = [Frame("mine", "", 1.0, True, True, 1.0, dict.fromkeys(SIGNS, 0.0))] * 40
        self.assertIn("too few", "".join(fit_confidence.fitted(frames)))

    def test_counts_estimated_frames_that_are_wrong(self):
        frame = Frame("mine", "", 0.75, True, True, 1.0, {})
        wrong = frame._replace(right=False, mean_mm=12.0)
        silent = wrong._replace(mean_mm=21.0)
        told = silent._replace(estimated=False, confidence=0.0)
        table = list(fit_confidence.check([frame, wrong, silent, told]))
        self.assertIn("| `mine` | 4 | 1 | 3 | 1 | 2 | 0.297 |", table)
        self.assertIn("| 75 to 90 % | 3 | 75 % | 33 % |", table)

    def test_reads_signs_from_the_shapes_of_a_results_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            cell = root / "cells" / "ab"
            cell.mkdir(parents=True)
            (root / "results").mkdir()
            (root / "plan.json").write_text(json.dumps(
                {"cells": [{"key": "ab", "axes": {"solver": "mine", "scene": "clean"}}]}))
            seen = {"frame": 3, "state": "estimated", "outcome": "solved", "confidence": 0.9,
                    "seen_mm": 9.0, "truth": {"mean_mm": 9.5}}
            lines = [{"key": "ab", "outcome": "done", "metrics": {"frames": [
                seen, {"frame": 4, "state": "lost", "outcome": "held"}]}}]
            (root / "results" / "cached-000001.jsonl").write_text(
                "".join(json.dumps(line) + "\n" for line in lines))
            scalars = {"strain": 0.009, "strain_p95": 0.019, "kept_residual_px": 0.9,
                       "roughness_rad": 0.09, "size_px": 299.0, "agreeing_matches": 49.0,
                       "kept_matches": 99.0, "agreeing_coverage": 0.45}
            made = io.BytesIO()
            with zipfile.ZipFile(made, "w") as file:
                # 0.3 m by 0.4 m: 2 % of the diagonal are 10 mm.
                file.writestr("template/vertices_m.npy",
                              npy([0.0, 0.0, 0.0, 0.3, 0.4, 0.0], (2, 3)))
                for name, value in scalars.items():
                    file.writestr(f"000003.shape/diag.{name}.npy", npy([value], ()))
            (cell / "shapes.npz").write_bytes(made.getvalue())
            frames = fit_confidence.frames_of(root)
        self.assertEqual([(f.solver, f.scene, f.estimated, f.right) for f in frames],
                         [("mine", "clean", True, True)])
        self.assertAlmostEqual(frames[0].signs["residual"], 0.0)
        self.assertAlmostEqual(frames[0].signs["strain"], math.log(0.01))


if __name__ == "__main__":
    unittest.main()
