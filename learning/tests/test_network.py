# SPDX-License-Identifier: Apache-2.0
"""The network as torch computes it, as it is exported, and its losses."""

import copy
import tempfile
import unittest
from pathlib import Path

import numpy as np
import onnx_file
import torch

from weft_learning.batches import Batch
from weft_learning.errors import InputError
from weft_learning.export import TOLERANCE, _write_checked, difference, write_onnx
from weft_learning.losses import Grid, loss_parts, total
from weft_learning.network import SIZES, RegistrationNetwork, Shape, folded, multiplications, parameters

SEED = 7
SHAPE = Shape(160, 120, 10, 7)
ALLOWED = {"Conv", "Relu", "Add", "Concat", "Gemm", "Reshape", "Flatten", "Resize", "Pad", "Slice", "Mul", "Sub",
           "Constant"}


def random_images(count: int = 3) -> np.ndarray:
    """Images of noise, u8 [N,H,W,3]."""
    return np.random.default_rng(SEED).integers(0, 256, (count, 120, 160, 3), np.uint8)


def network_with_statistics(size: str) -> RegistrationNetwork:
    """A network whose batch norms have seen other means than 0."""
    torch.manual_seed(SEED)
    network = RegistrationNetwork(SIZES[size], SHAPE)
    with torch.no_grad():
        for module in network.modules():
            if isinstance(module, torch.nn.BatchNorm2d):
                module.running_mean.normal_(0, 0.3)
                module.running_var.uniform_(0.5, 2)
                module.weight.uniform_(0.5, 1.5)
                module.bias.normal_(0, 0.3)
    return network.eval()


