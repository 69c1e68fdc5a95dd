#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Folders of runs and of ablations, made here, as weft.open_run and weft.open_results read them."""

import json
import pathlib
import pickle
import sys
import tempfile
import unittest
from xml.etree import ElementTree

import numpy as np
import weft

try:
    import xxhash
except ImportError:
    xxhash = None

VERTICES_M = np.array([[0, 0, 1], [0.1, 0, 1], [0, 0.1, 1]], np.float64)


class Folder(unittest.TestCase):
    def setUp(self):
        holder = tempfile.TemporaryDirectory()
        self.addCleanup(holder.cleanup)
        self.folder = pathlib.Path(holder.name)

    def write(self, name, content):
        file = self.folder / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")


def shown(value):
    """What a notebook shows, as a tree: it must be well formed."""
    return ElementTree.fromstring(value._repr_html_())


def text_of(tree):
    return " ".join(" ".join(tree.itertext()).split())


def line_of(frame, state, confidence, **stage):
    return {"frame": frame, "stem": f"image{frame}", "state": state, "age": 0, "confidence": confidence,
            "failed": False, "stages": [{"stage": "filters", "status": "ok", "ms": 1.5, **stage}]}


class Runs(Folder):
    def setUp(self):
        super().setUp()
        self.write("manifest.json", {"weft": "0.1.0", "seed": 7})
        lines = [line_of(0, "none", None), line_of(2, "estimated", 0.9, kept=10), line_of(3, "predicted", 0, kept=0)]
        self.write("frames.jsonl", "".join(json.dumps(each) + "\n" for each in lines) + '{"frame": 4, "st')
        (self.folder / "frames").mkdir()
        np.savez(self.folder / "frames/000002.npz", **{
            "shape/vertices_m": VERTICES_M, "shape/source": np.ones(3, np.uint8),
            "ground_truth/points_m": VERTICES_M + 0.001, "matchers.correspondences/kept": np.ones(5, np.uint8)})
        arrays = {"vertices_m": VERTICES_M, "faces": np.array([[0, 1, 2]], np.int32),
                  "flat_px": np.zeros((3, 2)), "texture": np.zeros((4, 5), np.uint8), "mask": np.ones((4, 5), np.uint8)}
        camera = {"fx": 100.0, "fy": 101.0, "cx": 3.5, "cy": 2.5, "width": np.int64(8), "height": np.int64(6)}
        np.savez(self.folder / "template.npz", **{f"template/{name}": array for name, array in arrays.items()},
                 **{f"camera/{name}": number for name, number in camera.items()})

    def measured(self):
        self.write("metrics.json", {"frames": [
            {"frame": 0, "outcome": "missing"},
            {"frame": 2, "outcome": "solved", "reprojection_px": 0.5, "truth": {"mean_mm": 1.25}},
            {"frame": 3, "outcome": "carried_over", "reprojection_px": None, "truth": {"mean_mm": 9.0}}]})

    def test_have_frames_by_their_order_up_to_the_one_that_is_being_written(self):
        run = weft.open_run(self.folder)
        self.assertEqual([(each.index, each.state, each.stem) for each in run],
                         [(0, "none", "image0"), (2, "estimated", "image2"), (3, "predicted", "image3")])
        self.assertEqual((len(run), run[-1].index, [each.index for each in run[1:]]), (3, 3, [2, 3]))
        self.assertEqual(run.states.tolist(), ["none", "estimated", "predicted"])
        self.assertEqual(run.confidences.tolist(), [0.0, 0.9, 0.0])
        self.assertEqual((run.manifest["seed"], run.end), (7, None))
        with self.assertRaises(IndexError):
            run[3]

    def test_have_the_arrays_of_a_frame(self):
        run = weft.open_run(str(self.folder))
        np.testing.assert_array_equal(run[1].vertices_m, VERTICES_M)
        np.testing.assert_array_equal(run[1].true_points_m, VERTICES_M + 0.001)
        self.assertEqual(run[1]["matchers.correspondences/kept"].sum(), 5)
        self.assertIn("shape/source", run[1])
        self.assertIsNone(run[1].covariance_m2)
        self.assertIsNone(run[0].vertices_m)
        self.assertEqual(run[0].names, [])
        with self.assertRaisesRegex(KeyError, "frame 2 has no array 'shape/x'; it has: shape/vertices_m"):
            run[1]["shape/x"]

    def test_have_numbers_of_stages(self):
        run = weft.open_run(self.folder)
        np.testing.assert_array_equal(run.stage("filters", "kept"), [np.nan, 10, 0])
        np.testing.assert_array_equal(run.stage("filters"), [1.5, 1.5, 1.5])
        with self.assertRaisesRegex(weft.Error, "no stage 'filter'; it has: filters"):
            run.stage("filter")

    def test_have_errors_of_frames_with_a_shape_of_their_own_once_they_are_measured(self):
        with self.assertRaisesRegex(weft.Error, "run `weft eval"):
            weft.open_run(self.folder).errors_mm
        self.measured()
        run = weft.open_run(self.folder)
        np.testing.assert_array_equal(run.errors_mm, [np.nan, 1.25, np.nan])
        np.testing.assert_array_equal(run.metric("truth.mean_mm"), [np.nan, 1.25, 9.0])
        np.testing.assert_array_equal(run.metric("reprojection_px"), [np.nan, 0.5, np.nan])
        with self.assertRaisesRegex(weft.Error, "no frame has the number 'truth.mean'"):
            run.metric("truth.mean")

    def test_have_template_and_camera(self):
        run = weft.open_run(self.folder)
        self.assertEqual(run.camera, weft.Camera(100.0, 101.0, 3.5, 2.5, 8, 6))
        np.testing.assert_array_equal(run.template.faces, [[0, 1, 2]])
        self.assertIsNone(run.template.m_per_px)

    def test_show_states_times_and_errors_in_notebooks(self):
        self.assertNotIn("3D error", text_of(shown(weft.open_run(self.folder))))
        self.write("metrics.json", {"frames": [{"frame": 2, "outcome": "solved"}]})
        self.assertNotIn("3D error", text_of(shown(weft.open_run(self.folder))))
        self.measured()
        tree = shown(weft.open_run(self.folder))
        self.assertIn("3D error 1.25 mm in the mean, 1.25 mm at most", text_of(tree))
        self.assertIn("median times filters 1.5 ms", text_of(tree))
        self.assertEqual([(each.get("x"), each.get("width")) for each in tree.iter("rect")],
                         [("0", "1"), ("1", "1"), ("2", "1")])
        self.assertEqual([text_of(each) for each in tree.iter("title")],
                         ["frame 0: none", "frame 1: estimated", "frame 2: predicted"])

    def test_show_a_frame_with_its_mesh_and_stages_in_notebooks(self):
        run = weft.open_run(self.folder)
        tree = shown(run[1])
        self.assertIn("state ■ estimated confidence 0.90", text_of(tree))
        self.assertIn("filters ok 1.5 ms", text_of(tree))
        (path,) = tree.iter("path")
        self.assertEqual(path.get("d").count("M"), 3)  # the three edges of its face
        self.assertEqual(len(list(shown(run[0]).iter("path"))), 0)

    def test_show_texts_as_texts_in_notebooks(self):
        line = line_of(0, "none", None, reason="<script>alert(1)</script>")
        self.write("frames.jsonl", json.dumps({**line, "stem": "<b>"}) + "\n")
        page = weft.open_run(self.folder)[0]._repr_html_()
        self.assertNotIn("<script>", page)
        self.assertIn("&lt;script&gt;", page)
        self.assertIn("Frame 0 &lt;b&gt;", page)

    def test_show_an_empty_run_and_a_template_in_notebooks(self):
        self.assertIn("3 vertices, 1 faces", text_of(shown(weft.open_run(self.folder).template)))
        self.write("frames.jsonl", "")
        self.assertIn("frames 0", text_of(shown(weft.open_run(self.folder))))

    def test_that_are_none_or_damaged_are_named(self):
        with self.assertRaisesRegex(weft.Error, "no folder of a run") as caught:
            weft.open_run(self.folder / "frames")
        self.assertEqual((caught.exception.where, caught.exception.code), (str(self.folder / "frames"), "not_found"))
        (self.folder / "frames/000002.npz").write_bytes(b"PK\3\4 and no more")
        with self.assertRaisesRegex(weft.Error, "000002.npz: cannot be read"):
            weft.open_run(self.folder)[1].vertices_m
        self.write("frames.jsonl", '{"frame": 0\n')
        with self.assertRaisesRegex(weft.Error, r"frames.jsonl:1: is no JSON") as caught:
            weft.open_run(self.folder)
        again = pickle.loads(pickle.dumps(caught.exception))
        self.assertEqual((str(again), again.code), (str(caught.exception), "syntax"))


