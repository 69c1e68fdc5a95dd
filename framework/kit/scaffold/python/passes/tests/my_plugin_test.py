# SPDX-License-Identifier: Apache-2.0
import types
import unittest

import numpy as np
import weft
from my_plugin import MyPluginPass

CAMERA = weft.Record(fx=500.0, fy=500.0, cx=320.0, cy=240.0, width=640, height=480)
# Two faces; the second is the larger one.
TEMPLATE = weft.Record(vertices_m=np.array([[0.0, 0, 0], [1, 0, 0], [0, 0.5, 0], [2, 1, 0]]),
                       faces=np.array([[0, 2, 1], [1, 2, 3]], np.int32))


def given(face, image_px):
    """The inputs of the pass for one frame, with matches in the middle of these faces."""
    count = len(face)
    matches = weft.Record(image_px=np.array(image_px, float), face=np.array(face, np.int32),
                          barycentrics=np.full((count, 3), 1 / 3), kept=np.ones(count, np.uint8))
    return types.SimpleNamespace(correspondences=matches, template=TEMPLATE, camera=CAMERA)


class MyPluginTest(unittest.TestCase):
    def test_looks_along_the_ray_of_each_match_on_the_mesh(self):
        lines = MyPluginPass(fewest=3).run(given([0, -1, 0, 0], [[320, 240], [0, 0], [820, 240], [320, 740]]))
        lines = lines["sightlines"]
        half = np.sqrt(0.5)
        np.testing.assert_allclose(lines.ray, [[0, 0, 1], [half, 0, half], [0, half, half]], atol=1e-12)
        np.testing.assert_array_equal(lines.face, [0, 0, 0])

    def test_counts_the_area_of_the_faces_that_are_hit(self):
        corners = TEMPLATE.vertices_m[TEMPLATE.faces][:, :, :2]
        areas = [abs(np.linalg.det(corner[1:] - corner[0])) / 2 for corner in corners]
        lines = MyPluginPass(fewest=3).run(given([1, 1, 1], [[1, 1], [2, 2], [3, 3]]))["sightlines"]
        self.assertAlmostEqual(lines.coverage, areas[1] / sum(areas))

    def test_says_that_few_matches_tell_nothing(self):
        with self.assertRaisesRegex(weft.NoResult, "2 matches are kept on the mesh, of at least 8"):
            MyPluginPass().run(given([0, 0, -1], [[1, 1], [2, 2], [3, 3]]))


if __name__ == "__main__":
    unittest.main()
