#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Matches, known points and lenses from memory, with real plugins: python_inputs_test.py ROOT"""

import pathlib
import sys
import tempfile
import unittest

import numpy as np
import weft

ROOT = pathlib.Path(sys.argv[1])
CAMERA = weft.Camera(820.0, 830.0, 319.5, 239.5, 640, 480)
BROWN = (-0.21, 0.06, 1e-3, -7e-4, -0.004)
RADIUS_M, DEPTH_M = 0.25, 0.5

PIPELINE = f"""weft: 1
template:
  use: templates/rectangular
  params: {{texture: {ROOT}/pipelines/data/plain_sheet.png, width_m: 0.297, height_m: 0.178, columns: 10, rows: 6}}
stages:
  - {{use: warps/bbs}}
  - {{use: passes/salient_cells}}
  - {{use: solvers/gauss_newton}}
"""


def rolled(template):
    """The vertices [V,3] m of the sheet rolled about a vertical axis, before the camera."""
    x_m, y_m = (template.vertices_m - template.vertices_m.mean(axis=0))[:, :2].T
    return np.stack((RADIUS_M * np.sin(x_m / RADIUS_M), y_m, DEPTH_M + RADIUS_M * (1 - np.cos(x_m / RADIUS_M))), axis=-1)


def seen(ideal_px):
    """Where OpenCV's model with these coefficients shows pixels [N,2] of the pinhole."""
    k1, k2, p1, p2, k3 = BROWN
    x, y = ((ideal_px - (CAMERA.cx, CAMERA.cy)) / (CAMERA.fx, CAMERA.fy)).T
    r2 = x * x + y * y
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.stack((CAMERA.fx * u + CAMERA.cx, CAMERA.fy * v + CAMERA.cy), axis=-1)


class Inputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.file = pathlib.Path(holder.name) / "matches.yaml"
        cls.file.write_text(PIPELINE, encoding="utf-8")

    def pipeline(self, camera=CAMERA, inputs=("matches", "known_points"), **more):
        return weft.Pipeline(self.file, camera, inputs=inputs, **more)

    def solved(self, pipeline, scene):
        """The frame of exact matches at all vertices, as `scene` shows them."""
        true_m = rolled(pipeline.template)
        matches = weft.Matches(pipeline.template.flat_px, scene(CAMERA.project(true_m)))
        return pipeline.process(matches=matches), true_m

    def test_matches_without_an_image_give_the_surface_that_they_were_made_of(self):
        with self.pipeline() as pipeline:
            frame, true_m = self.solved(pipeline, lambda px: px)
        self.assertEqual(frame.state, "estimated", frame.stages)
        self.assertLess(np.linalg.norm(frame.vertices_m - true_m, axis=1).max(), 1e-3)

    def test_a_lens_gives_the_shape_of_the_ideal_camera(self):
        with self.pipeline() as pipeline:
            ideal, _ = self.solved(pipeline, lambda px: px)
        with self.pipeline(weft.Lens(CAMERA, BROWN)) as pipeline:
            through_lens, _ = self.solved(pipeline, seen)
        np.testing.assert_allclose(through_lens.vertices_m, ideal.vertices_m, atol=1e-7)

    def test_exact_known_points_are_where_they_were_given(self):
        with self.pipeline(set={"solvers.use": "solvers/particle_sft"}) as pipeline:
            true_m = rolled(pipeline.template)
            vertex = np.array([0, 9, 50, 59])
            matches = weft.Matches(pipeline.template.flat_px, CAMERA.project(true_m))
            moved_m = true_m[vertex] + (0, 0, 0.003)
            known = weft.KnownPoints(vertex, moved_m, 0.0)
            frame = pipeline.process(matches=matches, known_points=known)
        self.assertIsNotNone(frame.vertices_m, frame.stages)
        np.testing.assert_allclose(frame.vertices_m[vertex], moved_m, atol=1e-9)

    def test_covariances_weigh_matches(self):
        with self.pipeline() as pipeline:
            true_m = rolled(pipeline.template)
            image_px = CAMERA.project(true_m)
            image_px[7] += 6.0
            errors_m = []
            for variance_px2 in (1.0, 1e6):
                covariance_px2 = np.tile(np.eye(2), (60, 1, 1))
                covariance_px2[7] *= variance_px2
                matches = weft.Matches(pipeline.template.flat_px, image_px, covariance_px2)
                frame = pipeline.process(matches=matches)
                errors_m.append(np.linalg.norm(frame.vertices_m[7] - true_m[7]))
        self.assertLess(errors_m[1], 1e-3)

    def test_a_frame_without_the_inputs_of_a_stage_says_so(self):
        with self.pipeline() as pipeline:
            frame = pipeline.process(np.zeros((480, 640), np.uint8))
        self.assertEqual(frame.state, "none")
        self.assertEqual(frame.stages[0].status, "skipped")

    def refused(self, words, act, code="invalid_data"):
        with self.assertRaises(weft.Error) as raised:
            act()
        self.assertIn(words, str(raised.exception))
        self.assertEqual(raised.exception.code, code)

    def test_wrong_arrays_are_refused_with_place_and_fix(self):
        px = np.ones((3, 2))
        self.refused("matches.image_px: has 2 rows where there are 3", lambda: weft.Matches(px, px[:2]))
        self.refused("matches.template_px: must be [N,2], not [2, 3]", lambda: weft.Matches(px.T, px))
        self.refused("matches.image_px: has a value that is not finite, at [1, 0]",
                     lambda: weft.Matches(px, np.array([[1, 1], [np.nan, 1], [1, 1]])))
        self.refused("matches.image_px: must be numbers, not <U1", lambda: weft.Matches(px, [["a", "b"]] * 3))
        self.refused("must be symmetric and positive definite; row 0", lambda: weft.Matches(px, px, np.zeros((3, 2, 2))))
        self.refused("known_points.vertex: must be whole numbers, not float64",
                     lambda: weft.KnownPoints([0.5], [[0, 0, 1]]))
        self.refused("known_points.vertex: must be indices from 0, not -1", lambda: weft.KnownPoints([-1], [[0, 0, 1]]))
        self.refused("known_points.radius_m: has 2 rows where there are 1",
                     lambda: weft.KnownPoints([0], [[0, 0, 1]], [0.0, 0.0]))
        self.refused("lens: has 3 coefficients; give k1 k2 p1 p2", lambda: weft.Lens(CAMERA, (1, 2, 3)), "invalid_value")
        self.refused("lens: folds the image", lambda: weft.Lens(CAMERA, (-9, 0, 0, 0)), "invalid_value")
        self.refused("inputs: 'points' is no input", lambda: self.pipeline(inputs=["points"]), "invalid_value")

    def test_a_pipeline_refuses_what_does_not_fit_it_and_goes_on(self):
        with self.pipeline() as pipeline:
            template = pipeline.template
            known = weft.KnownPoints([60], [[0, 0, 0.5]])
            with self.assertRaises(weft.Error) as raised:
                pipeline.process(known_points=known)
            self.assertEqual(raised.exception.where, "known_points")
            with self.assertRaises(TypeError):
                pipeline.process(matches=template.flat_px)
            frame, _ = self.solved(pipeline, lambda px: px)
            self.assertEqual((frame.index, frame.state), (0, "estimated"))

    def test_inputs_that_were_not_named_are_refused(self):
        with self.pipeline(inputs="matches") as pipeline:
            self.refused('known_points: the pipeline was loaded without this input',
                         lambda: pipeline.process(known_points=weft.KnownPoints([0], [[0, 0, 0.5]])), "invalid_value")


