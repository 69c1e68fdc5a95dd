#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Lets clients come to the live view of a run, stall and go, and watches its memory and its frames.

Exits 1 if the memory of the program grows, a frame is lost, or a faithful client is not served.
"""

from __future__ import annotations

import argparse
import http.client
import json
import shutil
import socket
import statistics
import struct
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from live_client import PATIENCE_S, SCRIPTED, Closed, FaithfulViewer, LiveRun, Viewer

TOKEN = "a-token-of-sixteen-or-more"
SLEEP_MS = 20  # that each frame takes at least
WARM_UP = 0.3  # share of the time
# The run keeps the stage times of each frame for the table at its end.
KEPT_KiB = 0.5
LET_GO = "let_go"


class Reader(threading.Thread):
    """Reads a line for each frame, until the run ends."""

    def __init__(self, port: int) -> None:
        super().__init__(daemon=True)
        self.connection = http.client.HTTPConnection("127.0.0.1", port, timeout=PATIENCE_S)
        self.connection.request("GET", f"/frames.jsonl?token={TOKEN}")
        self.lines = self.connection.getresponse()
        self.numbers: list[int] = []
        self.failure = ""
        self.start()

    def run(self) -> None:
        try:
            while (line := self.lines.readline()).endswith(b"\n"):
                self.numbers.append(json.loads(line)["frame"])
        except (ConnectionError, http.client.IncompleteRead):
            pass  # a server that ends waits for no client very long
        except (OSError, ValueError, http.client.HTTPException) as failure:
            self.failure = repr(failure)

    def faults(self, frames: int) -> list[str]:
        """Once the run has ended, after so many frames."""
        self.join(PATIENCE_S)
        found = [f"the reader of lines: {self.failure}"] if self.failure else []
        first = self.numbers[0] if self.numbers else frames
        missing = set(range(first, frames)) - set(self.numbers)
        # The last ones may be on their way when all ends.
        if self.numbers != sorted(set(self.numbers)) or len(missing) > 5:
            found.append(f"the reader of lines misses {len(missing)} of {frames - first}")
        return found


class Visitor:
    """One of the crowd: comes in one of several ways, stalls, goes, and comes again."""

    def __init__(self, port: int, rng: Random, end: float) -> None:
        self.port, self.rng, self.end = port, rng, end
        self.visits: Counter[str] = Counter()

    def stay(self) -> None:
        ways = [self.watch, self.stall, self.take_half_the_page, self.stop_reading_lines,
                self.say_half_a_request]
        while time.monotonic() < self.end:
            way = self.rng.choice(ways)
            try:
                way()
                self.visits[way.__name__] += 1
            except (OSError, Closed, ValueError):
                self.visits[LET_GO] += 1

    def pause(self) -> None:
        """Mostly short; now and then longer than the server waits."""
        seconds = self.rng.choices([0.01, 0.1, 0.5, 2.0, 40.0], [20, 20, 10, 4, 0.2])[0]
        time.sleep(max(0.0, min(seconds, self.end - time.monotonic())))

    def leave(self, link: socket.socket) -> None:
        if self.rng.random() < 0.5:  # by a reset
            link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        link.close()

    def ask(self, request: str) -> socket.socket:
        link = socket.create_connection(("127.0.0.1", self.port), timeout=PATIENCE_S)
        link.sendall(request.encode())
        return link

    def request_for(self, path: str) -> str:
        return f"GET {path}?token={TOKEN} HTTP/1.1\r\nHost: 127.0.0.1:{self.port}\r\n\r\n"

    def watch(self) -> None:
        viewer = Viewer(self.port, TOKEN)
        for _ in range(self.rng.randrange(30)):
            viewer.frame()
        self.leave(viewer.link)

    def stall(self) -> None:
        viewer = Viewer(self.port, TOKEN)
        for _ in range(self.rng.randrange(20)):
            viewer.say(type="ready")
            self.pause()
        self.leave(viewer.link)

    def take_half_the_page(self) -> None:
        link = self.ask(self.request_for("/"))
        link.recv(500)
        self.pause()
        self.leave(link)

    def stop_reading_lines(self) -> None:
        link = self.ask(self.request_for("/frames.jsonl"))
        for _ in range(self.rng.randrange(5)):
            link.recv(1000)
        self.pause()
        self.leave(link)

    def say_half_a_request(self) -> None:
        request = self.request_for("/")
        link = self.ask(request[:self.rng.randrange(len(request))])
        self.pause()
        self.leave(link)


def watched_memory(run: LiveRun, begin: float, end: float) -> list[int]:
    """[KiB] several times a second, after the warm-up."""
    samples = []
    while time.monotonic() < end and run.is_alive():
        if time.monotonic() > begin + WARM_UP * (end - begin):
            samples.append(run.memory_KiB())
        time.sleep(0.1)
    return samples


def growth_of(samples: list[int]) -> int:
    """[KiB] from the first third to the last one, by their medians."""
    third = max(1, len(samples) // 3)
    return round(statistics.median(samples[-third:]) - statistics.median(samples[:third]))


def soak(run: LiveRun, arguments: argparse.Namespace) -> list[str]:
    begin = time.monotonic()
    end = begin + arguments.seconds
    faithful, reader = FaithfulViewer(run.port, TOKEN), Reader(run.port)
    crowd = [Visitor(run.port, Random(f"{arguments.seed}/{i}"), end)
             for i in range(arguments.clients)]
    threads = [threading.Thread(target=visitor.stay, daemon=True) for visitor in crowd]
    for thread in threads:
        thread.start()
    samples = watched_memory(run, begin, end)
    for thread in threads:
        thread.join(PATIENCE_S)
    faults = [] if run.is_alive() else ["the run has ended"]
    if not faults:
        with Viewer(run.port, TOKEN) as viewer:
            viewer.insist("stop")
    faults += run.faults() + faithful.faults()
    frames = len(run.lines())
    faults += reader.faults(frames)

    growth = growth_of(samples) if samples else 0
    allowed = 1024 * arguments.room_mib + KEPT_KiB * frames
    if growth > allowed:
        faults.append(f"memory grows by {growth} KiB, of {allowed:.0f} that it may")
    visits = sum((visitor.visits for visitor in crowd), Counter())
    if arguments.seconds >= 10 and len(set(visits) - {LET_GO}) < 5:
        faults.append("not all kinds of visitors came")
    counts = ", ".join(f"{name} {count}" for name, count in sorted(visits.items()))
    print(f"{frames} frames, {len(faithful.numbers)} to the faithful viewer; {counts}")
    print(f"memory {samples[-1] if samples else 0} KiB at the end, {growth:+d} after the warm-up")
    return faults


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER",
                        help="folder of the scripted components")
    parser.add_argument("--seed", type=int, default=22, help="of all draws (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=1800.0, help="(default: %(default)s)")
    parser.add_argument("--clients", type=int, default=50, help="(default: %(default)s)")
    parser.add_argument("--room-mib", type=int, default=32,
                        help="that memory may grow by (default: %(default)s)")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    print(f"seed {arguments.seed}, {arguments.clients} clients for {arguments.seconds:g} s")
    folder = Path(tempfile.mkdtemp(prefix="weft-live-soak-"))
    (folder / "pipeline.yaml").write_text(SCRIPTED.replace("SLEEP_MS", str(SLEEP_MS)))
    with LiveRun(arguments.weft, folder, ["pipeline.yaml"], arguments.plugin_path,
                 ["realtime=all"], TOKEN) as run:
        faults = soak(run, arguments)
    shutil.rmtree(folder, ignore_errors=True)
    print("\n".join(faults))
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
