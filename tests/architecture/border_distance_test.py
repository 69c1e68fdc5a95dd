#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures runs whose mesh and annotation are constructed, so that their distance is known."""

import contextlib
import csv
import io
import json
import math
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import numpy as np
except ModuleNotFoundError:
    print("skipped: NumPy is missing (Debian: python3-numpy)")
    sys.exit(0)

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import border_distance  # noqa: E402

FOCAL_PX, CENTRE_PX, SIZE_PX, DEPTH_M = 1000.0, (399.5, 299.5), (800, 600), 0.5
MM_BY_PX = 1000 * DEPTH_M / FOCAL_PX
SIDE_M, CELLS = 0.2, 8
SIDE_PX = SIDE_M * FOCAL_PX / DEPTH_M  # 400
LEFT_PX, TOP_PX = CENTRE_PX[0] - SIDE_PX / 2, CENTRE_PX[1] - SIDE_PX / 2
RIGHT_PX, BOTTOM_PX = LEFT_PX + SIDE_PX, TOP_PX + SIDE_PX


def grid():
    """A flat square around the axis of the camera: [V,3] m and [F,3]."""
    at = np.linspace(-SIDE_M / 2, SIDE_M / 2, CELLS + 1)
    vertices = np.array([(x, y, DEPTH_M) for y in at for x in at])
    width = CELLS + 1
    faces = []
    for row in range(CELLS):
        for column in range(CELLS):
            first = row * width + column
            faces += [(first, first + width, first + 1), (first + 1, first + width, first + width + 1)]
    return vertices, np.array(faces, np.int32)


def rectangle(left, top, right, bottom):
    return [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)]