class Lenses(unittest.TestCase):
    def test_pixels_come_back_to_those_of_the_pinhole(self):
        rng = np.random.default_rng(3)
        ideal_px = rng.uniform((0, 0), (639, 479), (200, 2))
        np.testing.assert_allclose(weft.Lens(CAMERA, BROWN).ideal_px(seen(ideal_px)), ideal_px, atol=1e-8)

    def test_a_fisheye_follows_its_angle(self):
        lens = weft.Lens(CAMERA, (0.02, -0.004, 0.0, 0.0), fisheye=True)
        theta = 0.3
        scale = theta * (1 + 0.02 * theta**2 - 0.004 * theta**4)
        seen_px = [[CAMERA.fx * scale + CAMERA.cx, CAMERA.cy]]
        np.testing.assert_allclose(lens.ideal_px(seen_px), [[CAMERA.fx * np.tan(theta) + CAMERA.cx, CAMERA.cy]],
                                   atol=1e-8)

    def test_an_image_becomes_that_of_the_pinhole(self):
        lens = weft.Lens(CAMERA, BROWN)
        v_px, u_px = np.mgrid[0:480, 0:640].astype(float)
        ideal_px = lens.ideal_px(np.stack((u_px.ravel(), v_px.ravel()), axis=-1))
        ramp = lambda px: 40 + 0.2 * px[:, 0] + 0.1 * px[:, 1]
        image = np.clip(np.rint(ramp(ideal_px)), 0, 255).astype(np.uint8).reshape(480, 640)
        undistorted = lens.undistorted(np.dstack([image] * 3)).astype(float)
        expected = ramp(np.stack((u_px.ravel(), v_px.ravel()), axis=-1)).reshape(480, 640)
        middle = (slice(60, 420), slice(80, 560))
        self.assertLess(np.abs(undistorted[..., 1] - expected)[middle].max(), 1.1)
        with self.assertRaises(weft.Error) as raised:
            lens.undistorted(image[:-1])
        self.assertIn("480 rows and 640 columns", str(raised.exception))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
