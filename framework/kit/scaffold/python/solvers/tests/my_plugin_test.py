# SPDX-License-Identifier: Apache-2.0
import types
import unittest

import numpy as np
import weft
from my_plugin import MyPluginSolver

CAMERA = weft.Record(fx=500.0, fy=500.0, cx=320.0, cy=240.0, width=640, height=480)


def sheet():
    """A flat surface of 5 x 4 vertices and its faces."""
    x, y = np.meshgrid(np.linspace(0, 0.2, 5), np.linspace(0, 0.15, 4))
    corner = (np.arange(3)[:, None] * 5 + np.arange(4)).ravel()
    faces = np.concatenate([np.stack([corner, corner + 5, corner + 6], axis=1),
                            np.stack([corner, corner + 6, corner + 1], axis=1)])
    vertices_m = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    return weft.Record(vertices_m=vertices_m, faces=faces.astype(np.int32))


def placed(template):
    """The surface, turned about two axes and in front of the camera."""
    a, b = 0.4, 0.3
    about_y = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    about_z = np.array([[np.cos(b), -np.sin(b), 0], [np.sin(b), np.cos(b), 0], [0, 0, 1]])
    return template.vertices_m @ (about_y @ about_z).T + [-0.08, -0.06, 0.6]


def given(template, vertices_m, used):
    """The inputs of the solver for a frame with these vertices visible."""
    count = len(used)
    ray = vertices_m[used] / np.linalg.norm(vertices_m[used], axis=1, keepdims=True)
    pixel_px = vertices_m[used, :2] / vertices_m[used, 2:] * 500.0 + [320.0, 240.0]
    lines = weft.Record(vertex=np.array(used, np.int32), face=np.full(count, -1, np.int32),
                        barycentrics=np.zeros((count, 3)), pixel_px=pixel_px, ray=ray, weight=np.ones(count))
    return types.SimpleNamespace(template=template, camera=CAMERA, sightlines=lines,
                                 call=types.SimpleNamespace(go_on=lambda: None))


class MyPluginTest(unittest.TestCase):
    def test_finds_the_pose_of_a_rigid_sheet(self):
        template = sheet()
        truth_m = placed(template)
        shape = MyPluginSolver(rounds=5000).solve(given(template, truth_m, list(range(20))))
        np.testing.assert_allclose(shape.vertices_m, truth_m, atol=1e-5)
        self.assertEqual(shape.confidence, 1.0)

    def test_says_which_vertices_were_seen(self):
        template = sheet()
        shape = MyPluginSolver().solve(given(template, placed(template), [0, 4, 7, 12, 19]))
        self.assertEqual(np.flatnonzero(shape.source).tolist(), [0, 4, 7, 12, 19])

    def test_says_that_three_sightlines_and_points_on_a_line_tell_nothing(self):
        template = sheet()
        for used, said in (([0, 4, 19], "3 sightlines count; at least 4"), ([0, 1, 2, 3], "on a line")):
            with self.assertRaisesRegex(weft.NoResult, said):
                MyPluginSolver().solve(given(template, placed(template), used))

    def test_names_a_sightline_of_no_vertex(self):
        template = sheet()
        wrong = given(template, placed(template), [0, 4, 7, 12])
        wrong.sightlines.vertex = np.array([0, 4, 99, 12], np.int32)
        with self.assertRaisesRegex(weft.Failure, "sightline 2 names no vertex"):
            MyPluginSolver().solve(wrong)


if __name__ == "__main__":
    unittest.main()
