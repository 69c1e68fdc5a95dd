# SPDX-License-Identifier: Apache-2.0
"""Starts the live demo as a user would and reads its page and its frames until it is interrupted.

usage: live_test.py WEFT
"""

from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
import urllib.request
from pathlib import Path

PATIENCE_S = 120


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Live(unittest.TestCase):
    program = ""

    def setUp(self) -> None:
        self.scratch = tempfile.TemporaryDirectory(prefix="weft-live-")
        self.folder = Path(self.scratch.name)
        self.address = f"127.0.0.1:{free_port()}"

    def tearDown(self) -> None:
        self.scratch.cleanup()

    def start(self, *more: str) -> subprocess.Popen:
        return subprocess.Popen(
            [self.program, "live", *more, "--no-browser", "--out", "run",
             "--set", f"live.address={self.address}"],
            cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_the_demo_serves_its_page_and_its_frames_until_it_is_interrupted(self) -> None:
        live = self.start("--demo")
        try:
            self.assertEqual(live.stdout.readline(), f"http://{self.address}/\n")
            page = urllib.request.urlopen(f"http://{self.address}/", timeout=PATIENCE_S)
            self.assertIn("text/html", page.headers["Content-Type"])
            self.assertIn("<html", page.read().decode())
            with urllib.request.urlopen(f"http://{self.address}/frames.jsonl",
                                        timeout=PATIENCE_S) as lines:
                frames = [json.loads(lines.readline()) for _ in range(5)]
        finally:
            live.send_signal(signal.SIGINT)
            out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 0, err)
        self.assertIn("stopped early", out)
        self.assertEqual({frame["state"] for frame in frames}, {"estimated"})
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
        self.assertIn("weft live --demo", err)

    def test_a_taken_port_is_an_error_that_says_what_to_do(self) -> None:
        host, port = self.address.split(":")
        with socket.socket() as other:
            other.bind((host, int(port)))
            other.listen()
            live = self.start("--demo")
            out, err = live.communicate(timeout=PATIENCE_S)
        self.assertNotEqual(live.returncode, 0, out)
        self.assertIn(self.address, err)
        self.assertIn("--set live.address=", err)


if __name__ == "__main__":
    Live.program = sys.argv.pop(1)
    unittest.main()
