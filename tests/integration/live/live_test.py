# SPDX-License-Identifier: Apache-2.0
"""Starts the live demo as a user would and reads its page and its frames until it is interrupted.

usage: live_test.py WEFT
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "support"))

from live_client import Closed, Viewer

TOKEN = "a-token-that-is-seen-nowhere"
PATIENCE_S = 240  # for each answer, on a busy machine
STATES = {"estimated", "weak", "predicted", "lost", "none"}


class Live(unittest.TestCase):
    program = ""

    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory(prefix="weft-live-")
        self.addCleanup(scratch.cleanup)
        self.folder = Path(scratch.name)
        # Kept open to the end, so that no other process is given the port. The program may share
        # it, as long as this socket does not listen.
        self.reserved = socket.socket()
        self.addCleanup(self.reserved.close)
        self.reserved.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.reserved.bind(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.reserved.getsockname()[1]}"

    def start(self, *more: str, browser: bool = False, **variables: str) -> subprocess.Popen:
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("WEFT_")} | variables
        live = subprocess.Popen(
            [self.program, "live", *more, *([] if browser else ["--no-browser"]), "--out", "run",
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

    def until(self, holds) -> None:
        end = time.monotonic() + PATIENCE_S
        while not holds():
            self.assertLess(time.monotonic(), end, "it never comes")
            time.sleep(0.02)

    def port(self) -> int:
        return int(self.address.rsplit(":", 1)[1])

    def expect_no_token(self, *texts: str) -> None:
        for text in texts:
            self.assertNotIn(TOKEN, text)
        for file in (self.folder / "run").rglob("*"):
            if file.is_file():
                self.assertNotIn(TOKEN.encode(), file.read_bytes(), file)

    def stop(self, live: subprocess.Popen) -> tuple[str, str]:
        live.send_signal(signal.SIGINT)
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 0, err)
        return out, err

    def test_a_pause_ends_with_the_client_that_asked_for_it(self) -> None:
        live = self.start("--demo")
        live.stdout.readline()
        with Viewer(self.port()) as watching:
            watching.frame()
            pausing = Viewer(self.port())
            self.assertEqual(pausing.request("pause")["refusal"], "")
            pausing.link.close()
            said: dict = {}
            while said.get("type") != "pause" or said["paused"]:
                message = watching.read()
                said = message if isinstance(message, dict) else {}
            self.assertTrue(said["left"])
            before = watching.frame()["frame"]
            self.assertGreater(watching.frame()["frame"], before)
        self.stop(live)

    def test_a_client_saves_the_settings_in_the_run_folder_while_there_is_one(self) -> None:
        live = self.start("--demo", "--set", f"live.token={TOKEN}")
        live.stdout.readline()
        with Viewer(self.port(), TOKEN) as client:
            client.frame()
            self.assertEqual(client.request("set filters.stiffness=12")["refusal"], "")
            answer = client.request("save")
            self.assertEqual((answer["frame"], answer["refusal"]), (1, ""))
            saved = self.folder / "run" / "settings-1.yaml"
            self.assertIn("stiffness: 12", saved.read_text())
            self.expect_no_token()
            checked = subprocess.run([self.program, "check", str(saved)], text=True, capture_output=True,
                                     env=os.environ | {"WEFT_TOKEN": TOKEN})
            self.assertEqual(checked.returncode, 0, checked.stdout + checked.stderr)
            (self.folder / "run").rename(self.folder / "elsewhere")
            self.assertIn("it is no folder any more", client.request("save")["refusal"])

    def until_closed(self, client: Viewer) -> None:
        with self.assertRaises((Closed, ConnectionError)):
            while True:
                client.read()

    def connect(self) -> Viewer:
        """A client of the run that comes next."""
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                return Viewer(self.port())
            except (ConnectionError, Closed):
                self.assertLess(time.monotonic(), end, "no run answers")
                time.sleep(0.02)

    def test_a_client_starts_the_run_again_with_settings_of_the_source(self) -> None:
        live = self.start("--demo")
        live.stdout.readline()
        with Viewer(self.port()) as client:
            client.frame()
            for wrong, why in (("source.bend_per_m", "JSON list"), ('["source.bend=1"]', "bend"),
                               ('["source.bend_per_m=no"]', "no")):
                self.assertIn(why, client.request(f"restart {wrong}")["refusal"])
            self.assertEqual(client.request("set filters.stiffness=12")["refusal"], "")
            self.assertEqual(client.request('restart ["source.bend_per_m=5"]')["refusal"], "")
            self.until_closed(client)
        with self.connect() as client:
            settings = client.settings()
            values = {each["setting"]: each["value"] for each in settings["source"]["parameters"]}
            self.assertEqual(values["source.bend_per_m"], 5)
            changed = {each["setting"]: each["value"] for stage in settings["stages"]
                       for each in stage["parameters"]}
            self.assertEqual(changed["filters.stiffness"], 12)
            # A source that cannot be opened leads back to the run before, with the reason.
            self.assertEqual(client.request(
                'restart ["source.use=sources/video", "source.device=1023", "source.camera=auto"]')
                ["refusal"], "")
            self.until_closed(client)
        with self.connect() as client:
            settings = client.settings()
            self.assertEqual(settings["source"]["id"], "sources/synthetic")
            self.assertIn("/dev/video1023", settings["warnings"][0])
        self.stop(live)
        self.assertTrue((self.folder / "run-2").is_dir())

    def test_cameras_are_listed(self) -> None:
        live = self.start("--demo")
        live.stdout.readline()
        with self.open("/cameras.json") as answer:
            cameras = json.load(answer)["cameras"]
        for camera in cameras:
            self.assertLessEqual({"device", "name", "modes"}, camera.keys())
        self.stop(live)

    def test_a_token_is_in_no_file_and_in_no_argument(self) -> None:
        """It is given in one of three ways; the desktop's program notes how it is started."""
        desktop = self.folder / "bin" / "xdg-open"
        desktop.parent.mkdir()
        desktop.write_text('#!/bin/sh\necho "$@" > "$NOTES.part"\n'
                           'stat -c "%a" "${1#file://}" "$(dirname "${1#file://}")" '
                           '>> "$NOTES.part"\ncat "${1#file://}" >> "$NOTES.part"\n'
                           'mv "$NOTES.part" "$NOTES"\n')
        desktop.chmod(0o755)
        secret = self.folder / "secret"
        secret.write_text(TOKEN + "\n")
        secret.chmod(0o600)
        ways = {"environment": ["--set", "live.token=${MINE}"],
                "file": ["--set", f"live.token_file={secret}"],
                "setting": ["--set", f"live.token={TOKEN}"]}
        for way, given in ways.items():
            with self.subTest(way):
                notes, temporary = self.folder / f"notes-{way}", self.folder / f"tmp-{way}"
                temporary.mkdir()
                live = self.start(
                    "--demo", *given, browser=True, MINE=TOKEN, NOTES=str(notes), DISPLAY=":99",
                    TMPDIR=str(temporary), PATH=f"{desktop.parent}:{os.environ['PATH']}")
                self.until(notes.exists)
                argument, mode, folder_mode, page = notes.read_text().split("\n", 3)
                self.assertTrue(argument.startswith("file://"), argument)
                self.assertNotIn(TOKEN, argument)
                self.assertEqual([mode, folder_mode], ["600", "700"])
                self.assertIn(f"url=http://{self.address}/?token={TOKEN}", page)
                with Viewer(self.port(), TOKEN) as viewer:
                    viewer.frame()
                    # The pipeline that is checked anew for a change has the token.
                    self.assertEqual(viewer.insist("set filters.stiffness=11"), "")
                out, err = self.stop(live)
                self.assertIn("?token=...", out)
                self.expect_no_token(out, err)
                self.assertEqual(list(temporary.iterdir()), [], "the page for the browser stays")
                self.repeat("MINE" if way == "environment" else "WEFT_TOKEN", way != "file")
                shutil.rmtree(self.folder / "run")

    def repeat(self, variable: str, asks: bool) -> None:
        """The pipeline of the run folder asks for the token where it is needed."""
        command = [self.program, "check", "run/pipeline.yaml"]
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("WEFT_")}
        without = subprocess.run(command, cwd=self.folder, env=environment, text=True,
                                 capture_output=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(without.returncode, 2 if asks else 0, without.stderr)
        if asks:
            self.assertIn(f"the variable {variable} is not set", without.stderr)
        subprocess.run(command, cwd=self.folder, env=environment | {variable: TOKEN}, check=True,
                       capture_output=True, timeout=PATIENCE_S)

    def test_a_token_is_in_no_message(self) -> None:
        live = self.start("--demo", "--set", f"live.token={TOKEN}", "--set", "live.origin=none")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 2, out)
        self.assertIn("the origin must be", err)
        self.expect_no_token(out, err)
        live = self.start("--demo", "--set", f"live.tokn={TOKEN}", "--set", "live.token=short-one")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertEqual(live.returncode, 2, out)
        self.assertNotIn("short-one", err)

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
        self.reserved.listen()
        live = self.start("--demo")
        out, err = live.communicate(timeout=PATIENCE_S)
        self.assertNotEqual(live.returncode, 0, out)
        self.assertIn(self.address, err)
        self.assertIn("--set live.address=", err)


if __name__ == "__main__":
    Live.program = sys.argv.pop(1)
    unittest.main()
