# SPDX-License-Identifier: Apache-2.0
"""A run of `weft live` and clients of its WebSocket, as another program sees them."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import threading
import time
from pathlib import Path

PATIENCE_S = 120.0
MASK = b"\x37\xfa\x21\x3d"  # any will do
# Texts that no correct program prints.
DIRT = ("Sanitizer", "runtime error:", "terminate called", "Assertion", "what():", "out of memory")
SCRIPTED = """\
weft: 1
source: {use: sources/test.scripted, params: {frames: 1000000, sleep_ms: SLEEP_MS}}
template: {use: templates/test.scripted}
stages:
  - {use: detectors/test.scripted}
  - {use: matchers/test.scripted}
  - {use: filters/test.scripted}
  - {use: warps/test.scripted}
  - {use: passes/test.scripted}
  - {use: solvers/test.scripted}
"""


class Closed(Exception):
    """The server has closed: with this code and reason, or with 0 and what stands in their place."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"closed with {code}: {reason}")
        self.code, self.reason = code, reason


def xored(payload: bytes, mask: bytes) -> bytes:
    size = len(payload)
    whole = (mask * (size // 4 + 1))[:size]
    return (int.from_bytes(payload, "big") ^ int.from_bytes(whole, "big")).to_bytes(size, "big")


def masked(first: int, payload: bytes, mask: bytes = MASK) -> bytes:
    """A frame as clients send it; its first byte has the opcode and what is set beside that."""
    size = len(payload)
    if size < 126:
        head = bytes([first, 0x80 | size])
    elif size < 65536:
        head = bytes([first, 0x80 | 126]) + size.to_bytes(2, "big")
    else:
        head = bytes([first, 0x80 | 127]) + size.to_bytes(8, "big")
    return head + mask + xored(payload, mask)


def upgrade_request(port: int, token: str = "", protocol: str = "weft.live.1") -> bytes:
    query = f"?token={token}" if token else ""
    return (f"GET /ws{query} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nUpgrade: websocket\r\n"
            "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: MDEyMzQ1Njc4OWFiY2RlZg==\r\n"
            f"Sec-WebSocket-Protocol: {protocol}\r\n\r\n").encode()


def head_of(message: bytes) -> dict:
    """The JSON of a frame."""
    if message[:4] != b"WFL1":
        raise ValueError(f"no frame: {message[:20]!r}")
    size = int.from_bytes(message[4:8], "little")
    return json.loads(message[8:8 + size])


class Viewer:
    """A client of weft.live.1. What does not come in time is a TimeoutError."""

    def __init__(self, port: int, token: str = "", patience_s: float = PATIENCE_S) -> None:
        self.link = socket.create_connection(("127.0.0.1", port), timeout=patience_s)
        self.link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.unread = bytearray()
        self.requests = 0
        try:
            self.link.sendall(upgrade_request(port, token))
            while b"\r\n\r\n" not in self.unread:
                self._receive()
            head, _, self.unread = self.unread.partition(b"\r\n\r\n")
            if not head.startswith(b"HTTP/1.1 101 "):
                raise Closed(0, head.decode(errors="replace").split("\r\n")[0])
            self.hello = self.read()
        except BaseException:
            self.link.close()
            raise

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.link.close()

    def _receive(self) -> None:
        got = self.link.recv(1 << 16)
        if not got:
            raise Closed(0, "without a word")
        self.unread += got

    def _take(self, count: int) -> bytes:
        while len(self.unread) < count:
            self._receive()
        taken = bytes(self.unread[:count])
        del self.unread[:count]
        return taken

    def read(self) -> dict | bytes:
        """The next message: of a text its JSON, of others the bytes."""
        while True:
            first, size = self._take(2)
            if size >= 126:
                size = int.from_bytes(self._take(2 if size == 126 else 8), "big")
            payload = self._take(size)
            opcode = first & 15
            if opcode == 9:
                self.link.sendall(masked(0x8A, payload))
            elif opcode == 8:
                raise Closed(int.from_bytes(payload[:2], "big"), payload[2:].decode())
            elif opcode == 1:
                return json.loads(payload)
            elif opcode == 2:
                return payload

    def say(self, **message: object) -> None:
        self.link.sendall(masked(0x81, json.dumps(message).encode()))

    def frame(self) -> dict:
        """Asks for a frame, and gives the head of the one that comes."""
        self.say(type="ready")
        while isinstance(message := self.read(), dict):
            pass  # settings that have changed
        return head_of(message)

    def settings(self) -> dict:
        """Those of the hello, or the first ones after it: a run that begins has none yet."""
        settings = self.hello["settings"]
        while settings is None:
            message = self.read()
            if isinstance(message, dict) and message["type"] == "settings":
                settings = message["settings"]
        return settings

    def insist(self, text: str) -> str:
        """Requests until the run has room for it; why it refuses, or nothing."""
        end = time.monotonic() + PATIENCE_S
        while "send again" in (refusal := self.request(text)["refusal"]) and time.monotonic() < end:
            time.sleep(0.02)
        return refusal

    def request(self, text: str) -> dict:
        """Sends a change request, and gives the answer."""
        self.requests += 1
        self.say(type="change_request", number=self.requests, text=text)
        while True:
            message = self.read()
            if isinstance(message, dict) and message.get("number") == self.requests:
                return message


class FaithfulViewer(threading.Thread):
    """Takes every frame that it can get, until the run ends."""

    def __init__(self, port: int, token: str = "") -> None:
        super().__init__(daemon=True)
        self.viewer = Viewer(port, token)
        self.numbers: list[int] = []
        self.code, self.failure = 0, ""
        self.start()

    def run(self) -> None:
        try:
            while True:
                self.numbers.append(self.viewer.frame()["frame"])
        except Closed as end:
            self.code = end.code
        except ConnectionError:
            pass  # a server that ends waits for no client very long
        except (OSError, ValueError) as failure:
            self.failure = repr(failure)

    def goes_on(self) -> bool:
        """Whether more frames come."""
        before, end = len(self.numbers), time.monotonic() + PATIENCE_S
        while self.is_alive() and time.monotonic() < end:
            if len(self.numbers) > before + 1:
                return True
            time.sleep(0.002)
        return False

    def faults(self) -> list[str]:
        """Once the run has ended."""
        self.join(PATIENCE_S)
        found = [f"the faithful viewer: {self.failure}"] if self.failure else []
        if self.is_alive() or self.code not in (0, 1001):  # going away
            found.append(f"the faithful viewer is told {self.code}, not that the run has ended")
        if not self.numbers or self.numbers != sorted(set(self.numbers)):
            found.append("the faithful viewer gets no frames, or not in their order")
        return found


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class LiveRun:
    """`weft live` in a folder; use as a context. `words`: the pipeline, or --demo, and options."""

    def __init__(self, weft: str, folder: Path, words: list[str], plugins: list[str] = (),
                 settings: list[str] = (), token: str = "") -> None:
        self.weft, self.folder = str(Path(weft).resolve()), folder
        paths = [word for path in plugins for word in ("--plugin-path", str(Path(path).resolve()))]
        for attempt in range(3):  # another program may take the port in between
            self.port, self.out = free_port(), folder / f"run-{attempt}"
            chosen = [f"live.address=127.0.0.1:{self.port}", *settings]
            chosen += [f"live.token={token}"] if token else []
            self.command = [self.weft, *paths, "live", *words, "--no-browser", "--out",
                            str(self.out), *(w for one in chosen for w in ("--set", one))]
            if self._starts():
                return
        raise RuntimeError(f"weft live does not start: {self.words()}")

    def _starts(self) -> bool:
        # A sanitizer keeps freed memory for a while; this limits it, so that memory can be judged.
        options = os.environ.get("ASAN_OPTIONS", "") + ":quarantine_size_mb=16"
        self.child = subprocess.Popen(
            self.command, cwd=self.folder, stdin=subprocess.DEVNULL,
            stdout=open(self.folder / "out.txt", "wb"), stderr=open(self.folder / "err.txt", "wb"),
            env=os.environ | {"ASAN_OPTIONS": options.lstrip(":")})
        end = time.monotonic() + PATIENCE_S
        while self.is_alive() and time.monotonic() < end:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=1.0).close()
                return True
            except OSError:
                time.sleep(0.02)
        self._kill()
        return False

    def __enter__(self) -> LiveRun:
        return self

    def __exit__(self, *_: object) -> None:
        self._kill()

    def _kill(self) -> None:
        if self.is_alive():
            self.child.kill()
        self.child.wait()

    def is_alive(self) -> bool:
        return self.child.poll() is None

    def interrupt(self) -> int:
        """As a terminal does; the code with which the program ends."""
        self.child.send_signal(signal.SIGINT)
        return self.child.wait(PATIENCE_S)

    def words(self) -> str:
        return "".join((self.folder / name).read_bytes().decode(errors="replace")
                       for name in ("out.txt", "err.txt"))

    def memory_KiB(self) -> int:
        """Of its own, that is in use."""
        for line in Path(f"/proc/{self.child.pid}/status").read_text().splitlines():
            if line.startswith("RssAnon:"):
                return int(line.split()[1])
        raise ValueError("no RssAnon")

    def lines(self) -> list[dict]:
        """A line for each frame that was finished."""
        return [json.loads(line) for line in (self.out / "frames.jsonl").read_text().splitlines()]

    def faults(self) -> list[str]:
        """What is wrong once it was told to stop."""
        try:
            code = self.child.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            return ["the run does not end"]
        words = self.words()
        found = [f"exit {code}: {words[-2000:]}"] if code != 0 else []
        found += [f"prints {dirt}: {words[-4000:]}" for dirt in DIRT if dirt in words]
        lines = self.lines()
        if not lines or [line["frame"] for line in lines] != list(range(len(lines))):
            found.append(f"frames are lost: {len(lines)} are there, up to number "
                         f"{lines[-1]['frame'] if lines else None}")
        for line in lines:
            statuses = {stage["stage"]: stage["status"] for stage in line["stages"]}
            if line["failed"] or statuses.get("live") != "ok":
                found.append(f"frame {line['frame']} has failed: {statuses}")
                break
        return found
