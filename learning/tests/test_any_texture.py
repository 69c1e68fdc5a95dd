# SPDX-License-Identifier: Apache-2.0
"""The network for any texture: its scenes, its training, and OpenCV's answer."""

import argparse
import contextlib
import io
import tempfile
import unittest
import unittest.mock
from pathlib import Path

import cv2
import numpy as np
import onnx_file
import synthetic
import torch
import yaml
from test_network import ALLOWED
from weft_learning.any_texture.export import Stacked, difference, export, stacked, write_onnx
from weft_learning.any_texture.network import CANVAS_PX, PLACES, SIZES, AnyTextureNetwork
from weft_learning.any_texture.scenes import GREY, Maker, Scenes, on_canvas, textured
from weft_learning.any_texture.textures import random_texture
from weft_learning.any_texture.training import Training, place_loss
from weft_learning.batches import Batch
from weft_learning.errors import InputError

SEED = 5
FRAMES = 150
EXTRA = {"MatMul", "Softmax", "Transpose", "ReduceSum", "Sqrt", "Div"}


def write_grey_scenes(folder: Path) -> None:
    """Shards with cells of 2 px of a grey rectangle."""
    grey = np.full((357, 594, 3), int(GREY), np.uint8)
    cells = {"CELL_PX": 2, "CELL_COLUMNS": 80, "CELL_ROWS": 60}
    with unittest.mock.patch.multiple(synthetic, random_texture=lambda _: grey, **cells):
        synthetic.write_shards(folder, FRAMES, SEED, 64)