class Network(unittest.TestCase):
    """Shapes, sizes, folding."""

    def test_outputs_have_the_shapes_of_the_format(self) -> None:
        for shape in (SHAPE, Shape(160, 128, 5, 4), Shape(96, 72, 3, 3)):
            network = RegistrationNetwork(SIZES["tiny"], shape).eval()
            cells, vertices = network(torch.zeros(2, 3, shape.height_px, shape.width_px))
            self.assertEqual(cells.shape, (2, 6, shape.height_px // 4, shape.width_px // 4))
            self.assertEqual(vertices.shape, (2, 3, shape.rows * shape.columns))

    def test_sizes_keep_their_budgets(self) -> None:
        for size, most_parameters, most_multiplications in (("standard", 0.75e6, 110e6), ("large", 1.5e6, 190e6)):
            network = RegistrationNetwork(SIZES[size], SHAPE)
            self.assertLessEqual(parameters(network), most_parameters)
            self.assertLessEqual(multiplications(network), most_multiplications)

    def test_folding_batch_norm_changes_nothing(self) -> None:
        print(f"seed {SEED}")
        network = network_with_statistics("standard")
        plain = folded(copy.deepcopy(network))
        self.assertFalse([m for m in plain.modules() if isinstance(m, torch.nn.BatchNorm2d)])
        image = torch.from_numpy(random_images().transpose(0, 3, 1, 2).astype(np.float32))
        with torch.no_grad():
            for a, b in zip(network(image), plain(image)):
                self.assertLess(float((a - b).abs().max() / a.abs().max()), 1e-5)


class Export(unittest.TestCase):
    """ONNX files in OpenCV."""

    def test_opencv_computes_the_same(self) -> None:
        print(f"seed {SEED}")
        with tempfile.TemporaryDirectory() as name:
            for size in SIZES:
                path = Path(name) / f"{size}.onnx"
                network = network_with_statistics(size)
                write_onnx(network, path)
                found = difference(network, path, random_images())
                print(f"{size}: {found:.2g}")
                self.assertLess(found, TOLERANCE)

    def test_an_untrained_network_can_be_exported(self) -> None:
        torch.manual_seed(SEED)
        network = RegistrationNetwork(SIZES["standard"], SHAPE)
        with tempfile.TemporaryDirectory() as name:
            write_onnx(network, Path(name) / "fresh.onnx")
            self.assertLess(difference(network, Path(name) / "fresh.onnx", random_images(1)), TOLERANCE)

    def test_only_allowed_operators_of_opset_11_are_used(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            for size in SIZES:
                path = Path(name) / "network.onnx"
                write_onnx(network_with_statistics(size), path)
                data = path.read_bytes()
                used = set(onnx_file.operators(data))
                self.assertIn("Conv", used)
                self.assertLessEqual(used, ALLOWED)
                self.assertEqual(onnx_file.opset(data), 11)

    def test_a_file_of_another_network_fails_the_check(self) -> None:
        network = network_with_statistics("tiny")
        with tempfile.TemporaryDirectory() as name:
            path = Path(name) / "network.onnx"
            write_onnx(network, path)
            with torch.no_grad():
                network.cells.bias += 0.01
            self.assertGreater(difference(network, path, random_images(1)), TOLERANCE)

    def test_weights_that_are_not_finite_fail_the_check(self) -> None:
        network = network_with_statistics("tiny").train()
        with tempfile.TemporaryDirectory() as name:
            _write_checked(network, Path(name) / "network.onnx", random_images(1))
            with torch.no_grad():
                network.vertices.weight[0, 0] = float("nan")
            with self.assertRaisesRegex(InputError, "differ by inf"):
                _write_checked(network, Path(name) / "network.onnx", random_images(1))


class Losses(unittest.TestCase):
    """Values of the loss that can be computed by hand."""

    def batch(self) -> Batch:
        """Two samples of 1 x 2 cells; the second has no object."""
        return Batch(torch.zeros(2, 3, 4, 8), torch.tensor([[[1.0, 0.4]], [[0.0, 0.0]]]), torch.full((2, 2, 1, 2), 0.5),
                     torch.zeros(2, 1, 2), torch.tensor([[[True, True]], [[False, False]]]), self.flat(),
                     torch.tensor([[1.0, 1, 0.5, 0.5], [0, 0, 0, 0]]))

    @staticmethod
    def flat() -> torch.Tensor:
        """A grid of 2 x 2 vertices at 1 m, twice."""
        x, y = torch.tensor([0.0, 0.2, 0.0, 0.2]), torch.tensor([0.0, 0.0, 0.1, 0.1])
        return torch.stack([x, y, torch.zeros(4)])[None].repeat(2, 1, 1)

    def test_each_part_has_its_value(self) -> None:
        cells = torch.zeros(2, 6, 1, 2)
        cells[:, 1], cells[:, 2] = 0.5 + 0.04, 0.5 - 0.08
        cells[:, 3], cells[:, 4], cells[:, 5] = -2.0, 0.3, -1.0
        cells[0, 1:, 0, 1] = 99.0  # Less than half covered: must not count.
        vertices = self.flat()
        vertices[0, 0] += torch.tensor([0.03, 0.0, 0.06, 0.0])
        vertices[1] += 5.0  # No object: must not count.
        parts = loss_parts(cells, vertices, self.batch(), Grid(2, 2, 0.2, 0.1))
        self.assertAlmostEqual(float(parts["mask"]), np.log(2), places=5)
        self.assertAlmostEqual(float(parts["uv"]), 2 * (0.5 * (0.04 + 0.5 * 0.08) * np.e ** 2 - 2), places=4)
        self.assertAlmostEqual(float(parts["depth"]), 0.3 * np.e - 1, places=5)
        self.assertAlmostEqual(float(parts["vertices"]), (0.03 + 0.5 * 0.06) / (3 * 3), places=6)
        across = (0.03 + 0.06) / 0.2 / 2  # Two edges along x are shorter, relative to 0.2 m.
        down = (np.hypot(0.03, 0.1) - 0.1) / 0.1 / 2
        self.assertAlmostEqual(float(parts["edges"]), 0.5 * (across + down), places=5)
        expected = parts["mask"] + 0.3 * parts["uv"] + 0.15 * parts["depth"] + 10 * parts["vertices"]
        self.assertAlmostEqual(float(total(parts)), float(expected + 0.1 * parts["edges"]), places=5)

    def test_the_expected_error_is_clamped(self) -> None:
        cells = torch.zeros(2, 6, 1, 2)
        values = []
        for log_error in (-6.0, -60.0):
            cells[:, 3] = cells[:, 5] = log_error
            values.append(float(total(loss_parts(cells, self.flat(), self.batch(), Grid(2, 2, 0.2, 0.1)))))
        self.assertEqual(*values)
        self.assertTrue(np.isfinite(values).all())

    def test_a_batch_without_any_object_has_gradients_of_the_mask_alone(self) -> None:
        batch = self.batch()
        batch.mask.zero_()
        batch.labelled.zero_()
        batch.weight.zero_()
        cells = torch.zeros(2, 6, 1, 2, requires_grad=True)
        vertices = self.flat().requires_grad_()
        total(loss_parts(cells, vertices, batch, Grid(2, 2, 0.2, 0.1))).backward()
        self.assertTrue((cells.grad[:, 0] > 0).all())
        self.assertEqual(float(cells.grad[:, 1:].abs().max()), 0)
        self.assertEqual(float(vertices.grad.abs().max()), 0)
