# SPDX-License-Identifier: Apache-2.0
"""Reading of shards: splits, order, and the refusal of damaged ones."""

import json
import tempfile
import unittest
from pathlib import Path

import numpy as np
import synthetic

from weft_learning.batches import read_batch
from weft_learning.errors import InputError
from weft_learning.shards import Shards, order_of_epoch

SEED = 11


def refuse_to_wait(message: str) -> None:
    """Fails a test whose shards are all there."""
    raise AssertionError(message)


class DamagedShards(unittest.TestCase):
    """Each case damages a copy of good shards and reads the message."""

    @classmethod
    def setUpClass(cls) -> None:
        print(f"seed {SEED}")
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = Path(cls.temporary.name) / "shards"
        synthetic.write_shards(cls.folder, 12, SEED, length=8)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.temporary.cleanup()

    def refused(self, path: Path, content: bytes | None, *parts: str) -> None:
        """Replaces or removes a file, expects a message with its path, a fix and `parts`, and restores it."""
        original = path.read_bytes()
        try:
            path.unlink() if content is None else path.write_bytes(content)
            with self.assertRaises(InputError) as caught:
                Shards(self.folder, None, refuse_to_wait).gather(np.arange(12))
            for part in (str(path.parent), *parts):
                self.assertIn(part, str(caught.exception))
            self.assertRegex(str(caught.exception), "; (remove|write|give|the network)")
        finally:
            path.write_bytes(original)
        Shards(self.folder, None, refuse_to_wait).gather(np.arange(12))

    def changed(self, name: str, change) -> bytes:
        """Bytes of an array of the second shard after `change`."""
        path = self.folder / "000001" / name
        array = change(np.load(path))
        other = Path(self.temporary.name) / name
        np.save(other, array)
        return other.read_bytes()

    def test_a_short_file_is_refused(self) -> None:
        path = self.folder / "000001" / "image.npy"
        self.refused(path, path.read_bytes()[:-100], "image.npy: cannot be read")

    def test_a_file_without_a_header_is_refused(self) -> None:
        self.refused(self.folder / "000000" / "uv.npy", b"", "uv.npy: cannot be read")

    def test_a_missing_array_is_refused(self) -> None:
        self.refused(self.folder / "000001" / "depth.npy", None, "depth.npy: missing")

    def test_a_wrong_shape_is_refused(self) -> None:
        content = self.changed("mask.npy", lambda a: a[:, :, 1:])
        self.refused(self.folder / "000001" / "mask.npy", content, "(4, 30, 39)", "(4, 30, 40)")

    def test_a_wrong_number_of_samples_is_refused(self) -> None:
        content = self.changed("visible.npy", lambda a: a[1:])
        self.refused(self.folder / "000001" / "visible.npy", content, "(3, 70)")

    def test_a_wrong_type_is_refused(self) -> None:
        content = self.changed("uv.npy", lambda a: a.astype(np.float32))
        self.refused(self.folder / "000001" / "uv.npy", content, "<f4", "<u2")

    def test_a_single_nan_is_refused_with_its_sample(self) -> None:
        def change(vertices: np.ndarray) -> np.ndarray:
            vertices[:] = 1
            vertices[2, 5, 1] = np.nan
            return vertices
        content = self.changed("vertices_m.npy", change)
        self.refused(self.folder / "000001" / "vertices_m.npy", content, "sample 2 has vertices that are not finite")

    def test_a_point_behind_the_camera_is_refused(self) -> None:
        def change(vertices: np.ndarray) -> np.ndarray:
            vertices[:] = 1
            vertices[0, 3, 2] = -0.5
            return vertices
        content = self.changed("vertices_m.npy", change)
        self.refused(self.folder / "000001" / "vertices_m.npy", content, "sample 0", "in front of the camera")

    def test_another_format_is_refused(self) -> None:
        path = self.folder / "shards.json"
        self.refused(path, path.read_bytes().replace(b"shards/1", b"shards/2"), "format is not weft.shards/1")

    def test_a_missing_key_is_named(self) -> None:
        path = self.folder / "shards.json"
        content = json.loads(path.read_text())
        del content["template"]["texture_hash"]
        self.refused(path, json.dumps(content).encode(), "texture_hash is missing")

    def test_more_samples_than_frames_are_refused(self) -> None:
        with self.assertRaisesRegex(InputError, "--samples 13 of 12 frames; give 1 to 12"):
            Shards(self.folder, 13, refuse_to_wait)


