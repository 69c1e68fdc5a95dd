#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the live view costs: the age of a frame when a client has it, and how it slows the run.

Latency. A recording of the demo is put into a folder, file by file, as a camera would; `weft live`
reads the folder while it grows. The time of a frame runs from when its file is complete to when a
client on this machine has its message, with image and mesh, whole.

Slow-down. One run of the demo takes all frames as fast as it can. A client comes, takes every frame as
the page does, goes, and comes again; the time from a frame to the next is compared between turns with
it and the turns before and after, without. What a browser draws is not in it.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from random import Random
from typing import BinaryIO

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "support"))

from live_client import LiveRun, Viewer

PIPELINE = """\
weft: 1
extends: LIVE
source: {use: sources/images, params: {path: INCOMING, camera: CAMERA, wait_s: 60}}
"""
WARM_UP = 10  # frames of a run, and of a turn, that do not count
FEWEST = 3 * WARM_UP  # frames of a turn


def percentile(values: list[float], rank: float) -> float:
    """Interpolated linearly at rank/100 (n - 1)."""
    ordered = sorted(values)
    place = rank / 100 * (len(ordered) - 1)
    low = math.floor(place)
    high = min(low + 1, len(ordered) - 1)
    return ordered[low] + (place - low) * (ordered[high] - ordered[low])


# --- latency --------------------------------------------------------------------------------------


def record(weft: str, folder: Path, frames: int) -> Path:
    """The folder of so many images of the demo and their camera."""
    out = folder / "recorded"
    subprocess.run([weft, "live", "--demo", "--record", "--no-browser", "--out", str(out),
                    "--set", "live.address=127.0.0.1:0", "--set", "realtime=all",
                    "--set", f"source.frames={frames}"],
                   check=True, stdout=subprocess.DEVNULL, timeout=60 + 10 * frames)
    return out / "recording"


class Camera(threading.Thread):
    """Puts images into the folder, in their order and back again, at an even rate."""

    def __init__(self, images: list[bytes], folder: Path, frames: int, fps: float) -> None:
        super().__init__(daemon=True)
        self.images, self.folder, self.frames, self.fps = images, folder, frames, fps
        self.taken_s: dict[int, float] = {}  # time of the steady clock, by frame
        self.is_over = False

    def run(self) -> None:
        begin, turn = time.monotonic(), len(self.images) - 1
        for frame in range(self.frames):
            time.sleep(max(0.0, begin + frame / self.fps - time.monotonic()))
            if self.is_over:
                return
            at = frame % (2 * turn)
            part = self.folder / "part"
            part.write_bytes(self.images[at if at <= turn else 2 * turn - at])
            self.taken_s[frame] = time.monotonic()
            os.replace(part, self.folder / f"{frame:06}.png")


def latency(weft: str, folder: Path, frames: int, fps: float) -> dict:
    recording = record(weft, folder, min(frames, 60))
    images = [file.read_bytes() for file in sorted((recording / "frames").glob("*.png"))]
    incoming = folder / "incoming"
    incoming.mkdir()
    text = PIPELINE.replace("LIVE", str(ROOT / "pipelines" / "live.yaml"))
    text = text.replace("INCOMING", str(incoming / "*.png"))
    (folder / "pipeline.yaml").write_text(
        text.replace("CAMERA", str(recording / "camera.yaml")))
    camera = Camera(images, incoming, frames, fps)
    ages_ms: list[float] = []
    stages_ms: list[float] = []
    with LiveRun(weft, folder, ["pipeline.yaml"]) as run, Viewer(run.port) as viewer:
        camera.start()
        number = -1
        while number < frames - 1:  # the last one is never dropped
            head = viewer.frame()
            now_s, number = time.monotonic(), head["frame"]
            if number < WARM_UP:
                continue
            ages_ms.append(1000 * (now_s - camera.taken_s[number]))
            stages_ms.append(sum(stage["ms"] for stage in head["report"]["stages"][1:]))
        camera.is_over = True
        run.interrupt()
    return {"fps": fps, "fed": frames, "frames": len(ages_ms), "p50_ms": percentile(ages_ms, 50),
            "p99_ms": percentile(ages_ms, 99), "stages_p50_ms": percentile(stages_ms, 50)}


