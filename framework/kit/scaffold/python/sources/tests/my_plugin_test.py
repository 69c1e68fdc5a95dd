# SPDX-License-Identifier: Apache-2.0
import types
import unittest

import numpy as np
import weft
from my_plugin import COLUMNS, ROWS, WIDTH_M, MyPluginSource


def given(frame):
    call = types.SimpleNamespace(frame=frame, rng=lambda: np.random.default_rng(frame))
    return types.SimpleNamespace(call=call)


class MyPluginTest(unittest.TestCase):
    def test_rolls_the_sheet_without_stretching_it(self):
        for frame in range(5):
            truth = MyPluginSource(bend_per_m=8.0).read(given(frame))["ground_truth"]
            rows_m = truth.points_m.reshape(ROWS, COLUMNS, 3)
            step_m = np.linalg.norm(np.diff(rows_m, axis=1), axis=2)
            np.testing.assert_allclose(step_m, WIDTH_M / COLUMNS, rtol=1e-3)  # chords of an arc
        self.assertLess(np.ptp(rows_m[:, :, 0]), 0.9 * WIDTH_M)

    def test_shows_each_point_where_it_is_but_for_noise(self):
        source = MyPluginSource(noise_px=0.0, bend_per_m=0.0)
        frame = source.read(given(2))
        camera = source.open(given(0))
        place_m = frame["ground_truth"].points_m
        seen_px = place_m[:, :2] / place_m[:, 2:] * camera.fx + [camera.cx, camera.cy]
        np.testing.assert_allclose(frame["correspondences"].image_px, seen_px)
        np.testing.assert_allclose(place_m[:, 2], source.distance_m)

    def test_has_as_many_frames_as_it_says(self):
        source = MyPluginSource(frames=3)
        self.assertEqual(source.count(given(0)), 3)
        with self.assertRaisesRegex(weft.Failure, "there is no frame 3"):
            source.read(given(3))


if __name__ == "__main__":
    unittest.main()
