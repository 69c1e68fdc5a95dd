#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares rectangles of whole pixels with outlines of whole pixels, so that areas are counts."""

import contextlib
import io
import json
import math
import struct
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
import outline_overlap  # noqa: E402
from outline_overlap import Camera, OutlinePoint  # noqa: E402

CAMERA = Camera(100.0, 100.0, 0.0, 0.0, 100, 80)


def npy(numbers, shape, code="d", descr="<f8"):
    header = repr({"descr": descr, "fortran_order": False, "shape": shape}).encode()
    header += b" " * (-(10 + len(header) + 1) % 64) + b"\n"
    return (b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header)) + header +
            struct.pack(f"<{len(numbers)}{code}", *numbers))


def rectangle_mesh(left, top, right, bottom, depth_m=1.0):
    """2 x 2 cells, seen at the depth, that cover the pixels left..right and top..bottom."""
    left, top, right, bottom = left - 0.5, top - 0.5, right + 0.5, bottom + 0.5
    vertices = [(depth_m * u / 100.0, depth_m * v / 100.0, depth_m)
                for v in (top, 0.5 * (top + bottom), bottom) for u in (left, 0.5 * (left + right), right)]
    faces = []
    for row in (0, 1):
        for column in (0, 1):
            a = 3 * row + column
            faces += [(a, a + 3, a + 1), (a + 1, a + 3, a + 4)]
    return vertices, faces


def rectangle_outline(left, top, right, bottom, kinds=("visible",) * 4):
    """Around the pixels left..right and top..bottom."""
    left, top, right, bottom = left - 0.5, top - 0.5, right + 0.5, bottom + 0.5
    places = [(left, top), (right, top), (right, bottom), (left, bottom)]
    return [OutlinePoint(u, v, kind) for (u, v), kind in zip(places, kinds)]


