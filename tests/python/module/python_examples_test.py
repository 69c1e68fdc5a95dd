#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The programs of docs/examples/python_module: python_examples_test.py WEFT ROOT"""

import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np
import weft
from PIL import Image

WEFT, ROOT = sys.argv[1], pathlib.Path(sys.argv[2])
DEMO = str(ROOT / "pipelines/demo.yaml")
FRAMES = 3


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        holder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(holder.cleanup)
        cls.folder = pathlib.Path(holder.name)
        (cls.folder / "kept.yaml").write_text(f"""weft: 1
extends: {DEMO}
source: {{params: {{frames: {FRAMES}}}}}
sinks: [{{use: sinks/dataset, as: kept, params: {{path: kept, dense_truth: false}}}}]
""", encoding="utf-8")
        for words in (["run", "kept.yaml", "--quiet", "--out", "run"], ["eval", "run"]):
            subprocess.run([WEFT, *words], check=True, cwd=cls.folder, stdout=subprocess.DEVNULL)

    def said_by(self, example, *words, status=0):
        ended = subprocess.run([sys.executable, "-B", str(ROOT / "docs/examples/python_module" / example), *words],
                               text=True, capture_output=True, check=False, cwd=self.folder)
        self.assertEqual(ended.returncode, status, ended.stderr)
        return ended.stdout + ended.stderr

    def test_feed_images_from_memory(self):
        Image.fromarray(np.zeros((480, 640), np.uint8)).save(self.folder / "black.png")
        lines = self.said_by("from_memory.py", DEMO, "black.png",
                             *(f"run/kept/frames/00000{i}.png" for i in range(FRAMES))).splitlines()
        self.assertEqual(len(lines), 1 + FRAMES)
        self.assertRegex(lines[0], "black.png: none: .*no keypoints")
        for line in lines[1:]:
            self.assertRegex(line, r"estimated, confidence (0\.9\d|1\.00), centre at -?0\.00\d -?0\.00\d 0\.45\d m$")

    def test_give_matches_from_memory_the_shapes_that_files_give(self):
        pipeline = str(ROOT / "pipelines/matches.yaml")
        subprocess.run([WEFT, "run", pipeline, "--quiet", "--out", "of_files"], check=True, cwd=self.folder,
                       stdout=subprocess.DEVNULL)
        tables = sorted(map(str, (ROOT / "pipelines/data/match_set/matches").glob("*.csv")))
        lines = self.said_by("own_matches.py", pipeline, *tables).splitlines()
        run = weft.open_run(self.folder / "of_files")
        expected = [f"{state}, {int(kept)} of 300 matches kept"
                    for state, kept in zip(run.states, run.stage("filters", "kept"))]
        self.assertEqual([line.rpartition(": ")[2] for line in lines], expected)

    def test_plot_the_errors_of_a_run(self):
        self.assertRegex(self.said_by("plot_errors.py", "run", "errors.png"), f"^{FRAMES} of {FRAMES} frames with an error")
        self.assertEqual(Image.open(self.folder / "errors.png").size, (640, 320))

    def test_draw_a_mesh_over_its_image(self):
        said = self.said_by("draw_mesh.py", DEMO, "run/kept/frames/000000.png", "mesh.png")
        self.assertIn("117 vertices", said)
        picture = np.asarray(Image.open(self.folder / "mesh.png").convert("RGB")).astype(int)
        blue = (picture[..., 2] > picture[..., 0] + 40).mean()
        self.assertGreater(blue, 0.1, "the mesh is not to be seen")

    def test_say_what_is_missing(self):
        Image.fromarray(np.zeros((480, 640), np.uint8)).save(self.folder / "black.png")
        self.assertIn("no shape: no keypoints", self.said_by("draw_mesh.py", DEMO, "black.png", "no.png", status=1))
        self.assertIn("no folder of a run", self.said_by("plot_errors.py", "run/kept", "no.png", status=1))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
