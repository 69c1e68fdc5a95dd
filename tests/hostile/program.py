# SPDX-License-Identifier: Apache-2.0
"""Runs the program once and keeps what it answered: code, text, places of mistakes, time."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path

PLACE = re.compile(r"^(?P<file>[^\n:]+):(?P<line>\d+):(?P<column>\d+): (?P<message>.*)$", re.M)
SUGGESTION = re.compile(r"did you mean '([^']*)'\?")
# A program that runs longer hangs, even if sanitized and on a busy machine.
PATIENCE_S = 120.0
RAW = ("what()", "yaml-cpp", "std::", "cv::", "[json.exception", "OpenCV(", "terminate called",
       "bad_alloc", "basic_string", "vector::_M", "AddressSanitizer", "runtime error:")


@dataclass
class Mistake:
    """A line `FILE:LINE:COLUMN: message` of an answer."""

    file: str
    at: tuple[int, int]
    message: str

    @property
    def suggestion(self) -> str | None:
        found = SUGGESTION.search(self.message)
        return found.group(1) if found else None


@dataclass
class Answer:
    command: list[str]
    code: int  # negative: the signal that ended it
    out: str
    err: str
    ms: float  # wall-clock time
    hung: bool = False
    processor_ms: float = 0.0

    @property
    def text(self) -> str:
        return self.out + self.err

    def mistakes(self) -> list[Mistake]:
        return [Mistake(found["file"], (int(found["line"]), int(found["column"])), found["message"])
                for found in PLACE.finditer(self.err)]

    def dirt(self) -> str:
        """Why no user should have seen this answer; empty where it is clean."""
        if self.hung:
            return "hangs"
        if self.code < 0:
            return "killed by " + signal.Signals(-self.code).name
        for word in RAW:
            if word in self.text:
                return f"prints {word}"
        control = [c for c in self.text if (ord(c) < 32 and c not in "\n\t") or 127 <= ord(c) < 160]
        return f"prints the control character {ord(control[0]):#04x}" if control else ""


class Program:
    """The program under test and where its plugins are."""

    def __init__(self, weft: str, plugins: list[str], patience_s: float = PATIENCE_S) -> None:
        self.weft, self.patience_s = str(Path(weft).resolve()), patience_s
        self.options = [word for folder in plugins
                        for word in ("--plugin-path", str(Path(folder).resolve()))]

    def command(self, *arguments: str) -> list[str]:
        return [self.weft, *self.options, *arguments]

    def ask(self, folder: Path, *arguments: str) -> Answer:
        """Runs in the folder; a program that does not end is killed with all its children."""
        command = self.command(*arguments)
        start = time.monotonic()
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            child = subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL,
                                     stdout=out, stderr=err, start_new_session=True)
            hung = threading.Event()

            def end() -> None:
                hung.set()
                os.killpg(child.pid, signal.SIGKILL)

            patience = threading.Timer(self.patience_s, end)
            patience.start()
            _, status, usage = os.wait4(child.pid, 0)  # the child's own times, unlike wait()
            patience.cancel()
            child.returncode = os.waitstatus_to_exitcode(status)
            ms = 1000.0 * (time.monotonic() - start)
            texts = []
            for printed in (out, err):
                printed.seek(0)
                texts.append(printed.read().decode(errors="replace"))
        processor_ms = 1000.0 * (usage.ru_utime + usage.ru_stime)
        return Answer(command, child.returncode, *texts, ms, hung.is_set(), processor_ms)
