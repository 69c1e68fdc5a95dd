# SPDX-License-Identifier: Apache-2.0
"""Trainings as a user runs them: they learn, survive a kill, wait for shards, and refuse other settings."""

import csv
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import cv2
import numpy as np
import synthetic
import torch
import xxhash
import yaml

SEED = 3
FRAMES, LENGTH = 320, 160
PATIENCE_S = 600  # A training takes some seconds, and much longer beside other programs.
LEARNING = Path(__file__).resolve().parent.parent
SETTINGS = ["--size", "tiny", "--batch", "8", "--epochs", "12", "--seed", str(SEED), "--checkpoint-samples", "240"]


def command(shards: Path, out: Path, *more: str) -> list[str]:
    """Command of a training that takes some seconds; later options override."""
    return [sys.executable, "-u", str(LEARNING / "train.py"), str(shards), "--out", str(out), "--name", "sheet",
            *SETTINGS, *more]


def train(shards: Path, out: Path, *more: str) -> subprocess.CompletedProcess:
    """Runs a training to its end."""
    return subprocess.run(command(shards, out, *more), capture_output=True, text=True, timeout=PATIENCE_S, check=False)


def rows(out: Path) -> list[dict[str, str]]:
    """Rows of the curve."""
    return list(csv.DictReader((out / "curve.csv").read_text().splitlines()))


