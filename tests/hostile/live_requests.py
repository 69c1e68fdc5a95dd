#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sends wrong requests to the live view of a run, which must go on, lose no frame and serve others.

Exits 1 if an answer is another one than that of the mistake, and prints the command that repeats it.
"""

from __future__ import annotations

import argparse
import http.client
import re
import shutil
import socket
import struct
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from random import Random

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))

from live_attacks import GONE, Attack, Attacks
from live_client import PATIENCE_S, SCRIPTED, FaithfulViewer, LiveRun, Viewer

TOKEN = "a-token-of-sixteen-or-more"
SLEEP_MS = 20  # that each frame takes at least
AT_ONCE = 8  # far below the clients that the server takes
CHECKED_EVERY = 500
HALF_OPEN = 140  # more than the server has room for


def answer_in(data: bytes) -> int:
    """The status or the code in what a client was sent; ValueError where it is no answer."""
    if not data:
        return GONE
    head, _, rest = data.partition(b"\r\n\r\n")
    found = re.match(rb"HTTP/1\.1 ([1-5]\d\d) ", head)
    if not found:
        raise ValueError(f"no answer of HTTP: {data[:80]!r}")
    return code_in(rest) if found[1] == b"101" else int(found[1])


def code_in(data: bytes) -> int:
    """With which the WebSocket is closed at the end of these bytes; a last frame may be cut off."""
    at, code = 0, GONE
    while at + 2 <= len(data):
        first, size = data[at], data[at + 1]
        if first not in (0x81, 0x82, 0x88, 0x89, 0x8A) or size & 0x80 or code != GONE:
            raise ValueError(f"no frame of a server: {data[at:at + 80]!r}")
        form = {126: 2, 127: 8}.get(size, 0)
        if form:
            size = int.from_bytes(data[at + 2:at + 2 + form], "big")
        payload = data[at + 2 + form:at + 2 + form + size]
        if len(payload) == size and first == 0x88:
            code = int.from_bytes(payload[:2], "big") if payload else 1005
        at += 2 + form + size
    return code


def received(link: socket.socket, end: bytes = b"") -> bytes:
    """What comes until the server closes, or up to `end`."""
    data = bytearray()
    try:
        while not (end and end in data) and (got := link.recv(1 << 16)):
            data += got
    except ConnectionError:
        pass
    return bytes(data)


def send(link: socket.socket, data: bytes, is_last: bool) -> None:
    """The server may have closed before."""
    try:
        link.sendall(data)
        if is_last:
            link.shutdown(socket.SHUT_WR)
    except TimeoutError:
        raise
    except OSError:
        pass


def converse(port: int, attack: Attack, number: int) -> bytes:
    """What the server answers. Of one address alone a machine soon has no more ports."""
    with socket.socket() as link:
        link.settimeout(PATIENCE_S)
        link.bind((f"127.0.0.{2 + number % 250}", 0))
        link.connect(("127.0.0.1", port))
        has_more = bool(attack.then)
        send(link, attack.first, is_last=not has_more and not attack.is_rude)
        answer = received(link, b"\r\n\r\n") if has_more else b""
        if has_more:
            is_open = answer.startswith(b"HTTP/1.1 101 ")
            send(link, attack.then if is_open else b"", is_last=not attack.is_rude)
        if attack.is_rude:
            link.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            return b""
        return answer + received(link)


class Session:
    """The attacks on one run, and what became of them."""

    def __init__(self, run: LiveRun, seed: int) -> None:
        self.run, self.seed = run, seed
        self.attacks = Attacks(run.port, TOKEN)
        self.sent: Counter[str] = Counter()
        self.right: Counter[str] = Counter()

    def one(self, number: int) -> tuple[str, str]:
        """The kind of that attack, and what is wrong with its answer; "" where it is right."""
        attack = self.attacks.attack(Random(f"{self.seed}/{number}"))
        try:
            answer = answer_in(converse(self.run.port, attack, number))
        except (OSError, ValueError) as failure:
            return attack.kind, repr(failure)
        if not attack.expected or answer in attack.expected:
            return attack.kind, ""
        wanted = " or ".join(map(str, attack.expected))
        return attack.kind, f"answers {answer}, not {wanted}: {(attack.first, attack.then)!r}"

    def half_open(self, number: int) -> socket.socket:
        """A connection whose request is never complete."""
        link = socket.socket()
        link.settimeout(PATIENCE_S)
        link.bind((f"127.0.1.{2 + number % 250}", 0))
        link.connect(("127.0.0.1", self.run.port))
        send(link, b"GET /ws HTTP/1.1\r\nHost: 127.0"[:number % 30], is_last=False)
        return link

    def check_others(self, faithful: FaithfulViewer) -> list[str]:
        """Whether right requests are answered as before."""
        if not self.run.is_alive():
            return ["the run has ended"]
        found = [] if faithful.goes_on() else ["the faithful viewer gets no more frames"]
        half_open = [self.half_open(i) for i in range(HALF_OPEN)]
        try:
            asked = http.client.HTTPConnection("127.0.0.1", self.run.port, timeout=PATIENCE_S)
            asked.request("GET", f"/?token={TOKEN}")
            if b"<html" not in asked.getresponse().read():
                found.append("the page is none")
            asked.close()
            with Viewer(self.run.port, TOKEN) as viewer:
                refusal = viewer.insist("dance")
                if "no run accepts 'dance'" not in refusal:
                    found.append(f"a change request is answered by: {refusal}")
                if refusal := viewer.insist("pause"):
                    found.append(f"a pause is refused: {refusal}")
        except Exception as failure:  # whatever it is, a right request has failed
            found.append(f"a right request fails: {failure!r}")
        for link in half_open:
            link.close()
        if not faithful.goes_on():
            found.append("the run stays paused, although the client that paused it has left")
        return found

    def attack(self, numbers: list[int], again: str) -> list[str]:
        """All of them; what was wrong. `again` and a number is the command that repeats one."""
        faults: list[str] = []
        faithful = FaithfulViewer(self.run.port, TOKEN)
        with ThreadPoolExecutor(AT_ONCE) as pool:
            for start in range(0, len(numbers), CHECKED_EVERY):
                some = numbers[start:start + CHECKED_EVERY]
                for number, (kind, fault) in zip(some, pool.map(self.one, some)):
                    self.sent[kind] += 1
                    self.right[kind] += not fault
                    if fault and self.sent[kind] - self.right[kind] < 4:
                        print(f"{again} --only {number}  # {kind}\n    {fault[:600]}")
                if broken := self.check_others(faithful):
                    faults += [f"after {start + len(some)} requests: {fault}" for fault in broken]
                    break
        if self.run.is_alive():
            with Viewer(self.run.port, TOKEN) as viewer:
                if refusal := viewer.insist("stop"):
                    faults.append(f"to stop is refused: {refusal}")
        return faults + self.run.faults() + faithful.faults()


def arguments_of(words: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--weft", required=True, metavar="FILE", help="the program")
    parser.add_argument("--plugin-path", action="append", default=[], metavar="FOLDER",
                        help="folder of the scripted components")
    parser.add_argument("--seed", type=int, default=20, help="of all draws (default: %(default)s)")
    parser.add_argument("--count", type=int, default=2000, help="requests (default: %(default)s)")
    parser.add_argument("--only", type=int, metavar="I", help="this one alone")
    return parser.parse_args(words)


def main(words: list[str]) -> int:
    arguments = arguments_of(words)
    numbers = list(range(arguments.count)) if arguments.only is None else [arguments.only]
    print(f"seed {arguments.seed}, {len(numbers)} requests")
    paths = " ".join(f"--plugin-path {folder}" for folder in arguments.plugin_path)
    again = f"{sys.argv[0]} --weft {arguments.weft} {paths} --seed {arguments.seed}"
    folder = Path(tempfile.mkdtemp(prefix="weft-live-requests-"))
    (folder / "pipeline.yaml").write_text(SCRIPTED.replace("SLEEP_MS", str(SLEEP_MS)))
    with LiveRun(arguments.weft, folder, ["pipeline.yaml"], arguments.plugin_path,
                 ["realtime=all"], TOKEN) as run:
        session = Session(run, arguments.seed)
        faults = session.attack(numbers, again)
        frames = len(run.lines())
    shutil.rmtree(folder, ignore_errors=True)
    print("\n".join(faults))
    for kind, sent in sorted(session.sent.items()):
        print(f"{kind:<18}{sent:>8}{session.right[kind]:>8}")
    sent, right = session.sent.total(), session.right.total()
    print(f"{'all':<18}{sent:>8}{right:>8}, {frames} frames meanwhile")
    return 0 if sent == right == len(numbers) and not faults else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