class BorderDistance(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.root = Path(self.folder.name)
        self.vertices, self.faces = grid()
        self.more = {}
        self.camera = {"fx": FOCAL_PX, "fy": FOCAL_PX, "cx": CENTRE_PX[0], "cy": CENTRE_PX[1],
                       "width": SIZE_PX[0], "height": SIZE_PX[1]}
        self.state, self.stem, self.size_px = "estimated", "warped_document_curled_bright", SIZE_PX
        self.annotate(rectangle(LEFT_PX, TOP_PX, RIGHT_PX, BOTTOM_PX))

    def tearDown(self):
        self.folder.cleanup()

    def annotate(self, *polylines):
        lines = [f"7,curled_bright,{index},{x!r},{y!r}" for index, each in enumerate(polylines)
                 for x, y in each]
        self.put("borders.csv", "document,photograph,polyline,x_px,y_px", *lines)

    def put(self, name, *lines):
        (self.root / name).write_text("".join(line + "\n" for line in lines))

    def run_of(self, name="run"):
        run = self.root / name
        (run / "frames").mkdir(parents=True, exist_ok=True)
        self.put("photographs.csv", "document,photograph,kind,width_px,height_px",
                 f"7,curled_bright,curled,{self.size_px[0]},{self.size_px[1]}")
        (run / "pipeline.yaml").write_text(
            f"source:\n  params: {{path: /data/7/{self.stem}.jpg}}\n"
            "template:\n  params: {texture: 8/t.png}\n")
        (run / "frames.jsonl").write_text(
            json.dumps({"frame": 0, "stem": self.stem, "state": self.state}) + "\n")
        np.savez(run / "template.npz", **{"template/faces": self.faces, "template/vertices_m": grid()[0]},
                 **self.more, **{f"camera/{name}": value for name, value in self.camera.items()})
        np.savez(run / "frames/000000.npz", **{"shape/vertices_m": self.vertices})
        return run

    def called(self, *arguments):
        output, errors = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
            code = border_distance.main([*map(str, arguments), "--borders", str(self.root)])
        return code, output.getvalue(), errors.getvalue()

    def measured(self):
        code, _, errors = self.called(self.run_of(), "--csv", self.root / "out.csv")
        self.assertEqual(code, 0, errors)
        row, = csv.DictReader((self.root / "out.csv").read_text().splitlines())
        return row

    def compared(self):
        run = self.run_of()
        row, = border_distance.measure(run, border_distance.photographs_of(self.root), None)
        return row

    def refused(self, *parts):
        code, _, errors = self.called(self.run_of())
        self.assertEqual(code, 2)
        for part in parts:
            self.assertIn(part, errors)

    def test_a_border_on_its_annotation_has_no_distance(self):
        row = self.compared()
        self.assertLess(row["worst_mm"], 1e-9)

    def test_a_larger_outline_has_the_distance_that_integration_gives(self):
        wider = 6.0
        self.annotate(rectangle(LEFT_PX - wider, TOP_PX - wider, RIGHT_PX + wider, BOTTOM_PX + wider))
        row = self.compared()
        # Beside a corner the mean of sqrt(wider^2 + t^2) over t from 0 to `wider`, elsewhere `wider`.
        beside = wider * (math.sqrt(2) + math.asinh(1)) / 2
        there = (4 * SIDE_PX * wider + 8 * wider * beside) / (4 * SIDE_PX + 8 * wider)
        self.assertAlmostEqual(row["mean_px"], (there + wider) / 2, delta=1e-3)
        self.assertAlmostEqual(row["mean_mm"], (there + wider) / 2 * MM_BY_PX, delta=1e-3)
        self.assertAlmostEqual(row["worst_mm"], wider * math.sqrt(2) * MM_BY_PX, delta=0.4 * MM_BY_PX)

    def test_parts_without_annotation_do_not_count(self):
        self.annotate([(LEFT_PX + 50, TOP_PX - 3), (RIGHT_PX - 50, TOP_PX - 3)],
                      [(RIGHT_PX + 5, TOP_PX + 100), (RIGHT_PX + 5, BOTTOM_PX - 200)])
        row = self.compared()
        expected = (3 * 300 + 5 * 100) / 400
        self.assertAlmostEqual(row["mean_px"], expected, delta=0.02)
        self.assertAlmostEqual(row["worst_mm"], 5 * MM_BY_PX, delta=1e-6)

    def test_the_border_of_a_bad_shape_beyond_a_closed_outline_counts(self):
        self.vertices[:, 0] *= 1.5
        row = self.compared()
        # The left and right annotated sides are min(100, distance to the nearer corner) px inside of the mesh
        # border: 75 px in the mean. The mesh border is 100 px outside there, and 0 to 100 px beside the corners.
        there = 2 * SIDE_PX * 75 / (4 * SIDE_PX)
        back = (2 * SIDE_PX * 100 + 4 * 100 * 50) / (4 * SIDE_PX + 4 * 100)
        self.assertAlmostEqual(row["mean_px"], (there + back) / 2, delta=0.05)
        self.assertAlmostEqual(row["worst_mm"], 100 * MM_BY_PX, delta=1e-6)

    def test_millimetres_are_at_the_depth_of_the_mesh_border(self):
        # x and Z double from the left side to the right, so that the image stays where it is.
        shares = (self.vertices[:, 0] / SIDE_M + 0.5)[:, None]
        self.vertices = self.vertices * (1 + shares)
        for x, depth_m in ((LEFT_PX - 4, DEPTH_M), (RIGHT_PX + 4, 2 * DEPTH_M)):
            self.annotate([(x, CENTRE_PX[1] - 50), (x, CENTRE_PX[1] + 50)])
            row = self.compared()
            self.assertAlmostEqual(row["mean_px"], 4, delta=1e-6)
            self.assertAlmostEqual(row["mean_mm"], 1000 * 4 * depth_m / FOCAL_PX, delta=1e-6)

    def test_inverse_depth_is_linear_between_two_vertices(self):
        border = border_distance.Border(np.array([(0.0, 0.0), (10.0, 0.0)]), np.array([1.0, 3.0]))
        # From (0, 0, 1) to (30, 0, 3): the middle (15, 0, 2) is seen at 15 / 2 = 7.5 of 10 px.
        depth, = border_distance.depth_at(border, np.array([0]), np.array([0.75]))
        self.assertAlmostEqual(depth, 2)

    def test_a_reduced_frame_is_measured_in_pixels_of_the_photograph(self):
        self.size_px = (1600, 1200)
        self.annotate([(2 * x + 0.5, 2 * y + 0.5) for x, y in
                       [(LEFT_PX + 50, TOP_PX - 3), (RIGHT_PX - 50, TOP_PX - 3)]])
        row = self.compared()
        self.assertAlmostEqual(row["mean_px"], 6, delta=1e-6)
        self.assertAlmostEqual(row["mean_mm"], 3 * MM_BY_PX, delta=1e-6)

    def test_the_axes_have_their_focal_lengths(self):
        self.camera.update(fy=2 * FOCAL_PX, cy=CENTRE_PX[1])
        self.vertices[:, 1] /= 2
        self.annotate([(LEFT_PX + 50, TOP_PX - 3), (RIGHT_PX - 50, TOP_PX - 3)])
        self.assertAlmostEqual(self.compared()["mean_mm"], 3 * MM_BY_PX / 2, delta=1e-6)

    def test_a_seam_is_no_border(self):
        width = CELLS + 1
        middle = np.arange(width) * width + CELLS // 2
        twin = np.arange(len(self.vertices), len(self.vertices) + width)
        right = np.array([face.max() % width > CELLS // 2 or face.min() % width > CELLS // 2 - 1
                          and (face % width).max() > CELLS // 2 for face in self.faces])
        faces = self.faces.copy()
        for old, new in zip(middle, twin):
            faces[right] = np.where(faces[right] == old, new, faces[right])
        welded = np.concatenate([np.arange(len(self.vertices)), middle]).astype(np.int32)
        with_seam = border_distance.edges_of_border(faces, None)
        self.assertEqual(len(with_seam), 6 * CELLS)
        self.assertEqual(len(border_distance.edges_of_border(faces, welded)), 4 * CELLS)
        self.more, self.faces = {"template/welded_vertex": welded}, faces
        self.vertices = np.concatenate([self.vertices, self.vertices[middle]])
        self.assertLess(self.compared()["worst_mm"], 1e-9)

    def test_a_hole_is_no_border(self):
        inside = CELLS * (CELLS // 2) + CELLS // 2
        self.faces = np.delete(self.faces, [2 * inside, 2 * inside + 1], axis=0)
        self.assertLess(self.compared()["worst_mm"], 1e-9)

    def test_a_frame_without_a_solved_shape_is_counted_as_failed(self):
        self.state = "lost"
        self.assertEqual(self.measured()["mean_mm"], "-")
        self.assertIn("curled: 1 photographs, 1 failed\n", self.called(self.run_of())[1])

    def test_a_border_behind_the_camera_is_counted_as_failed(self):
        self.vertices[0, 2] = -1
        code, output, errors = self.called(self.run_of())
        self.assertEqual(code, 0)
        self.assertIn("1 failed", output)
        self.assertIn("not in front of the camera", errors)

    def test_means_of_a_kind_are_over_its_solved_photographs(self):
        outline = [(LEFT_PX + 50, TOP_PX - 3), (RIGHT_PX - 50, TOP_PX - 3)]
        self.annotate(outline)
        first = self.run_of("first")
        self.vertices[:, 1] += 0.001  # 2 px down, 1 mm
        code, output, _ = self.called(first, self.run_of("second"))
        self.assertEqual(code, 0)
        self.assertIn("curled: 2 photographs, 0 failed, mean 2.00 mm, 4.0 px\n", output)

    def test_names_what_is_wrong_and_what_to_do(self):
        self.annotate([(1, 1), (float("nan"), 2)])
        self.refused("borders.csv:3", "no finite number")
        self.annotate([(1, 1)])
        self.refused("has one point", "needs two")
        self.put("borders.csv", "document,x_px")
        self.refused("borders.csv:1", "write document,photograph,polyline,x_px,y_px")
        self.put("borders.csv", "document,photograph,polyline,x_px,y_px", "7,flat,0,1,1", "7,flat,0,2,2")
        self.refused("photographs.csv has no 7, flat", "add its line")

    def test_refuses_runs_that_it_cannot_compare(self):
        self.size_px = (800, 650)
        self.refused("run photographs of different sizes one by one")
        self.size_px, self.stem = SIZE_PX, "warped_document_flat"
        self.refused("no frame is an annotated photograph of 7", "curled_bright")
        code, _, errors = self.called(self.root / "absent")
        self.assertEqual(code, 2)
        self.assertIn("name the folder of a run", errors)
        self.stem = "warped_document_curled_bright"
        run = self.run_of()
        (run / "pipeline.yaml").write_text("source:\n  params: {path: /data/9/a.jpg}\n")
        self.assertIn("use --document with one of 7", self.called(run)[2])
        self.assertEqual(self.called(run, "--document", "7")[0], 0)

    def test_the_annotation_of_the_repository_is_complete(self):
        photographs = border_distance.photographs_of(border_distance.BORDERS)
        self.assertEqual(len(photographs), 24)
        kinds = [each.kind for each in photographs.values()]
        self.assertEqual({kind: kinds.count(kind) for kind in kinds},
                         {"perspective": 8, "curled": 8, "folded": 8})
        for name, each in photographs.items():
            points = np.concatenate(each.polylines)
            self.assertTrue((points >= 0).all() and (points <= np.array(each.size_px) - 1).all(), name)
            self.assertGreaterEqual(len(points), 48, name)


if __name__ == "__main__":
    unittest.main()
