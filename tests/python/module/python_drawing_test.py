#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What weft.draw draws: places, colours and mistakes."""

import io
import sys
import unittest

import numpy as np
import weft
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure

CAMERA = weft.Camera(100.0, 200.0, 50.0, 40.0, 120, 90)
# A square of two faces, the second one further away.
VERTICES_M = np.array([[0, 0, 1], [0.1, 0, 1], [0, 0.1, 1], [0.1, 0.1, 2]], np.float64)
TEMPLATE = weft.Template(VERTICES_M, np.array([[0, 1, 2], [1, 3, 2]], np.int32), np.zeros((4, 2)),
                         np.zeros((4, 5), np.uint8), np.ones((4, 5), np.uint8))


def faces_of(ax):
    """Corners of the drawn faces [F,3,2] px."""
    return np.array([path.vertices[:3] for path in ax.collections[0].get_paths()])


class Drawing(unittest.TestCase):
    def test_puts_vertices_where_the_camera_sees_them_far_faces_first(self):
        ax = weft.draw(TEMPLATE, VERTICES_M, camera=CAMERA)
        px = np.array([[50, 40], [60, 40], [50, 60], [55, 50]], np.float64)
        np.testing.assert_allclose(faces_of(ax), px[[[1, 3, 2], [0, 1, 2]]])
        self.assertEqual((ax.get_xlim(), ax.get_ylim()), ((-0.5, 119.5), (89.5, -0.5)))

    def test_leaves_out_faces_that_are_not_before_the_camera(self):
        behind = VERTICES_M.copy()
        behind[3, 2] = -1
        np.testing.assert_allclose(faces_of(weft.draw(TEMPLATE, behind, camera=CAMERA)),
                                   [[[50, 40], [60, 40], [50, 60]]])
        self.assertTrue(np.isnan(CAMERA.project(behind)[3]).all())

    def test_shows_images_of_bgr_in_their_colours(self):
        image = np.zeros((90, 120, 3), np.uint8)
        image[..., 0] = 200
        shown = weft.draw(TEMPLATE, VERTICES_M, camera=CAMERA, image=image).images[0].get_array()
        self.assertEqual(shown[0, 0].tolist(), [0, 0, 200])

    def test_tells_faces_that_were_measured_from_others(self):
        ax = weft.draw(TEMPLATE, VERTICES_M, camera=CAMERA, source=np.array([1, 1, 1, 0], np.uint8))
        colours = ax.collections[0].get_facecolor()[:, :3]
        np.testing.assert_allclose(colours, [to_rgb("#d9731a"), to_rgb("#1f5fbf")])

    def test_colours_faces_by_the_mean_of_their_values_and_hides_unknown_ones(self):
        for options in ({}, {"camera": CAMERA}):
            ax = weft.draw(TEMPLATE, VERTICES_M, values=[1, 2, 3, np.nan], **options)
            ax.figure.savefig(io.BytesIO(), format="png")
            array = ax.collections[0].get_array()
            order = [0, 1] if not options else [1, 0]
            self.assertEqual(np.ma.getmaskarray(array)[order].tolist(), [False, True])
            self.assertEqual(array[order[0]], 2.0)
            self.assertEqual(len(ax.figure.axes), 2, "there is no scale")

    def test_shows_meshes_in_space_in_millimetres_and_y_down(self):
        ax = weft.draw(TEMPLATE, VERTICES_M)
        self.assertGreaterEqual(ax.get_xlim()[1], 100)
        self.assertGreater(*ax.get_zlim())
        self.assertLessEqual(ax.get_ylim()[0], 1000)
        self.assertGreaterEqual(ax.get_ylim()[1], 2000)
        self.assertEqual(weft.draw(TEMPLATE).get_xlim(), ax.get_xlim())

    def test_draws_into_given_axes(self):
        ax = Figure().add_subplot()
        self.assertIs(weft.draw(TEMPLATE, VERTICES_M, camera=CAMERA, ax=ax), ax)
        with self.assertRaisesRegex(ValueError, 'projection="3d"'):
            weft.draw(TEMPLATE, VERTICES_M, ax=ax)

    def test_opens_no_window(self):
        weft.draw(TEMPLATE, VERTICES_M).figure.savefig(io.BytesIO(), format="png")
        self.assertNotIn("matplotlib.pyplot", sys.modules)

    def test_refuses_what_cannot_be_drawn(self):
        broken = VERTICES_M.copy()
        broken[1, 1] = np.nan
        image = np.zeros((90, 120), np.uint8)
        for sentence, arguments in (
                (r"4 vertices, \[4,3\], these are \[3, 3\]", {"vertices_m": VERTICES_M[:3]}),
                ("NaN", {"vertices_m": broken}),
                ("camera=", {"image": image}),
                (r"values has one entry a vertex, \[4\], not \[2\]", {"values": [1, 2]}),
                (r"source has one entry", {"source": [1]}),
                ("120x89 px, the camera 120x90", {"image": image[:-1], "camera": CAMERA}),
                ("float64", {"image": image / 255, "camera": CAMERA})):
            with self.subTest(sentence=sentence), self.assertRaisesRegex(ValueError, sentence):
                weft.draw(TEMPLATE, **{"vertices_m": VERTICES_M, **arguments})

    def test_knows_camera_matrices(self):
        self.assertEqual(weft.Camera.of_matrix(CAMERA.matrix, 120, 90), CAMERA)
        with self.assertRaisesRegex(ValueError, r"\[\.\.\.,3\]"):
            CAMERA.project([[1, 2]])


if __name__ == "__main__":
    unittest.main()