class AnyTexture(unittest.TestCase):
    """All cases share the scenes."""

    @classmethod
    def setUpClass(cls) -> None:
        print(f"seed {SEED}")
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name)
        write_grey_scenes(cls.folder / "scenes")

    @classmethod
    def tearDownClass(cls) -> None:
        cls.temporary.cleanup()

    def training(self, out: str, samples: int, textures: int = 20) -> Training:
        """A training of the tiny network that continues from its checkpoint."""
        (self.folder / out).mkdir(exist_ok=True)
        options = argparse.Namespace(out=self.folder / out, samples=samples, size="tiny", seed=SEED, batch=8, rate=3e-3,
                                     textures=textures)
        return Training([Scenes(self.folder / "scenes")], options)

    def test_the_surface_shows_the_texture_at_its_template_points(self) -> None:
        columns, rows = np.meshgrid((np.arange(80) + 0.5) / 80, (np.arange(60) + 0.5) / 60)
        uv = np.stack([columns, rows], 2).astype(np.float32)
        texture = np.zeros((120, 160, 3), np.uint8)
        texture[..., 0], texture[..., 1] = np.arange(160), 2 * np.arange(120)[:, None]
        light = np.float32([0.5, 0.25, 0.5])
        image = np.full((120, 160, 3), GREY * light, np.float32)
        everywhere = np.ones((60, 80))
        shown = textured(image, uv, everywhere > 0, everywhere.astype(np.float32), texture, 0.0)
        inner = np.s_[4:-4, 4:-4]
        np.testing.assert_allclose(shown[inner], light * texture[inner], atol=0.3)
        np.testing.assert_array_equal(textured(image, uv, everywhere > 0, 0 * uv[..., 0], texture, 0.0), image)

    def test_labels_are_places_on_the_canvas(self) -> None:
        scenes = Scenes(self.folder / "scenes")
        batch, canvas = Maker([scenes], SEED, 3).batch([(0, k) for k in range(8)], np.random.default_rng(SEED))
        self.assertEqual(canvas.shape, (8, 3, CANVAS_PX, CANVAS_PX))
        self.assertEqual(batch.uv.shape, (8, 2, 30, 40))
        below = synthetic.HEIGHT_M / synthetic.WIDTH_M
        places = batch.uv.permute(1, 0, 2, 3)[:, batch.labelled]
        self.assertGreater(places.shape[1], 100)
        self.assertLessEqual(float(places[1].max()), below)
        self.assertGreater(float(places[1].max()), 0.9 * below)
        self.assertGreater(float(places[0].max()), 0.9)
        # The depth is a multiple of the longer side.
        depth_m = batch.log_depth[batch.labelled].exp() * synthetic.WIDTH_M
        self.assertTrue(0.2 < float(depth_m.min()) < float(depth_m.max()) < 1.2)

    def test_a_canvas_repeats_the_border_of_the_texture(self) -> None:
        texture = np.zeros((100, 200, 3), np.uint8)
        texture[-3:] = 200
        canvas = on_canvas(texture, CANVAS_PX)
        self.assertEqual(int(canvas[:46].max()), 0)
        self.assertTrue((canvas[48:] == canvas[47]).all())
        self.assertGreater(int(canvas[-1].min()), 100)

    def test_textures_have_their_shape_and_depend_on_the_seed_alone(self) -> None:
        for aspect, shape in ((1.6, (200, 320, 3)), (0.5, (320, 160, 3))):
            first, again, other = (random_texture(np.random.default_rng(s), aspect) for s in (1, 1, 2))
            self.assertEqual(first.shape, shape)
            np.testing.assert_array_equal(first, again)
            self.assertFalse(np.array_equal(first, other))

    def test_the_place_loss_is_least_at_the_true_place(self) -> None:
        uv = torch.full((1, 2, 30, 40), (3 + 0.5) / PLACES)
        uv[:, 1] = (7 + 0.5) / PLACES
        labelled = torch.ones(1, 30, 40, dtype=torch.bool)
        batch = Batch(torch.zeros(0), torch.ones(1, 30, 40), uv, torch.zeros(1, 30, 40), labelled, torch.zeros(0),
                      torch.zeros(0))
        for place, least in ((7 * PLACES + 3, True), (3 * PLACES + 7, False)):
            correlation = torch.zeros(1, 320, PLACES * PLACES)
            correlation[:, :, place] = 20
            self.assertEqual(float(place_loss(correlation, batch, labelled)) < 0.01, least)
        self.assertEqual(float(place_loss(correlation, batch, ~labelled)), 0)

    def test_opencv_gives_the_same_cells(self) -> None:
        torch.manual_seed(SEED)
        random = np.random.default_rng(SEED)
        for size in SIZES:
            network = AnyTextureNetwork(SIZES[size])
            for _ in range(3):  # statistics of batch norm
                network(torch.rand(4, 3, 120, 160) * 255, torch.rand(4, 3, CANVAS_PX, CANVAS_PX) * 255)
            path = self.folder / f"{size}.onnx"
            write_onnx(network, path)
            self.assertLessEqual(set(onnx_file.operators(path.read_bytes())), ALLOWED | EXTRA)
            inputs = [stacked(random.uniform(0, 255, (3, 120, 160)), random.uniform(0, 255, (3, 96, 96)))
                      for _ in range(2)]
            self.assertLess(difference(network, path, inputs), 1e-4)
            # Both inputs count.
            plain = Stacked(network.eval())
            cells = [plain(torch.from_numpy(values)) for values in inputs]
            mixed = inputs[0].copy()
            mixed[:, :, 120:] = inputs[1][:, :, 120:]
            self.assertGreater(float((plain(torch.from_numpy(mixed)) - cells[0]).abs().max()), 1e-4)

    def test_a_training_learns_continues_and_exports(self) -> None:
        whole = self.training("whole", 640)
        with contextlib.redirect_stdout(io.StringIO()):
            with unittest.mock.patch("weft_learning.any_texture.training.EVERY", 160):
                whole.run()
                first = self.training("parts", 640)
                batch = first.maker.batch
                stopped = lambda *given: self.fail("stopped") if first.step == 45 else batch(*given)
                with unittest.mock.patch.object(first.maker, "batch", stopped):
                    self.assertRaises(AssertionError, first.run)
                with self.assertRaisesRegex(InputError, "another schedule"):
                    self.training("parts", 320)
                parts = self.training("parts", 640)
                self.assertEqual(parts.step, 40)
                parts.run()
        self.assertLess(whole.curve[-1]["loss"], whole.curve[0]["loss"] - 0.3)
        np.testing.assert_equal(whole.curve, parts.curve)  # also where a metric is not a number
        description = export(whole, "any")
        self.assertEqual(description["texture"], {"side_px": CANVAS_PX})
        self.assertEqual(yaml.safe_load((self.folder / "whole" / "any.yaml").read_text()), description)
        cv2.dnn.readNetFromONNX(str(self.folder / "whole" / "any.onnx"))

    def test_other_shards_are_refused(self) -> None:
        synthetic.write_shards(self.folder / "coarse", 4, SEED, 4)
        with self.assertRaisesRegex(InputError, "sinks.cell_px=2"):
            Scenes(self.folder / "coarse")
        with self.assertRaisesRegex(InputError, "write the shards again"):
            Scenes(self.folder / "nothing")