# --- slow-down ------------------------------------------------------------------------------------


def stay_away(lines: BinaryIO, turn_s: float) -> None:
    """For so long, and until enough more frames have their lines in the file."""
    lines.read()
    frames = 0
    time.sleep(turn_s)
    while (frames := frames + lines.read().count(b"\n")) < FEWEST:
        time.sleep(0.1)


def turns_of(run: LiveRun, turns: int, turn_s: float) -> list[tuple[int, int]]:
    """Lets a client watch and stay away in turns; of those watched the first and the last frame."""
    watched = []
    with open(run.out / "frames.jsonl", "rb") as lines:
        for _ in range(turns):
            stay_away(lines, turn_s)
            with Viewer(run.port) as viewer:
                first = last = viewer.frame()["frame"]
                end = time.monotonic() + turn_s
                while time.monotonic() < end or last - first < FEWEST:
                    last = viewer.frame()["frame"]
            watched.append((first, last))
        stay_away(lines, turn_s)
    return watched


def starts_us(run: LiveRun) -> dict[int, float]:
    """When each frame began, as trace.json has it."""
    events = json.loads((run.out / "trace.json").read_text())
    return {event["args"]["frame"]: event["ts"] for event in events if event.get("cat") == "frame"}


def slow_down(weft: str, folder: Path, turns: int, turn_s: float) -> dict:
    with LiveRun(weft, folder, ["--demo"], settings=["realtime=all"]) as run:
        watched = turns_of(run, turns, turn_s)
        run.interrupt()
    began = starts_us(run)

    def period_ms(first: int, last: int) -> float:
        """From a frame to the next, in the mean, without those at either end."""
        first, last = first + WARM_UP, last - 1
        return (began[last] - began[first]) / (last - first) / 1000

    ends = [-1, *(last for _, last in watched)]
    begins = [*(first for first, _ in watched), max(began) - 1]
    alone = [period_ms(end + 1, begin) for end, begin in zip(ends, begins)]
    together = [period_ms(first, last) for first, last in watched]
    logs = [math.log(with_it) - (math.log(before) + math.log(after)) / 2
            for with_it, before, after in zip(together, alone, alone[1:])]
    rng = Random(1)
    drawn = [statistics.fmean(rng.choices(logs, k=len(logs))) for _ in range(2000)]
    return {"turns": len(logs), "frames": len(began), "alone_ms": statistics.median(alone),
            "watched_ms": statistics.median(together), "ratio": math.exp(statistics.fmean(logs)),
            "low": math.exp(percentile(drawn, 2.5)), "high": math.exp(percentile(drawn, 97.5))}


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--frames", type=int, default=600,
                        help="of the latency (default: %(default)s)")
    parser.add_argument("--fps", type=float, default=10.0,
                        help="of the camera (default: %(default)s)")
    parser.add_argument("--turns", type=int, default=20,
                        help="with a client, for the slow-down (default: %(default)s)")
    parser.add_argument("--turn-s", type=float, default=5.0, help="(default: %(default)s)")
    parser.add_argument("--json", type=Path, metavar="FILE", help="all figures")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    weft = str(Path(arguments.weft).resolve())
    folder = Path(tempfile.mkdtemp(prefix="weft-live-figures-"))
    age = latency(weft, folder, arguments.frames, arguments.fps)
    print(f"latency: median {age['p50_ms']:.1f} ms, P99 {age['p99_ms']:.1f} ms; {age['frames']} "
          f"frames at {age['fps']:g} a second, in whose stages are {age['stages_p50_ms']:.1f} ms")
    cost = slow_down(weft, folder, arguments.turns, arguments.turn_s)
    print(f"slow-down: {cost['ratio']:.3f} times as long ({cost['low']:.3f} to {cost['high']:.3f}, "
          f"95 %); {cost['alone_ms']:.2f} ms a frame alone, {cost['watched_ms']:.2f} ms watched; "
          f"{cost['turns']} turns, {cost['frames']} frames")
    if arguments.json:
        arguments.json.write_text(json.dumps({"latency": age, "slow_down": cost}, indent=1) + "\n")
    shutil.rmtree(folder, ignore_errors=True)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
