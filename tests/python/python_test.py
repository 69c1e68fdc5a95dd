#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Components in Python in pipelines: python_test.py WEFT ROOT PLUGINS PYTHON_PLUGINS EXAMPLES

EXAMPLES is the folder of the example in C++ that does the same as the one in Python.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

WEFT, ROOT, *FOLDERS = sys.argv[1], pathlib.Path(sys.argv[2]), *sys.argv[3:6]
FRAMES = 3
# A sanitizer leaves a crash to the host, whose report of it is looked at.
ENVIRONMENT = {**os.environ, "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":handle_segv=0"}


def run(*words):
    paths = [word for folder in FOLDERS for word in ("--plugin-path", folder)]
    return subprocess.run([WEFT, *words, *paths], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False, env=ENVIRONMENT)


class Pipelines(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def pipeline(self, stage):
        file = self.folder / "pipeline.yaml"
        file.write_text(f"""weft: 1
source: {{use: sources/match_trials, params: {{trials: {FRAMES}, matches: 120, inlier_rate: 0.7, noise_px: 0.5}}}}
template:
  use: templates/rectangular
  params: {{texture: {ROOT}/pipelines/data/plain_sheet.png, width_m: 0.297, height_m: 0.178, columns: 10, rows: 6}}
stages:
  - {stage}
""", encoding="utf-8")
        return str(file)

    def done(self, stage, name="run", *more):
        """The folder of a run that must succeed."""
        folder = self.folder / name
        ended = run("run", self.pipeline(stage), "--quiet", "--out", str(folder), *more)
        self.assertEqual(ended.returncode, 0, ended.stdout)
        return folder

    def answers(self, stage, *more):
        """Status and reason of the stage in each frame, whatever the run came to."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        ended = run("run", self.pipeline(stage), "--quiet", "--out", str(folder), *more)
        self.assertTrue((folder / "frames.jsonl").exists(), ended.stdout)
        found = []
        for line in (folder / "frames.jsonl").read_text().splitlines():
            for each in json.loads(line).get("stages", ()):
                if each["stage"] == "filters":
                    found.append((each["status"], each.get("reason", "").removeprefix("filters/test.faulty: ")))
        self.assertEqual(len(found), FRAMES, ended.stdout)
        return found

    def masks(self, stage, name):
        folder = self.done(stage, name, "--dump", "filters")
        files = sorted((folder / "dumps/filters").glob("0*.npz"))
        self.assertEqual(len(files), FRAMES)
        return [(np.load(file)["out.inlier_mask/kept"], np.load(file)["out.inlier_mask/score"]) for file in files]


class TheExample(Pipelines):
    def test_says_and_does_what_the_one_in_cpp_does(self):
        shown = [json.loads(run("plugins", "show", name, "--json").stdout)
                 for name in ("filters/local_motion_numpy", "filters/local_motion")]
        self.assertEqual(shown[0]["parameters"], shown[1]["parameters"])
        self.assertEqual(shown[0]["methods"], shown[1]["methods"])
        params = "params: {radius_px: 80, max_deviation_px: 25}"
        ours = self.masks(f"{{use: filters/local_motion, {params}}}", "cpp")
        theirs = self.masks(f"{{use: filters/local_motion_numpy, {params}}}", "numpy")
        rejected = 0
        for (kept, score), (other_kept, other_score) in zip(ours, theirs, strict=True):
            np.testing.assert_array_equal(kept, other_kept)
            np.testing.assert_allclose(score, other_score, rtol=1e-12)
            rejected += np.count_nonzero(kept == 0)
        self.assertGreater(rejected, 10, "masks that reject nothing tell nothing")

    def test_its_pipeline_and_its_plan_can_be_run(self):
        for file in ("pipeline.yaml", "ablation.yaml"):
            ended = run("check", str(ROOT / "docs/examples/python_filter" / file))
            self.assertEqual(ended.returncode, 0, ended.stdout)

    def test_a_wrong_value_is_reported_at_its_place_as_of_any_component(self):
        ended = run("check", self.pipeline("{use: filters/local_motion_numpy, params: {radius_px: 0}}"))
        self.assertEqual(ended.returncode, 2, ended.stdout)
        self.assertRegex(ended.stdout, r"pipeline\.yaml:7:\d+: .*radius_px")


class Roles(unittest.TestCase):
    def test_each_role_of_the_host_has_a_class_with_its_methods(self):
        sys.path.insert(0, str(ROOT / "framework/python"))
        self.addCleanup(sys.path.remove, str(ROOT / "framework/python"))
        from weft import roles
        found = {each.role: list(each.methods) for each in vars(roles).values()
                 if isinstance(each, type) and issubclass(each, roles.Component) and each.role}
        expected = {}
        for role, method in re.findall(r"^\| (\w+) \| \d (\w+) \|", run("records").stdout, re.MULTILINE):
            expected.setdefault(role, []).append(method)
        self.assertEqual(found, expected)


class Isolation(Pipelines):
    STAGE = "{use: filters/test.faulty}"

    def test_a_stage_has_a_process_of_its_own_unless_the_pipeline_says_none(self):
        isolated = self.done(self.STAGE, "apart")
        self.assertIn("isolate: process", (isolated / "pipeline.yaml").read_text())
        here = self.done("{use: filters/test.faulty, isolate: none}", "here")
        self.assertIn("isolate: none", (here / "pipeline.yaml").read_text())
        again = self.folder / "again"
        ended = run("run", str(here / "pipeline.yaml"), "--quiet", "--out", str(again))
        self.assertEqual(ended.returncode, 0, ended.stdout)
        self.assertIn("isolate: none", (again / "pipeline.yaml").read_text())

    def test_a_call_gives_the_same_bytes_here_and_in_its_process(self):
        for use in ("filters/test.faulty", "filters/test.nesting", "filters/local_motion_numpy"):
            name = use.replace("/", "_")
            folder = self.done(f"{{use: {use}}}", name, "--dump", "filters")
            ended = run("replay", "filters", str(folder))
            self.assertEqual(ended.returncode, 0, f"{use}\n{ended.stdout}")

    def test_several_libraries_and_frames_at_once_share_one_interpreter(self):
        stages = ("{use: filters/test.nesting, isolate: none}\n"
                  "  - {use: filters/local_motion_numpy, isolate: none}\n"
                  "  - {use: filters/test.faulty, isolate: none}")
        self.done(stages, "many", "--set", "frames_at_once=3", "--set", "threads=3")


class Faults(Pipelines):
    def of(self, fault, **keys):
        """What came of the frame with the fault, in a process of its own; the others must be well."""
        more = "".join(f", {key}: {value}" for key, value in keys.items())
        found = self.answers(f"{{use: filters/test.faulty, params: {{fault: {fault}}}{more}}}")
        self.assertEqual((found[0][0], found[2][0]), ("ok", "ok"), found)
        return found[1]

    def line_of(self, text):
        lines = (ROOT / "tests/python/faulty.py").read_text().splitlines()
        return next(number for number, line in enumerate(lines, 1) if text in line)

    def test_what_is_raised_is_the_error_of_the_stage_with_file_and_line(self):
        for isolate in ("process", "none"):
            line = self.line_of('ValueError("told to")')
            self.assertEqual(self.of("raise", isolate=isolate),
                             ("error", f"threw: ValueError: told to (faulty.py:{line}, in filter)"))

    def test_of_what_is_raised_below_other_code_the_authors_line_is_reported(self):
        line = self.line_of("raise ValueError(what)")
        self.assertEqual(self.of("deep"),
                         ("error", f"threw: ValueError: deep inside (faulty.py:{line}, in told_to)"))

    def test_a_failure_keeps_its_own_message(self):
        self.assertEqual(self.of("failure"), ("error", "the matches are not as they should be; change them"))

    def test_answers_that_are_no_masks_are_refused(self):
        for fault, said in (("no_record", r"filter\(\) must return a Record"),
                            ("unknown_array", "inlier_mask/1 has no array 'scores'; it may have: kept, score"),
                            ("wrong_type", "array 'kept' of inlier_mask/1 has elements of type float64 where uint8"),
                            ("wrong_length", "illegal output"),
                            ("misspell", "correspondences/1 has no array 'imagepx'; it has: template_px"),
                            ("no_reason", "no reason is given")):
            status, reason = self.of(fault)
            self.assertEqual(status, "no_result" if fault == "no_reason" else "error", fault)
            self.assertRegex(reason, said)

    def test_inputs_are_read_only_views_that_may_not_be_kept(self):
        self.assertRegex(self.of("write_input")[1], "ValueError: assignment destination is read-only")
        for isolate in ("process", "none"):
            self.assertIn("keeps a view of correspondences/image_px beyond the call",
                          self.of("keep_view", isolate=isolate)[1])

    def test_a_component_that_ends_its_process_or_never_answers_costs_a_frame(self):
        for fault, keys, said in (("leave", {}, "exited with status 7"), ("crash", {}, "signal 11"),
                                  ("loop", {"isolate": "process", "deadline_ms": 1000}, "within 1000 ms")):
            status, reason = self.of(fault, **keys)
            self.assertEqual(status, "error", fault)
            self.assertIn(said, reason)


if __name__ == "__main__":
    del sys.argv[1:]
    unittest.main(verbosity=2)