class Growing(unittest.TestCase):
    """Shards that are still being written."""

    def test_samples_must_be_given_while_their_number_is_unknown(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            synthetic.write_shards(Path(name), 12, SEED, length=8, written=1)
            with self.assertRaisesRegex(InputError, "still being written; give --samples"):
                Shards(Path(name), None, refuse_to_wait)
            self.assertEqual(Shards(Path(name), 8, refuse_to_wait).gather(np.arange(8))["image"].shape[0], 8)

    def test_a_wait_ends_with_an_error_when_the_shards_are_complete_without_the_awaited_one(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            synthetic.write_shards(Path(name), 24, SEED, length=8, written=1)
            waited = []

            def wait(message: str) -> None:
                waited.append(message)
                (Path(name) / "shards.json").write_text(json.dumps(synthetic.describe(8)))

            with self.assertRaisesRegex(InputError, "000001: missing, but the 8 frames .* are complete"):
                Shards(Path(name), 16, wait).gather(np.array([9]))
            self.assertEqual(waited, [f"waiting for {Path(name) / '000001'}"])


class Reading(unittest.TestCase):
    """Values and order of good shards."""

    def test_batches_have_the_values_of_the_arrays(self) -> None:
        print(f"seed {SEED}")
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            synthetic.write_shards(folder, 40, SEED, length=16)
            shards = Shards(folder, None, refuse_to_wait)
            index = np.array([39, 3, 17])
            batch = read_batch(shards, index)
            for row, k in enumerate(index):
                stored = {name: np.load(folder / f"{k // 16:06d}" / f"{name}.npy")[k % 16]
                          for name in shards.description.arrays(0)}
                np.testing.assert_array_equal(batch.image[row].numpy().transpose(1, 2, 0), stored["image"])
                np.testing.assert_allclose(batch.mask[row].numpy() * 255, stored["mask"], atol=1e-4)
                labelled = batch.labelled[row].numpy()
                np.testing.assert_array_equal(labelled, stored["depth"] > 0)
                np.testing.assert_allclose(batch.uv[row].numpy().transpose(1, 2, 0)[labelled] * 65534,
                                           stored["uv"][labelled], atol=0.02)
                np.testing.assert_allclose(np.exp(batch.log_depth[row].numpy()[labelled]) * 1e4,
                                           stored["depth"][labelled], rtol=1e-5)
                if np.isfinite(stored["vertices_m"]).all():
                    x, y, log_z = batch.vertices[row].numpy()
                    z = np.exp(log_z)
                    np.testing.assert_allclose(np.stack([x * z, y * z, z], 1), stored["vertices_m"], atol=1e-6)
                    np.testing.assert_array_equal(batch.weight[row].numpy(), 0.5 + 0.5 * stored["visible"])
                else:
                    self.assertEqual(float(batch.weight[row].sum()), 0)

    def test_splits_do_not_overlap_and_keep_their_indices_when_samples_are_added(self) -> None:
        with tempfile.TemporaryDirectory() as name:
            synthetic.write_shards(Path(name), 60, SEED, length=60)
            few, all_ = Shards(Path(name), 40, refuse_to_wait), Shards(Path(name), None, refuse_to_wait)
            parts = [all_.indices(split) for split in ("train", "validation", "test")]
            np.testing.assert_array_equal(np.sort(np.concatenate(parts)), np.arange(60))
            np.testing.assert_array_equal(parts[1], [18, 38, 58])
            np.testing.assert_array_equal(parts[2], [19, 39, 59])
            np.testing.assert_array_equal(few.indices("validation"), [18, 38])

    def test_the_first_epoch_follows_the_writer_and_later_ones_mix_all(self) -> None:
        indices = np.arange(1000) * 3
        first, second = (order_of_epoch(indices, SEED, epoch, window=100) for epoch in (0, 1))
        for order in (first, second):
            np.testing.assert_array_equal(np.sort(order), indices)
        windows = first.reshape(10, 100) // 300
        self.assertTrue((windows == np.arange(10)[:, None]).all())
        self.assertFalse((first[:100] == indices[:100]).all())
        self.assertGreater(len(set(second[:100] // 300)), 5)
        self.assertFalse((order_of_epoch(indices, SEED + 1, 0, 100) == first).all())
