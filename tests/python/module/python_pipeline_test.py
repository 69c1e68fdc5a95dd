#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""weft.Pipeline, with real plugins: pipeline_test.py WEFT ROOT PYTHON_PLUGINS"""

import gc
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest
import weakref

import numpy as np
import weft
from PIL import Image

WEFT, ROOT, PYTHON_PLUGINS = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3]
DEMO = ROOT / "pipelines/demo.yaml"
CAMERA = weft.Camera(820.0, 820.0, 319.5, 239.5, 640, 480)
FRAMES = 4
ARRAYS = ("vertices_m", "source", "covariance_m2")


def setUpModule():
    """One run, whose images are kept."""
    global FOLDER, RUN, IMAGES
    holder = tempfile.TemporaryDirectory()
    unittest.addModuleCleanup(holder.cleanup)
    FOLDER = pathlib.Path(holder.name)
    (FOLDER / "kept.yaml").write_text(f"""weft: 1
extends: {DEMO}
source: {{params: {{frames: {FRAMES}}}}}
sinks:
  - {{use: sinks/dataset, as: kept, params: {{path: kept, dense_truth: false}}}}
""", encoding="utf-8")
    subprocess.run([WEFT, "run", str(FOLDER / "kept.yaml"), "--quiet", "--out", str(FOLDER / "run")], check=True,
                   stdout=subprocess.DEVNULL)
    RUN = weft.open_run(FOLDER / "run")
    IMAGES = [np.asarray(Image.open(file)) for file in sorted((FOLDER / "run/kept/frames").glob("*.png"))]


def waits_for(file):
    """Whether it is made; a component may have been forgotten."""
    for _ in range(60_000):
        if file.exists():
            return True
        time.sleep(0.001)
    return False


class Shapes(unittest.TestCase):
    def same_as_run(self, images, **options):
        with weft.Pipeline(DEMO, RUN.camera, **options) as pipeline:
            frames = [pipeline.process(image) for image in images]
        self.assertEqual(len(frames), FRAMES)
        for frame, of_run in zip(frames, RUN):
            self.assertEqual((frame.index, frame.state, frame.age_frames, frame.failed, frame.confidence),
                             (of_run.index, "estimated", of_run.age_frames, False, of_run["shape/confidence"]))
            for name in ARRAYS:
                ours, theirs = getattr(frame, name), getattr(of_run, name)
                self.assertEqual((ours.dtype, ours.shape), (theirs.dtype, theirs.shape))
                self.assertEqual(ours.tobytes(), theirs.tobytes(), f"{name} of frame {frame.index}")
            recorded = {name.removeprefix("shape/diag."): of_run[name] for name in of_run.names
                    if name.startswith("shape/diag.")}
            self.assertEqual(frame.diagnostics, recorded)
            self.assertEqual(frame.report["stages"][1]["keypoints"], RUN.stage("detectors", "keypoints")[frame.index])

    def test_are_those_of_the_run_of_the_same_images_bit_for_bit(self):
        self.same_as_run(IMAGES)

    def test_are_the_same_with_a_stage_in_a_process_of_its_own(self):
        self.same_as_run(IMAGES, set={"filters.isolate": "process"})

    def test_are_the_same_however_the_pixels_lie_in_memory(self):
        larger = np.zeros((500, 700), np.uint8)
        larger[10:490, 30:670] = IMAGES[0]
        turned = np.asfortranarray(IMAGES[1])
        reversed_rows = IMAGES[2][::-1].copy()[::-1]
        read_only = IMAGES[3].copy()
        read_only.flags.writeable = False
        self.same_as_run([larger[10:490, 30:670], turned, reversed_rows, read_only])

    def test_keep_their_memory_when_frame_and_pipeline_are_gone(self):
        pipeline = weft.Pipeline(DEMO, CAMERA)
        gone = weakref.ref(pipeline)
        frame = pipeline.process(IMAGES[0])
        vertices, faces, texture = frame.vertices_m, pipeline.template.faces, pipeline.template.texture
        pipeline.process(IMAGES[1])
        del frame, pipeline
        gc.collect()
        self.assertIsNone(gone())
        np.zeros((50, 480, 640), np.uint8)[...] = 255
        self.assertEqual(vertices.tobytes(), RUN[0].vertices_m.tobytes())
        np.testing.assert_array_equal(faces, RUN.template.faces)
        np.testing.assert_array_equal(texture, RUN.template.texture)

    def test_come_without_a_copy_of_what_the_library_answered(self):
        with weft.Pipeline(DEMO, CAMERA) as pipeline:
            vertices = pipeline.process(IMAGES[0]).vertices_m
        self.assertFalse(vertices.flags.owndata)
        self.assertTrue(vertices.flags.writeable)
        self.assertTrue(vertices.flags.c_contiguous)

    def test_are_none_before_the_first_one(self):
        with weft.Pipeline(DEMO, CAMERA) as pipeline:
            frame = pipeline.process(np.zeros((480, 640, 3), np.uint8))
        self.assertEqual((frame.state, frame.confidence, frame.vertices_m, frame.source, frame.failed),
                         ("none", 0.0, None, None, False))
        self.assertEqual([(each.name, each.status) for each in frame.stages[:2]],
                         [("detectors", "degenerate"), ("matchers", "no_result")])
        self.assertIn("no keypoints", frame.stages[1].reason)