def key_of(number):
    return f"{number:032x}"


def cell_line(key, outcome="done", mean_mm=None, schema="weft.cell/2", failed=0):
    metrics = {"counts": {"failed": failed}, "all": {"error_solved": {"mean_mm": mean_mm}},
               "filters": [{"stage": "filters", "tpr_percent": 80.0}]}
    line = {"schema": schema, "key": key, "outcome": outcome, "reason": "it fell" if outcome == "failed" else "",
            "metrics": metrics}
    text = json.dumps(line, separators=(",", ":"))
    if schema == "weft.cell/1":
        return text + "\n"
    return checked(text)


def checked(text):
    digits = xxhash.xxh3_128_hexdigest(text.encode()) if xxhash else "0" * 32
    return f'{text[:-1]},"check":"{digits}"}}\n'


class Results(Folder):
    def setUp(self):
        super().setUp()
        self.write("manifest.json", {"schema": "weft.results/1", "plan": "tiny"})
        cells = [{"cell": i, "axes": {"filter": name}, "sequence": sequence, "seed": 1, "key": key_of(i)}
                 for i, (name, sequence) in enumerate([("aem", "a"), ("aem", "b"), ("lpm", "a"), ("lpm", "b")])]
        self.write("plan.json", {"axes": [{"name": "filter", "values": ["aem", "lpm"]}], "cells": cells,
                                 "show": ["all.error_solved.mean_mm"]})

    def lines(self, *texts, name="cached-000001.jsonl"):
        self.write(f"results/{name}", "".join(texts))

    def outcomes(self):
        return [each.outcome for each in weft.open_results(self.folder)]

    def test_have_all_cells_of_the_plan_in_its_order(self):
        self.lines(cell_line(key_of(2), mean_mm=3.0), cell_line(key_of(0), mean_mm=1.5), cell_line(key_of(1), "failed", 9.0))
        results = weft.open_results(self.folder)
        self.assertEqual([each.outcome for each in results], ["done", "failed", "done", "missing"])
        self.assertEqual((len(results), results.axes, results[1].reason), (4, {"filter": ["aem", "lpm"]}, "it fell"))
        np.testing.assert_array_equal(results.metric("all.error_solved.mean_mm"), [1.5, np.nan, 3.0, np.nan])
        np.testing.assert_array_equal(results.metric("all.error_solved.mean_mm", sequence="a"), [1.5, 3.0])
        self.assertEqual(results.table()[0], {"filter": "aem", "sequence": "a", "seed": 1, "outcome": "done",
                                              "all.error_solved.mean_mm": 1.5})
        self.assertEqual(results[2].folder, self.folder / "cells" / key_of(2))
        with self.assertRaisesRegex(weft.Error, "no axis 'filters'; it has: filter, seed, sequence"):
            results.where(filters="aem")

    def test_show_means_of_each_value_in_notebooks(self):
        self.lines(cell_line(key_of(0), mean_mm=1.0), cell_line(key_of(1), mean_mm=2.0), cell_line(key_of(2), "failed"))
        text = text_of(shown(weft.open_results(self.folder)))
        self.assertIn("cells 2 done, 1 failed, 1 missing", text)
        self.assertIn("mean of cells all.error_solved.mean_mm filter = aem 1.5 filter = lpm", text)

    def test_name_metrics_as_the_program_does(self):
        self.lines(cell_line(key_of(0), mean_mm=None))
        cell = weft.open_results(self.folder)[0]
        self.assertTrue(np.isnan(cell.metric("all.error_solved.mean_mm")))
        self.assertEqual((cell.metric("filters.tpr_percent"), cell.metric("filters.filters.tpr_percent")), (80.0, 80.0))
        with self.assertRaisesRegex(weft.Error, "there is no 'mean'; there are: mean_mm"):
            cell.metric("all.error_solved.mean")
        with self.assertRaisesRegex(weft.Error, "is no number"):
            cell.metric("all.error_solved")

    def test_count_the_first_line_of_a_key_and_times_alone_before_others(self):
        self.lines(cell_line(key_of(0), mean_mm=2.0), cell_line(key_of(0), mean_mm=3.0))
        self.assertEqual(weft.open_results(self.folder)[0].metric("all.error_solved.mean_mm"), 2.0)
        self.lines(cell_line(key_of(0), mean_mm=1.0), name="alone-000001.jsonl")
        self.assertEqual(weft.open_results(self.folder)[0].metric("all.error_solved.mean_mm"), 1.0)

    def test_count_no_line_that_is_withdrawn_or_cut_off(self):
        whole = cell_line(key_of(0), "failed")
        self.lines(whole, cell_line(key_of(1), mean_mm=1.0), cell_line(key_of(2), mean_mm=1.0)[:-1])
        withdrawal = checked('{"schema":"weft.withdrawn/1","file":"cached-000001.jsonl","line":1,"reason":"r"}')
        self.lines(withdrawal, name="withdrawn-000001.jsonl")
        self.assertEqual(self.outcomes(), ["missing", "done", "missing", "missing"])
        self.lines(cell_line(key_of(0), mean_mm=4.0), name="cached-000002.jsonl")
        self.assertEqual(self.outcomes(), ["done", "done", "missing", "missing"])

    @unittest.skipIf(xxhash is None, "python3-xxhash is missing")
    def test_name_lines_that_were_changed_after_they_were_written(self):
        self.lines(cell_line(key_of(0), mean_mm=2.0).replace("2.0", "1.0"), cell_line(key_of(1), mean_mm=2.0))
        results = weft.open_results(self.folder)
        self.assertEqual([each.outcome for each in results], ["missing", "done", "missing", "missing"])
        self.assertEqual(results.damaged, [f"{self.folder}/results/cached-000001.jsonl:1: it was changed after it "
                                           "was written"])
        self.assertEqual(results.unchecked, 0)

    @unittest.skipIf(xxhash is None, "python3-xxhash is missing")
    def test_count_unreadable_lines(self):
        self.lines(cell_line(key_of(0), mean_mm=2.0), cell_line(key_of(1), mean_mm=2.0, schema="weft.cell/1"))
        self.assertEqual(weft.open_results(self.folder).unchecked, 1)
        sys.modules["xxhash"] = None  # as where it is not installed
        self.addCleanup(sys.modules.__setitem__, "xxhash", xxhash)
        self.assertEqual(weft.open_results(self.folder).unchecked, 2)

    def test_judge_lines_of_old_programs_by_the_rule_of_today(self):
        self.lines(cell_line(key_of(0), mean_mm=2.0, schema="weft.cell/1", failed=1),
                   cell_line(key_of(1), mean_mm=2.0, schema="weft.cell/1"))
        self.assertEqual(self.outcomes()[:2], ["failed", "done"])

    def test_of_other_kinds_are_refused(self):
        self.lines(cell_line(key_of(0), mean_mm=2.0, schema="weft.cell/1").replace("cell/1", "cell/9"))
        with self.assertRaisesRegex(weft.Error, "cached-000001.jsonl:1: has the schema 'weft.cell/9'"):
            weft.open_results(self.folder)
        self.write("manifest.json", {"schema": "weft.results/2"})
        with self.assertRaisesRegex(weft.Error, "not weft.results/1") as caught:
            weft.open_results(self.folder)
        self.assertEqual(caught.exception.code, "incompatible")
        with self.assertRaisesRegex(weft.Error, "no results folder"):
            weft.open_results(self.folder / "results")


if __name__ == "__main__":
    unittest.main()