class OutlineOverlap(unittest.TestCase):
    def test_a_mesh_on_its_outline_has_no_area_outside_and_no_distance(self):
        vertices, faces = rectangle_mesh(20, 10, 60, 50)
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, rectangle_outline(20, 10, 60, 50))
        self.assertEqual(found.mesh_px, 41 * 41)
        self.assertEqual(found.outside_px, 0)
        self.assertEqual(found.uncovered_px, 0)
        self.assertEqual(len(found.distances_px), 8)  # the middle vertex is not of the border
        self.assertLess(max(found.distances_px), 1e-9)

    def test_a_mesh_beside_its_outline_has_the_area_of_the_strip_outside(self):
        vertices, faces = rectangle_mesh(28, 10, 68, 50)
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, rectangle_outline(20, 10, 60, 50))
        self.assertEqual(found.outside_px, 8 * 41)
        self.assertEqual(found.uncovered_px, 8 * 41)
        self.assertAlmostEqual(max(found.distances_px), 8.0)

    def test_area_beyond_the_image_does_not_count(self):
        vertices, faces = rectangle_mesh(60, 10, 140, 50)
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, rectangle_outline(60, 10, 99, 50))
        self.assertEqual(found.mesh_px, 40 * 41)
        self.assertEqual(found.outside_px, 0)

    def test_vertices_near_a_hidden_stretch_or_beyond_the_image_have_no_distance(self):
        vertices, faces = rectangle_mesh(23, 10, 60, 50)
        outline = rectangle_outline(20, 10, 60, 50, ("visible", "visible", "visible", "hidden"))
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, outline)
        self.assertEqual(len(found.distances_px), 7)  # of the left side only the ends, which are on others
        self.assertLess(max(found.distances_px), 1e-9)
        vertices, faces = rectangle_mesh(60, 10, 140, 50)
        outline = rectangle_outline(60, 10, 99, 50, ("visible", "image", "visible", "visible"))
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, outline)
        self.assertEqual(len(found.distances_px), 3)

    def test_a_face_behind_the_camera_covers_nothing(self):
        vertices, faces = rectangle_mesh(20, 10, 60, 50, depth_m=-1.0)
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, rectangle_outline(20, 10, 60, 50))
        self.assertEqual((found.mesh_px, found.distances_px), (0, []))
        self.assertEqual(found.uncovered_px, 41 * 41)

    def test_a_concave_outline_leaves_its_notch_out(self):
        outline = [OutlinePoint(u, v, "visible") for u, v in
                   [(19.5, 9.5), (60.5, 9.5), (60.5, 50.5), (49.5, 50.5), (49.5, 30.5), (40.5, 30.5),
                    (40.5, 50.5), (19.5, 50.5)]]
        vertices, faces = rectangle_mesh(20, 10, 60, 50)
        found = outline_overlap.overlap_of(vertices, faces, CAMERA, outline)
        self.assertEqual(found.outside_px, 9 * 20)

    def test_reads_a_run_and_sums_up_what_is_estimated(self):
        with tempfile.TemporaryDirectory() as folder:
            run = Path(folder)
            (run / "frames").mkdir()
            _, faces = rectangle_mesh(20, 10, 60, 50)
            with zipfile.ZipFile(run / "template.npz", "w") as file:
                file.writestr("template/faces.npy", npy([v for f in faces for v in f], (8, 3), "i", "<i4"))
                for name in ("fx", "fy", "cx", "cy"):
                    file.writestr(f"camera/{name}.npy", npy([getattr(CAMERA, name)], ()))
                for name in ("width", "height"):
                    file.writestr(f"camera/{name}.npy", npy([getattr(CAMERA, name)], (), "q", "<i8"))
            lines = []
            for frame, (shift, state) in enumerate([(0, "estimated"), (8, "estimated"), (20, "weak")]):
                vertices, _ = rectangle_mesh(20 + shift, 10, 60 + shift, 50)
                with zipfile.ZipFile(run / "frames" / f"{frame:06}.npz", "w") as file:
                    file.writestr("shape/vertices_m.npy", npy([x for v in vertices for x in v], (9, 3)))
                lines.append(json.dumps({"frame": frame, "state": state, "confidence": 0.9}))
            lines.append(json.dumps({"frame": 3, "state": "none"}))
            (run / "frames.jsonl").write_text("\n".join(lines) + "\n")
            rows = ["frame,point,u_px,v_px,next"]
            for frame in range(4):
                rows += [f"{frame},{k},{p.u_px},{p.v_px},{p.next}"
                         for k, p in enumerate(rectangle_outline(20, 10, 60, 50))]
            (run / "outlines.csv").write_text("\n".join(rows) + "\n")
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                self.assertEqual(outline_overlap.main([str(run), str(run / "outlines.csv")]), 0)
        table = [line.split() for line in out.getvalue().splitlines()]
        share = 100.0 * 8 * 41 / (41 * 41)
        self.assertEqual(table[2][:4], ["1", "estimated", "0.90", f"{share:.1f}"])
        self.assertEqual(table[4][:5], ["estimated", "2", "of", "4", f"{0.5 * share:.1f}"])
        self.assertEqual(table[5][:4], ["all", "3", "of", "4"])
        self.assertIn("without a shape: 3", out.getvalue())

    def test_names_the_line_of_a_faulty_outline(self):
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "outlines.csv"
            for row, message in [("0,0,1,2,seen", "next is 'seen'"), ("0,1,1,2,visible", "point 1 follows"),
                                 ("0,0,nan,2,visible", "finite"), ("0,0,one,2,visible", "numbers")]:
                path.write_text(f"frame,point,u_px,v_px,next\n{row}\n")
                with self.assertRaisesRegex(ValueError, f"csv:2: .*{message}"):
                    outline_overlap.read_outlines(path)
            path.write_text("frame,u_px\n0,1\n")
            with self.assertRaisesRegex(ValueError, "the columns must be"):
                outline_overlap.read_outlines(path)

    def test_the_outlines_of_the_bag_are_those_of_every_tenth_frame_and_convex_enough(self):
        outlines = outline_overlap.read_outlines(ROOT / "tests" / "data" / "bag_outlines.csv")
        self.assertEqual(sorted(outlines), list(range(0, 280, 10)))
        for frame, outline in outlines.items():
            for point in outline:
                self.assertTrue(-0.5 <= point.u_px <= 639.5 and -0.5 <= point.v_px <= 359.5, f"frame {frame}")
            area = 0.5 * sum(a.u_px * b.v_px - b.u_px * a.v_px
                             for a, b in zip(outline, outline[1:] + outline[:1]))
            self.assertTrue(0.35 < area / (640 * 360) < 0.75, f"frame {frame}: {area} px^2, clockwise")
            for a, b in zip(outline, outline[1:] + outline[:1]):
                if a.next == "image":
                    on_one = (a.u_px == b.u_px and abs(a.u_px - 319.5) == 320.0) or \
                             (a.v_px == b.v_px and abs(a.v_px - 179.5) == 180.0)
                    self.assertTrue(on_one, f"frame {frame}: an image stretch lies on the image's border")

    def test_quantiles_are_linear_between_the_values(self):
        self.assertAlmostEqual(outline_overlap.quantile([3.0, 1.0, 2.0], 0.25), 1.5)
        self.assertTrue(math.isnan(outline_overlap.quantile([], 0.5)))


if __name__ == "__main__":
    unittest.main()