class Mistakes(unittest.TestCase):
    def refused(self, *arguments, raised=weft.Error, **options):
        with self.assertRaises(raised) as caught:
            weft.Pipeline(*arguments, **options)
        return caught.exception

    def test_of_the_file_have_their_place_and_what_was_meant(self):
        file = FOLDER / "wrong.yaml"
        file.write_text(DEMO.read_text(encoding="utf-8").replace("data/", f"{ROOT}/pipelines/data/").replace(
            "robust: geman_mcclure", "robst: geman_mcclure"), encoding="utf-8")
        error = self.refused(file, CAMERA)
        self.assertRegex(error.where, rf"^{file}:\d+:\d+$")
        self.assertIn("did you mean 'robust'?", error.message)
        self.assertEqual(error.code, "invalid_value")
        self.assertEqual(str(error), f"{error.where}: {error.message}")

    def test_of_a_file_that_is_not_there_name_it(self):
        error = self.refused("no/such.yaml", CAMERA)
        self.assertIn("no/such.yaml", str(error))

    def test_of_settings_have_their_place(self):
        self.assertTrue(self.refused(DEMO, CAMERA, set={"filters.stifness": 1}).where.startswith("--set filters.stif"))
        error = self.refused(DEMO, CAMERA, set={"filters.stiffness": object()})
        self.assertEqual((error.where, error.code), ("set filters.stiffness", "invalid_value"))
        self.assertIn("nan", str(self.refused(DEMO, CAMERA, set={"filters.stiffness": float("nan")})).lower())

    def test_of_a_camera_are_reported(self):
        self.refused(DEMO, [[820, 0, 320], [0, 820, 240], [0, 0, 1]], raised=TypeError)
        self.assertEqual(self.refused(DEMO, weft.Camera(0.0, 820.0, 319.5, 239.5, 640, 480)).where, "camera")
        self.refused(DEMO, CAMERA, fps=0, raised=ValueError)
        with self.assertRaisesRegex(ValueError, "skew"):
            weft.Camera.of_matrix([[820, 1, 320], [0, 820, 240], [0, 0, 1]], 640, 480)

    def test_of_images_are_reported_and_change_nothing(self):
        with weft.Pipeline(DEMO, CAMERA) as pipeline:
            for image, raised, sentence in (
                    (None, TypeError, "None"),
                    (IMAGES[0] / 255.0, TypeError, "uint8.*float64"),
                    (np.full((480, 640), np.nan), TypeError, "uint8"),
                    (IMAGES[0].astype(np.int8), TypeError, "uint8"),
                    ("frame.png", TypeError, "uint8"),
                    (np.zeros((0, 0), np.uint8), weft.Error, "image: .*0x0 px"),
                    (np.zeros((480, 0), np.uint8), weft.Error, "image: .*0x480 px"),
                    (np.zeros((480, 641), np.uint8), weft.Error, "image: .*641x480 px.*640x480 px"),
                    (np.zeros((480, 640, 4), np.uint8), weft.Error, r"image: .*\[480,640,4\].*BGR"),
                    (np.zeros(480, np.uint8), weft.Error, r"image: .*\[480\]"),
                    (np.uint8(7), weft.Error, "image: "),
                    (np.zeros((1,) * 9, np.uint8), weft.Error, "image: .*axes")):
                with self.subTest(sentence=sentence), self.assertRaisesRegex(raised, sentence):
                    pipeline.process(image)
            for t_s in (float("nan"), float("inf")):
                with self.assertRaisesRegex(weft.Error, "time: .*NaN"):
                    pipeline.process(IMAGES[0], t_s)
            frame = pipeline.process(IMAGES[0])
        self.assertEqual(frame.index, 0)
        self.assertEqual(frame.vertices_m.tobytes(), RUN[0].vertices_m.tobytes())

    def test_of_times_that_go_back_name_both(self):
        with weft.Pipeline(DEMO, CAMERA) as pipeline:
            pipeline.process(IMAGES[0], 2.5)
            with self.assertRaisesRegex(weft.Error, r"time: .* 2\.25 s .* 2\.5 s"):
                pipeline.process(IMAGES[1], 2.25)
            self.assertEqual(pipeline.process(IMAGES[1], 2.5).index, 1)

    def test_of_forking_are_reported_at_once(self):
        """Opening in the children alone is none."""
        ending = self.in_child(f"""
            child = os.fork()
            if child == 0:
                with weft.Pipeline({str(DEMO)!r}, CAMERA) as pipeline: os._exit(pipeline.process(IMAGE).index)
            assert os.waitpid(child, 0)[1] == 0
            pipeline = weft.Pipeline({str(DEMO)!r}, CAMERA)
            pipeline.process(IMAGE)
            for use in (lambda: pipeline.process(IMAGE), lambda: weft.Pipeline({str(DEMO)!r}, CAMERA)):
                child = os.fork()
                if child == 0:
                    try:
                        use()
                    except weft.Error as error:
                        pipeline.close()
                        os._exit(7 if error.code == "unsupported" and "forked" in error.message else 8)
                assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
            assert pipeline.process(IMAGE).index == 1
            """)
        self.assertEqual(ending.returncode, 0, ending.stderr)

    def in_child(self, script):
        start = ("import os, signal, weft, numpy as np\nsignal.alarm(60)\n"
                 f"CAMERA = weft.{CAMERA!r}\nIMAGE = np.zeros((480, 640), np.uint8)\n")
        return subprocess.run([sys.executable, "-c", start + textwrap.dedent(script)], capture_output=True, text=True,
                              check=False)

    def test_of_using_a_closed_pipeline_are_reported(self):
        pipeline = weft.Pipeline(DEMO, CAMERA)
        pipeline.close()
        pipeline.close()
        with self.assertRaisesRegex(weft.Error, "closed"):
            pipeline.process(IMAGES[0])
        self.assertEqual(len(pipeline.template.vertices_m), 117)


