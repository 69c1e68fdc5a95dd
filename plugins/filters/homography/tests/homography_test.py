# SPDX-License-Identifier: Apache-2.0
import types
import unittest

import numpy as np
import weft
from homography import Homography

SEED = 20
PLANE = np.array([[0.9, 0.1, 40.0], [-0.05, 1.1, 25.0], [1e-4, -2e-4, 1.0]])


class Call:
    def __init__(self, seed=SEED):
        self.seed = seed

    def rng(self):
        return np.random.Generator(np.random.PCG64(self.seed))

    def go_on(self):
        pass


def on_plane(points_px):
    lifted = np.column_stack([points_px, np.ones(len(points_px))]) @ PLANE.T
    return lifted[:, :2] / lifted[:, 2:]


def flat(count, mismatches, noise_px=0.5, seed=SEED):
    """Matches of a flat sheet of 400x300 px, the first of which are `mismatches`."""
    print("seed", seed)
    rng = np.random.default_rng(seed)
    template_px = rng.uniform((0, 0), (400, 300), (count, 2))
    image_px = on_plane(template_px) + rng.normal(0.0, noise_px, (count, 2))
    image_px[:mismatches] = rng.uniform((0, 0), (640, 480), (mismatches, 2))
    return template_px, image_px


def judge(template_px, image_px, kept=None, seed=SEED, **values):
    matches = types.SimpleNamespace(template_px=template_px, image_px=image_px,
                                    kept=np.ones(len(template_px), np.uint8) if kept is None else kept)
    return Homography(**values).filter(types.SimpleNamespace(correspondences=matches, call=Call(seed)))


class HomographyTest(unittest.TestCase):
    def test_finds_a_plane_among_seventy_percent_of_mismatches(self):
        template_px, image_px = flat(300, 210)
        mask = judge(template_px, image_px)
        self.assertGreaterEqual(mask.kept[210:].sum(), 89)
        far = np.hypot(*(on_plane(template_px[:210]) - image_px[:210]).T) > 8.0
        self.assertEqual(mask.kept[:210][far].sum(), 0)

    def test_scores_fall_from_one_with_the_distance_and_are_a_half_at_the_tolerance(self):
        template_px, image_px = flat(200, 0, noise_px=0.0)
        image_px[0] += (0.0, 4.0)
        mask = judge(template_px, image_px, tolerance_px=4.0)
        self.assertAlmostEqual(mask.score[0], 0.5, delta=0.03)
        np.testing.assert_allclose(mask.score[1:], 1.0, atol=0.03)

    def test_leaves_what_was_rejected_before_out_of_everything(self):
        template_px, image_px = flat(60, 20)
        kept = np.ones(60, np.uint8)
        kept[:20] = 0
        mask = judge(template_px, image_px, kept)
        self.assertEqual(mask.kept[:20].sum() + mask.score[:20].sum(), 0)
        self.assertEqual(mask.kept[20:].sum(), 40)
        self.assertEqual(mask.diag["candidates"], 40)

    def test_draws_the_same_for_the_same_seed(self):
        matches = flat(100, 60)
        first, second = judge(*matches), judge(*matches)
        np.testing.assert_array_equal(first.kept, second.kept)
        np.testing.assert_array_equal(first.score, second.score)

    def test_says_why_there_is_no_plane(self):
        template_px, image_px = flat(40, 0)
        line = np.column_stack([template_px[:, 0], template_px[:, 0]])
        for matches, why in (((template_px[:3], image_px[:3]), "3 matches are left"),
                             ((np.ones((40, 2)), np.ones((40, 2))), "on a line, or in one place"),
                             ((line, on_plane(line)), "on a line, or in one place"),
                             (flat(40, 40), "low consensus")):
            with self.assertRaisesRegex(weft.NoResult, why):
                judge(*matches)


if __name__ == "__main__":
    unittest.main()
