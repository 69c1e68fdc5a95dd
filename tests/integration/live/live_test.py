# SPDX-License-Identifier: Apache-2.0
"""Starts the live demo as a user would and reads its page and its frames until it is interrupted.

usage: live_test.py WEFT
"""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
import urllib.request
from pathlib import Path

PATIENCE_S = 240  # of a machine that has other work, for each answer
STATES = {"estimated", "weak", "predicted", "lost", "none"}


class Live(unittest.TestCase):
    program = ""

    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory(prefix="weft-live-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        # Held to the end, so that nobody else is given the port; the program may share it, as long as
        # nobody listens at this one.
        self.held = socket.socket()
        self.addCleanup(self.held.close)
        self.held.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.held.bind(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.held.getsockname()[1]}"

    def start(self, *more: str) -> subprocess.Popen:
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("WEFT_")}
        live = subprocess.Popen(
            [self.program, "live", *more, "--no-browser", "--out", "run",
             "--set", f"live.address={self.address}"],
            cwd=self.folder, env=environment, text=True, stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(self.end, live)
        return live

    @staticmethod
    def end(live: subprocess.Popen) -> None:
        live.kill()
        live.wait()
        live.stdout.close()
        live.stderr.close()

    def open(self, path: str):
        """An answer of the server, whatever proxy is set."""
        opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
        return opener.open(f"http://{self.address}{path}", timeout=PATIENCE_S)

    def test_the_demo_serves_its_page_and_its_frames_until_it_is_interrupted(self) -> None:
        live = self.start("--demo")
        said = live.stdout.readline()
        if not said:
            self.fail(live.communicate()[1])
        self.assertEqual(said, f"http://{self.address}/\n")
        with self.open("/") as page:
            self.assertIn("text/html", page.headers["Content-Type"])
            self.assertIn("<html", page.read().decode())
        with self.open("/frames.jsonl") as lines:
            frames = [json.loads(lines.readline()) for _ in range(5)]
        live.send_signal(signal.SIGINT)
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 0, err)
        self.assertIn("stopped early", out)
        states = {frame["state"] for frame in frames}
        self.assertLessEqual(states, STATES)
        self.assertIn("estimated", states)
        numbers = [frame["frame"] for frame in frames]
        self.assertEqual(numbers, sorted(set(numbers)))
        kept = (self.folder / "run" / "frames.jsonl").read_text().splitlines()
        self.assertGreaterEqual(len(kept), 5)
        self.assertEqual(list((self.folder / "run" / "frames").iterdir()), [],
                         "without --keep lines are all that is left")

    def test_a_camera_that_is_not_there_is_an_error_that_says_what_to_do(self) -> None:
        live = self.start("--set", "source.device=1023")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 2, out)
        self.assertIn("/dev/video1023", err)
        for advice in ("weft live --demo", "--set source.device=1", "weft calibrate --camera",
                       "weft init FOLDER", "weft template make --photo"):
            self.assertIn(advice, err)
        self.assertFalse((self.folder / "run").exists())

    def test_a_camera_file_that_is_not_there_is_an_error_that_says_what_to_do(self) -> None:
        live = self.start("--set", "source.camera=none.yaml")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 2, out)
        self.assertIn("none.yaml", err)
        self.assertIn("weft calibrate --camera", err)

    def test_a_taken_port_is_an_error_that_says_what_to_do(self) -> None:
        self.held.listen()
        live = self.start("--demo")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertNotEqual(live.returncode, 0, out)
        self.assertIn(self.address, err)
        self.assertIn("--set live.address=", err)


if __name__ == "__main__":
    Live.program = sys.argv.pop(1)
    unittest.main()