def wait_for(process: subprocess.Popen, condition) -> None:
    """Waits until `condition()`; fails when the process ends first."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        if process.poll() is not None or time.monotonic() > end:
            process.kill()
            raise AssertionError(f"too early or too late: {process.communicate()}")
        time.sleep(0.005)


class Trainings(unittest.TestCase):
    """All cases share the shards and one training that nothing interrupted."""

    @classmethod
    def setUpClass(cls) -> None:
        print(f"seed {SEED}")
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        cls.shards, cls.whole = cls.folder / "shards", cls.folder / "whole"
        synthetic.write_shards(cls.shards, FRAMES, SEED, LENGTH)
        began = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        cls.result = train(cls.shards, cls.whole)
        cls.seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - began

    @classmethod
    def tearDownClass(cls) -> None:
        cls.temporary.cleanup()

    def test_the_loss_halves_in_less_than_a_minute(self) -> None:
        self.assertEqual(self.result.returncode, 0, self.result.stderr)
        loss = [float(row["loss"]) for row in rows(self.whole)]
        first, last = np.mean(loss[:2]), np.mean(loss[-5:])
        print(f"loss {first:.3f}, at the end {last:.3f}, after {self.seconds:.0f} s of CPU time")
        self.assertGreater(first, 0)
        self.assertLess(last, 0.5 * first)
        self.assertLess(self.seconds, 60)

    def test_the_description_matches_the_network_and_the_shards(self) -> None:
        described = yaml.safe_load((self.whole / "sheet.yaml").read_text())
        data = (self.whole / "sheet.onnx").read_bytes()
        self.assertEqual(described["onnx_hash"], xxhash.xxh3_64_hexdigest(data))
        shards = synthetic.describe(FRAMES)
        self.assertEqual(described["camera"], shards["camera"])
        self.assertEqual(described["template"], {k: shards["template"][k] for k in described["template"]})
        self.assertEqual((described["weft_network"], described["kind"]), (1, "registration"))
        training = described["training"]
        self.assertTrue(training["complete"])
        self.assertEqual((training["seed"], training["samples"]), (SEED, FRAMES))
        network = cv2.dnn.readNetFromONNX(str(self.whole / described["onnx"]))
        network.setInput(np.zeros((1, 3, 120, 160), np.float32), described["image"]["input"])
        cells, vertices = network.forward([described["cells"]["output"], described["vertices"]["output"]])
        self.assertEqual(cells.shape, (1, 6, described["cells"]["rows"], described["cells"]["columns"]))
        self.assertEqual(vertices.shape, (1, 3, described["vertices"]["rows"] * described["vertices"]["columns"]))

    def test_the_factor_of_the_expected_error_is_that_of_the_exported_network(self) -> None:
        described = yaml.safe_load((self.whole / "sheet.yaml").read_text())
        network = cv2.dnn.readNetFromONNX(str(self.whole / "sheet.onnx"))
        errors = expected = 0.0
        for k in range(18, FRAMES, 20):
            sample = {a: np.load(self.shards / f"{k // LENGTH:06d}" / f"{a}.npy")[k % LENGTH]
                      for a in ("image", "uv", "mask", "depth")}
            network.setInput(sample["image"].transpose(2, 0, 1)[None].astype(np.float32), "image")
            cells = network.forward("cells")[0]
            seen = (sample["mask"] > 127.5) & (sample["depth"] > 0)
            away = np.abs(cells[1:3] - sample["uv"].transpose(2, 0, 1) / 65534)[:, seen]
            errors += 0.5 * (away[0] + away[1] * synthetic.HEIGHT_M / synthetic.WIDTH_M).sum()
            expected += np.exp(np.clip(cells[3][seen], -6, 2)).sum()
        self.assertGreater(expected, 0)
        self.assertAlmostEqual(described["uv_error_factor"] / (errors / expected), 1, places=3)

    def test_a_killed_training_continues_to_the_same_curve_and_network(self) -> None:
        out = self.folder / "killed"
        for least in (20, 40):
            process = subprocess.Popen(command(self.shards, out), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
            wait_for(process, lambda: (out / "curve.csv").exists() and len(rows(out)) >= least)
            process.send_signal(signal.SIGKILL)
            self.assertEqual(process.wait(), -signal.SIGKILL)
            process.stderr.close()
        before = torch.load(out / "checkpoint.pt")["step"]
        result = train(self.shards, out)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertGreater(before, 0)
        self.assertLess(before, torch.load(self.whole / "checkpoint.pt")["step"])
        self.assertEqual((out / "curve.csv").read_bytes(), (self.whole / "curve.csv").read_bytes())
        self.assertEqual((out / "sheet.onnx").read_bytes(), (self.whole / "sheet.onnx").read_bytes())

    def test_an_interrupt_writes_a_checkpoint_of_that_step(self) -> None:
        out = self.folder / "interrupted"
        process = subprocess.Popen(command(self.shards, out, "--checkpoint-samples", "1000000"), text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        wait_for(process, lambda: (out / "curve.csv").exists() and len(rows(out)) >= 2)
        process.terminate()
        printed, errors = process.communicate()
        self.assertEqual(process.returncode, 128 + signal.SIGTERM, errors)
        self.assertIn("stopped by SIGTERM", printed)
        self.assertGreater(torch.load(out / "checkpoint.pt")["step"], 0)
        self.assertFalse((out / "sheet.onnx").exists())

    def test_minutes_stop_early_and_export_makes_a_network_of_the_checkpoint(self) -> None:
        out = self.folder / "minutes"
        result = train(self.shards, out, "--minutes", "0")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertIn("stopped after 0 minutes; the same command continues", result.stdout)
        result = subprocess.run([sys.executable, str(LEARNING / "export.py"), str(self.shards), str(out)],
                                capture_output=True, text=True, check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertFalse(yaml.safe_load((out / "minutes.yaml").read_text())["training"]["complete"])

    def test_other_settings_than_those_of_the_checkpoint_are_refused(self) -> None:
        for option, value, name in (("--seed", "4", "seed is 3 there and 4 here"), ("--batch", "4", "batch is 8"),
                                    ("--epochs", "3", "epochs is 12"), ("--size", "standard", "size is 'tiny'"),
                                    ("--samples", "300", "samples is 320"),
                                    ("--rate", "0.1", "learning_rate is 0.003")):
            result = train(self.shards, self.whole, option, value)
            self.assertEqual(result.returncode, 2)
            self.assertIn(name, result.stderr)
            self.assertIn("use the same settings or another --out", result.stderr)

    def test_other_shards_than_those_of_the_checkpoint_are_refused(self) -> None:
        other = self.folder / "other"
        synthetic.write_shards(other, FRAMES, SEED, LENGTH, written=0)
        (other / "000000").symlink_to(self.shards / "000000")
        (other / "make.yaml").write_text("# another recipe\n")
        result = train(other, self.whole, "--samples", str(FRAMES))
        self.assertEqual(result.returncode, 2)
        self.assertIn("recipe_hash is", result.stderr)

    def test_a_training_waits_for_shards_and_has_the_same_curve(self) -> None:
        growing, out, at_once = self.folder / "growing", self.folder / "waited", self.folder / "at_once"
        synthetic.write_shards(growing, FRAMES, SEED, LENGTH, written=0)
        one_epoch = ("--epochs", "1", "--samples", str(FRAMES))
        process = subprocess.Popen(command(growing, out, *one_epoch), stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   text=True)
        self.assertIn("waiting for", process.stdout.readline())
        for number in ("000000", "000001"):
            time.sleep(0.5)
            self.assertIsNone(process.poll())
            os.symlink(self.shards / number, growing / number)
        printed = process.communicate(timeout=PATIENCE_S)[0]
        self.assertEqual(process.returncode, 0, printed)
        self.assertEqual(train(self.shards, at_once, *one_epoch).returncode, 0)
        self.assertEqual((out / "curve.csv").read_bytes(), (at_once / "curve.csv").read_bytes())
        # Their number is still unknown: the checkpoint has it.
        self.assertEqual(train(growing, out, "--epochs", "1").returncode, 0)
        self.assertIn("still being written", train(growing, self.folder / "new").stderr)

    def test_curves_become_a_page_a_figure_and_a_table(self) -> None:
        for name in ("page.html", "figure.svg"):
            result = subprocess.run([sys.executable, str(LEARNING / "curve.py"), str(self.whole), str(self.whole),
                                     "--out", str(self.folder / name), "--markdown"], capture_output=True, text=True,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
            text = (self.folder / name).read_text()
            self.assertIn("<svg", text)
            self.assertIn("</svg>", text)
        last = rows(self.whole)[-1]
        self.assertIn(f"| {int(last['samples']):,} | {float(last['val_iou']):.3g} |", result.stdout)

    def test_a_damaged_checkpoint_is_refused(self) -> None:
        out = self.folder / "damaged"
        out.mkdir()
        (out / "checkpoint.pt").write_bytes((self.whole / "checkpoint.pt").read_bytes()[:5000])
        result = train(self.shards, out)
        self.assertEqual(result.returncode, 2)
        self.assertIn("remove it to train from the start", result.stderr)
