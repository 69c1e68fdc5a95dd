# SPDX-License-Identifier: Apache-2.0
"""Reads the live demo with the example of the documentation.

usage: live_frames_test.py EXAMPLE WEFT
"""

from __future__ import annotations

import base64
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

EXAMPLE, WEFT = Path(sys.argv.pop(1)), sys.argv.pop(1)
sys.path.insert(0, str(EXAMPLE))

import numpy as np  # noqa: E402
import read_frames  # noqa: E402

PATIENCE_S = 240  # other tests may have the processor
TOKEN = "sixteen-or-more-of-it"
LINE = re.compile(r"frame (\d+)  ([\d.]+) s  (\w+)  confidence ([\d.]+)  (\d+) points around "
                  r"\((-?[\d.]+), (-?[\d.]+), (-?[\d.]+)\) m")


def message_of(head: dict, *parts: bytes) -> bytes:
    """A frame as the README of sinks/live has it."""
    text = json.dumps(head).encode()
    text += b" " * (-len(text) % 4)
    body = b"".join(part + b"\0" * (-len(part) % 4) for part in parts)
    return b"WFL1" + struct.pack("<I", len(text)) + text + body


class Messages(unittest.TestCase):
    def test_a_frame_is_read_as_the_protocol_has_it(self) -> None:
        vertices = np.arange(6, dtype="<f4") / 4
        for padding in ("", "x", "xx", "xxx"):
            head = {"frame": 7, "time_s": 0.25, "report": {"state": "weak", "padding": padding},
                    "parts": [{"name": "image", "type": "jpeg", "bytes": 5},
                              {"name": "vertices_m", "type": "f32", "bytes": 24},
                              {"name": "visible", "type": "u8", "bytes": 2}]}
            frame = read_frames.frame_of(
                message_of(head, b"jpeg!", vertices.tobytes(), bytes([1, 0])))
            self.assertEqual((frame["frame"], frame["time_s"]), (7, 0.25))
            self.assertEqual(frame["report"]["padding"], padding)
            self.assertEqual(frame["image"], b"jpeg!")
            self.assertEqual(frame["vertices_m"].tolist(), [[0, 0.25, 0.5], [0.75, 1, 1.25]])
            self.assertEqual(frame["visible"].tolist(), [1, 0])
            self.assertEqual(
                read_frames.described(frame),
                "frame 7  0.250 s  weak  2 points around (0.3750, 0.6250, 0.8750) m, 1 seen")

    def test_a_frame_without_parts_has_none(self) -> None:
        frame = read_frames.frame_of(
            message_of({"frame": 0, "time_s": None, "report": None, "parts": []}))
        self.assertEqual(frame, {"frame": 0, "time_s": None, "report": None})
        self.assertEqual(read_frames.described(frame), "frame 0  -  -  no points")

    def test_what_is_no_frame_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "no frame"):
            read_frames.frame_of(b"WEFT\0\0\0\0")

    def test_a_greeting_gives_mesh_and_camera(self) -> None:
        def text(numbers: list, kind: str) -> str:
            return base64.b64encode(np.array(numbers, kind).tobytes()).decode()

        scene = read_frames.scene_of(
            {"camera": {"fx": 500},
             "template": {"vertices_m": text([0, 0, 0, 1, 0, 0, 0, 1, 0], "<f4"),
                          "faces": text([0, 1, 2], "<i4")}})
        self.assertEqual(scene["camera"], {"fx": 500})
        self.assertEqual(scene["vertices_m"].tolist(), [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
        self.assertEqual(scene["faces"].tolist(), [[0, 1, 2]])

    def test_the_socket_is_beside_the_page_and_has_its_token(self) -> None:
        self.assertEqual(read_frames.socket_address("http://[::1]:8090/?token=a-b"),
                         "ws://[::1]:8090/ws?token=a-b")
        self.assertEqual(read_frames.socket_address("https://here"), "wss://here/ws")
        with self.assertRaisesRegex(ValueError, "no address of a page"):
            read_frames.socket_address("127.0.0.1:8090")

    def test_points_are_drawn_where_there_is_matplotlib(self) -> None:
        os.environ["MPLBACKEND"] = "Agg"
        plot = read_frames.new_plot()
        if plot is None:
            self.skipTest("matplotlib is absent")
        frame = {"frame": 1, "time_s": None, "report": None,
                 "vertices_m": np.zeros((4, 3), "f4"), "visible": np.ones(4, "u1")}
        for shown in (frame, {**frame, "visible": np.zeros(4, "u1")}):
            plot.show(shown)
            self.assertEqual(len(plot.axes.collections), 1)
        del frame["vertices_m"]
        plot.show(frame)
        self.assertEqual(len(plot.axes.collections), 0)


class LiveDemo(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory(prefix="weft-live-frames-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{probe.getsockname()[1]}"
        self.page = f"http://{self.address}/?token={TOKEN}"

    def read(self, *words: str) -> subprocess.CompletedProcess:
        return subprocess.run([sys.executable, EXAMPLE / "read_frames.py", *words], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=PATIENCE_S,
                              check=False)

    def start(self) -> subprocess.Popen:
        live = subprocess.Popen(
            [WEFT, "live", "--demo", "--no-browser", "--out", "run",
             "--set", f"live.address={self.address}", "--set", f"live.token={TOKEN}"],
            cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        self.addCleanup(live.communicate)
        self.addCleanup(live.kill)
        self.assertEqual(live.stdout.readline(), f"http://{self.address}/?token=...\n")
        return live

    def test_the_example_reads_frames_until_the_run_ends(self) -> None:
        live = self.start()
        refused = self.read(f"http://{self.address}/")
        some = self.read(self.page, "--frames", "3")
        with subprocess.Popen([sys.executable, EXAMPLE / "read_frames.py", self.page], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as reader:
            first = reader.stdout.readline()
            live.send_signal(signal.SIGINT)
            rest, complaints = reader.communicate(timeout=PATIENCE_S)
        live.wait(timeout=PATIENCE_S)
        self.assertEqual(refused.returncode, 1, refused.stdout)
        self.assertIn("token", refused.stderr)
        self.assertEqual(some.returncode, 0, some.stderr)
        self.assertEqual(len(some.stdout.splitlines()), 3)
        # A machine under load may miss the 0.4 s in which the run reports that it ends.
        self.assertIn(reader.returncode, (0, 1), complaints)
        self.assertNotIn("Traceback", complaints)

        lines = (some.stdout + first + rest).splitlines()
        kept = {line["frame"]: line for line in
                map(json.loads, (self.folder / "run/frames.jsonl").read_text().splitlines())}
        before = -1
        for line in lines:
            found = LINE.match(line)
            self.assertTrue(found, line)
            number, state, points, z_m = int(found[1]), found[3], int(found[5]), float(found[8])
            self.assertGreaterEqual(number, before, "frames came in another order")
            before = number
            self.assertEqual(state, kept[number]["state"])
            self.assertAlmostEqual(float(found[4]), kept[number]["confidence"], delta=0.01)
            self.assertGreater(points, 3)
            self.assertTrue(0.3 < z_m < 0.6, "the demo's sheet is 0.45 m before the camera")

    def test_a_run_that_is_not_there_is_missed_with_words(self) -> None:
        missed = self.read(self.page)
        self.assertEqual(missed.returncode, 1)
        self.assertIn("weft live --demo", missed.stderr)
        self.assertNotIn("Traceback", missed.stderr)


if __name__ == "__main__":
    unittest.main()