class Settings(unittest.TestCase):
    def test_are_numbers_texts_flags_and_lists(self):
        options = {"filters.use": "filters/myneighbor", "seed": np.int64(3), "warps.robust": "off",
                   "solvers.continue_uncovered_bend": True}
        with weft.Pipeline(DEMO, CAMERA, set=options) as pipeline:
            frame = pipeline.process(IMAGES[0])
        self.assertEqual(frame.state, "estimated")
        kept = next(each for each in frame.report["stages"] if each["stage"] == "filters")["kept"]
        self.assertNotEqual(kept, RUN.stage("filters", "kept")[0])


class Threads(unittest.TestCase):
    def setUp(self):
        self.called, self.go = (FOLDER / f"{self.id()}.{name}" for name in ("called", "go"))

    def waiting(self, isolate):
        """A pipeline whose filter waits for the file `go`."""
        return weft.Pipeline(DEMO, CAMERA, plugin_path=PYTHON_PLUGINS, set={
            "filters.use": "filters/test.waiting", "filters.isolate": isolate,
            "filters.params": {"called": str(self.called), "go": str(self.go)}})

    def test_go_on_while_an_image_is_processed_and_a_second_image_is_refused(self):
        for isolate in ("process", "none"):
            with self.subTest(isolate=isolate), self.waiting(isolate) as pipeline:
                answers = []
                worker = threading.Thread(target=lambda: answers.append(pipeline.process(IMAGES[0])), name="other")
                worker.start()
                try:
                    self.assertTrue(waits_for(self.called))
                    with self.assertRaisesRegex(weft.Error, "another thread") as caught:
                        pipeline.process(IMAGES[1])
                    self.assertEqual(caught.exception.code, "unsupported")
                finally:
                    self.go.touch()
                    worker.join()
                self.assertEqual((answers[0].index, answers[0].state), (0, "estimated"))
                self.assertEqual(pipeline.process(IMAGES[1]).index, 1)
            self.called.unlink()
            self.go.unlink()

    def test_work_in_pipelines_of_their_own_at_the_same_time(self):
        answers = {}

        def work(name):
            with weft.Pipeline(DEMO, CAMERA) as pipeline:
                answers[name] = [pipeline.process(image).vertices_m.tobytes() for image in IMAGES]

        workers = [threading.Thread(target=work, args=(name,)) for name in range(3)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for name in range(3):
            self.assertEqual(answers[name], [frame.vertices_m.tobytes() for frame in RUN])

    def test_of_python_meet_an_interrupt_when_the_image_is_done(self):
        with self.waiting("process") as pipeline:
            def interrupt():
                waits_for(self.called)
                os.kill(os.getpid(), signal.SIGINT)
                self.go.touch()

            other = threading.Thread(target=interrupt)
            other.start()
            with self.assertRaises(KeyboardInterrupt):
                pipeline.process(IMAGES[0])
            other.join()
            self.assertEqual((pipeline.process(IMAGES[1]).index, pipeline.process(IMAGES[2]).state), (1, "estimated"))


class Components(unittest.TestCase):
    def test_in_python_leave_the_package_of_the_program_alone(self):
        called, go = FOLDER / "components.called", FOLDER / "components.go"
        go.touch()
        with weft.Pipeline(DEMO, CAMERA, plugin_path=[PYTHON_PLUGINS], set={
                "filters.use": "filters/test.waiting", "filters.isolate": "none",
                "filters.params": {"called": str(called), "go": str(go)}}) as pipeline:
            self.assertEqual(pipeline.process(IMAGES[0]).state, "estimated")
        self.assertTrue(called.exists())
        self.assertIs(sys.modules["weft"], weft)
        self.assertTrue(hasattr(weft, "Pipeline"))
        self.assertIs(sys.modules["weft.roles"].Filter, weft.Filter)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
