# SPDX-License-Identifier: Apache-2.0
import types
import unittest

import numpy as np
import weft
from my_plugin import MyPluginFilter

TOLERANCE_PX = 5.0


def given(template_px, image_px):
    """The inputs of the filter for one frame."""
    kept = np.ones(len(template_px), np.uint8)
    matches = weft.Record(template_px=template_px, image_px=image_px, kept=kept)
    return types.SimpleNamespace(correspondences=matches, call=types.SimpleNamespace(go_on=lambda: None))


def matches_of_a_flat_sheet(count):
    """Matches of a flat surface that faces the camera, whose image is an affine map of its texture; every
    fifth is moved by more than the tolerance."""
    print("seed 7")
    rng = np.random.default_rng(7)
    template_px = rng.uniform(0, 500, (count, 2))
    image_px = template_px @ [[0.9, 0.1], [-0.1, 0.9]] + [40, 20] + rng.normal(0, 0.3, (count, 2))
    wrong = np.arange(count) % 5 == 0
    image_px[wrong] += rng.choice([-1, 1], (wrong.sum(), 1)) * rng.uniform(30, 90, (wrong.sum(), 2))
    return template_px, image_px, wrong


class MyPluginTest(unittest.TestCase):
    def test_keeps_what_a_flat_sheet_shows_and_rejects_jumps(self):
        template_px, image_px, wrong = matches_of_a_flat_sheet(200)
        mask = MyPluginFilter(tolerance_px=TOLERANCE_PX).filter(given(template_px, image_px))
        np.testing.assert_array_equal(mask.kept, ~wrong)

    def test_says_that_three_matches_tell_nothing(self):
        template_px, image_px, _ = matches_of_a_flat_sheet(3)
        with self.assertRaisesRegex(weft.NoResult, "3 matches are left; at least 4 are needed"):
            MyPluginFilter().filter(given(template_px, image_px))


if __name__ == "__main__":
    unittest.main()
