# SPDX-License-Identifier: Apache-2.0
"""Calibrates the camera of a run as the live page does, and starts the run again with the result.

usage: calibrate_live_test.py WEFT PLAYED_CAMERA ROOT

The frames show the printed board, through a lens that is known (played_camera.cpp).
"""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

from live_client import Closed, Viewer

PATIENCE_S = 60
STILL = 12  # frames in which the board does not move
FX_PX = 1.5 * 612.0  # of the lens in played_camera.cpp
PIPELINE = """\
weft: 1
extends: {root}/pipelines/live_demo.yaml
source: {{use: sources/images, params: {{path: board/*.jpg, camera: auto, fps: 20}}}}
"""


def images_of(film: bytes) -> list[bytes]:
    """The JPEGs of an AVI of Motion JPEG."""
    return [film[found.start():film.index(b"\xff\xd9", found.start()) + 2]
            for found in re.finditer(b"\xff\xd8\xff", film)]


class CalibrateLive(unittest.TestCase):
    program = played_camera = root = ""

    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory(prefix="weft-calibrate-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.port = free.getsockname()[1]
        self.command("calibrate", "board", "--out", "board.pdf")
        print_ = Path(self.root) / "pipelines/data/sheet_texture.png"
        subprocess.run([self.played_camera, "board.pdf", str(print_)], cwd=self.folder, check=True,
                       capture_output=True)
        (self.folder / "board").mkdir()
        for i, image in enumerate(images_of((self.folder / "board.avi").read_bytes())):
            for k in range(STILL):
                (self.folder / f"board/{STILL * i + k:04}.jpg").write_bytes(image)
        (self.folder / "board.yaml").write_text(PIPELINE.format(root=self.root))

    def command(self, *words: str) -> None:
        subprocess.run([self.program, *words], cwd=self.folder, check=True, capture_output=True)

    def connect(self) -> Viewer:
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                return Viewer(self.port)
            except (ConnectionError, Closed):
                self.assertLess(time.monotonic(), end, "no run answers")
                time.sleep(0.05)

    @staticmethod
    def watch(client: Viewer, ends) -> list[dict]:
        """The states of the calibration until one for which ends() holds."""
        states: list[dict] = []
        client.say(type="ready")
        while not states or not ends(states[-1]):
            message = client.read()
            if isinstance(message, bytes):
                client.say(type="ready")
            elif message["type"] == "calibration":
                states.append(message["calibration"])
        return states

    def test_frames_of_the_board_become_a_camera_file_with_which_the_run_starts_again(self) -> None:
        live = subprocess.Popen(
            [self.program, "live", "board.yaml", "--no-browser", "--out", "run", "--set",
             f"live.address=127.0.0.1:{self.port}"], cwd=self.folder, text=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.addCleanup(live.communicate)
        self.addCleanup(live.kill)
        with self.connect() as client:
            self.assertIn("no calibration has begun", client.request("calibrate end 4")["refusal"])
            self.assertIn("huge", client.request('calibrate begin {"squares": "huge"}')["refusal"])
            self.assertEqual(client.request('calibrate begin {"squares": "7x5"}')["refusal"], "")
            states = self.watch(client, lambda state: state.get("views", 0) >= 12)
            collected = [state for state in states if "corners_px" in state]
            self.assertTrue(all(len(state["corners_px"]) % 2 == 0 for state in collected))
            self.assertEqual(len(states[-1]["cells"]), 36)
            self.assertTrue(states[-1]["missing"])
            self.assertEqual(client.request("calibrate end 4")["refusal"], "")
            done = self.watch(client, lambda state: state["state"] in ("done", "failed"))[-1]
            self.assertEqual(done["state"], "done", done)
            self.assertLess(abs(done["fx"] / FX_PX - 1), 0.01)
            file = Path(done["path"])
            self.assertEqual(file, self.folder / "run/camera.yaml")
            self.assertEqual(file.read_text(), done["camera_file"])
            restart = client.request("restart " + json.dumps([f"source.camera={file}"]))
            self.assertEqual(restart["refusal"], "")
            with self.assertRaises((Closed, ConnectionError)):
                while True:
                    client.read()
        with self.connect() as client:
            self.assertLess(abs(client.hello["camera"]["fx"] / done["fx"] - 1), 1e-6)
            values = {each["setting"]: each["value"]
                      for each in client.settings()["source"]["parameters"]}
            self.assertEqual(values["source.camera"], str(file))
        self.assertTrue((self.folder / "run-2").is_dir())


if __name__ == "__main__":
    CalibrateLive.program, CalibrateLive.played_camera, CalibrateLive.root = (
        sys.argv.pop(1), sys.argv.pop(1), sys.argv.pop(1))
    unittest.main()
