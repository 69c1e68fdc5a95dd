# SPDX-License-Identifier: Apache-2.0
"""Labels of cells: their place in the image, and what a covering rectangle removes."""

import tempfile
import unittest
from pathlib import Path

import cv2
import numpy as np
import synthetic
import torch
from test_shards import refuse_to_wait

from weft_learning.batches import Augmentation, covered_share, read_batch
from weft_learning.shards import Shards

SEED = 5
SQUARES_X, SQUARES_Y = 10, 6


def checker(texels: int = 60) -> np.ndarray:
    """Texture of squares."""
    rows, columns = np.indices((SQUARES_Y * texels, SQUARES_X * texels)) // texels
    return np.repeat(((rows + columns) % 2 * 215 + 20).astype(np.uint8)[..., None], 3, axis=2)


def errors_px(image: np.ndarray, uv: np.ndarray, labelled: np.ndarray, pose: np.ndarray) -> list[float]:
    """Distances between corners found in the image and where the labels of the cells around put them."""
    found, errors = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), []
    centre_x, centre_y = synthetic.cell_centres_px()
    for i in range(1, SQUARES_Y):
        for j in range(1, SQUARES_X):
            share = np.array([j / SQUARES_X, i / SQUARES_Y])
            expected = synthetic.CAMERA @ pose @ [share[0] * synthetic.WIDTH_M, share[1] * synthetic.HEIGHT_M, 1]
            corner = cv2.cornerSubPix(found, (expected[None, None, :2] / expected[2]).astype(np.float32), (3, 3),
                                      (-1, -1), (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_MAX_ITER, 50, 1e-4))[0, 0]
            away = np.hypot(centre_x - corner[0], centre_y - corner[1])
            around = labelled & (away < 10)
            if around.sum() < 8:
                continue
            # A homography from the labels around says where they put this corner.
            of_labels = np.stack([centre_x[around], centre_y[around]], 1)
            warp = cv2.findHomography(uv[:, around].T.astype(np.float64), of_labels)[0]
            at = warp @ [*share, 1]
            errors.append(float(np.hypot(*(at[:2] / at[2] - corner))))
    return errors


class Checker(unittest.TestCase):
    """The image itself confirms the labels."""

    def test_corners_of_a_checker_lie_where_the_labels_put_them(self) -> None:
        print(f"seed {SEED}")
        random = np.random.default_rng(SEED)
        grey = np.full((synthetic.HEIGHT_PX * synthetic.FINER, synthetic.WIDTH_PX * synthetic.FINER, 3), 128, np.uint8)
        poses = [synthetic.random_pose(random, tilt_rad=0.2) for _ in range(8)]
        for pose in poses:
            pose[:, 2] *= 0.42 / pose[2, 2]  # Near enough for squares of ten pixels.
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            synthetic.write_shards(folder, 8, SEED, written=0)
            synthetic.write_shard(folder / "000000", [synthetic.render(checker(), p, grey, random) for p in poses])
            batch = read_batch(Shards(folder, 8, refuse_to_wait), np.arange(8))
        errors: list[float] = []
        for k, pose in enumerate(poses):
            image = batch.image[k].permute(1, 2, 0).numpy().astype(np.uint8)
            errors += errors_px(image, batch.uv[k].numpy(), batch.labelled[k].numpy(), pose)
        print(f"{len(errors)} corners, median {np.median(errors):.3f} px")
        self.assertGreater(len(errors), 100)
        self.assertLess(np.median(errors), 0.1)


class Covering(unittest.TestCase):
    """Rectangles of the augmentation."""

    def test_the_share_of_covered_cells_is_exact(self) -> None:
        for begin, end in ((0, 4), (3, 9), (5, 6), (0, 40), (7, 7)):
            pixels = np.zeros(40)
            pixels[begin:end] = 1
            np.testing.assert_allclose(covered_share(begin, end, 10, 4), pixels.reshape(10, 4).mean(axis=1))

    def test_a_covered_cell_loses_mask_and_label_and_the_draw_depends_on_the_step_alone(self) -> None:
        print(f"seed {SEED}")
        with tempfile.TemporaryDirectory() as name:
            synthetic.write_shards(Path(name), 16, SEED, length=16)
            shards = Shards(Path(name), None, refuse_to_wait)
            plain = read_batch(shards, np.arange(16))
            again = [read_batch(shards, np.arange(16)) for _ in range(3)]
            for batch, step in zip(again, (4, 4, 5)):
                Augmentation(SEED, shards.description)(batch, step)
        self.assertTrue(torch.equal(again[0].image, again[1].image) and torch.equal(again[0].mask, again[1].mask))
        self.assertFalse(torch.equal(again[0].image, again[2].image))
        lower = again[0].mask < plain.mask
        self.assertTrue(lower.any())
        self.assertFalse((again[0].mask > plain.mask).any())
        self.assertFalse((lower & again[0].labelled).any())
        self.assertTrue((again[0].labelled == plain.labelled)[~lower & (plain.mask > 0)].all())
        self.assertTrue(torch.equal(again[0].vertices, plain.vertices))
        self.assertGreaterEqual(float(again[0].image.min()), 0)
        self.assertLessEqual(float(again[0].image.max()), 255)
