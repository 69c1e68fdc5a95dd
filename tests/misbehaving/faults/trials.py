# SPDX-License-Identifier: Apache-2.0
"""Folders with one faulty library each, and what runs the program over them."""

from __future__ import annotations

import json
import os
import re
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

LIBRARY = "filters_test_faulty.so"
MANIFEST = "filters_test_faulty.plugin.yaml"
ID = "filters/test_faulty"
# Longer than any answer takes, sanitized and on a machine that has much else to do.
PATIENCE_S = 300.0
ROLES = ("detectors", "matchers", "filters", "warps", "passes", "solvers")
ALL_GOOD = "estimated estimated estimated estimated"
ONE_LOST = "estimated predicted estimated estimated"


@dataclass
class Ask:
    """A command of the program, and what its answer must be."""

    command: str
    says: str  # a regular expression, found in the answer
    code: object = 0  # the exit code, or those that it may be; "fails": any but 0
    frames: str = ""  # the states in the run folder; empty: any
    verdict: str = "refused"
    never: str = ""  # a regular expression that must not be found


@dataclass
class Case:
    name: str
    asks: list[Ask]
    make: Callable[[Sandbox], None] | None = None  # changes the files of its folder
    limit_bytes: int = 0  # limit of private memory
    sanitized: bool = True  # True if a sanitized program can run it


@dataclass
class Answer:
    code: int  # negative: the signal that ended it; None: it had to be killed
    text: str
    frames: str = ""


@dataclass
class Libraries:
    weft: str
    faulty: Path  # folder of the libraries as they were built
    scripted: str  # folder of well-behaved plugins of all roles
    work: Path  # folder of the sandboxes
    doctor: list[dict] = field(default_factory=list)  # its refusals, for all sandboxes at once

    @property
    def manifest(self) -> str:
        """Of the library that makes no fault."""
        return (self.faulty / MANIFEST).read_text(encoding="utf-8", errors="strict")

    def run(self, words: list[str], fault: str = "", limit_bytes: int = 0,
            interrupted: bool = False) -> Answer:
        def bound() -> None:
            if limit_bytes:
                resource.setrlimit(resource.RLIMIT_DATA, (limit_bytes, limit_bytes))

        # Leaks do not matter here; names of functions would take longer than a deadline.
        environment = {**os.environ, "WEFT_FAULT": fault, "WEFT_PLUGIN_PATH": "",
                       "ASAN_OPTIONS": os.environ.get("ASAN_OPTIONS", "") + ":detect_leaks=0:symbolize=0"}
        child = subprocess.Popen([self.weft, *words], stdin=subprocess.DEVNULL, env=environment,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=bound,
                                 start_new_session=True)
        slept = b""
        while interrupted and not slept.endswith(b"asleep\n"):
            slept += child.stderr.readline() or b"asleep\n"  # nothing comes once it has ended
        while interrupted and child.poll() is None:
            child.send_signal(signal.SIGINT)
            time.sleep(0.1)
        try:
            out, err = child.communicate(timeout=PATIENCE_S)
            code = child.returncode
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)
            out, err = child.communicate()
            code = None
        return Answer(code, (out + err).decode("utf-8", "replace"))


@dataclass
class Sandbox:
    """A folder with the library, its manifest, and a pipeline that uses it."""

    libraries: Libraries
    case: Case
    folder: Path = Path()

    def __post_init__(self) -> None:
        self.folder = self.libraries.work / self.case.name
        self.folder.mkdir()
        shutil.copy(self.libraries.faulty / LIBRARY, self.folder)
        self.write_manifest(self.libraries.manifest)
        stages = "".join(f"  - {{use: {ID if role == 'filters' else role + '/test.scripted'}}}\n"
                         for role in ROLES)
        (self.folder / "pipeline.yaml").write_text(
            "weft: 1\nsource: {use: sources/test.scripted, params: {frames: 4}}\n"
            f"template: {{use: templates/test.scripted}}\nstages:\n{stages}"
            "sinks:\n  - {use: sinks/test.scripted}\n")
        if self.case.make:
            self.case.make(self)

    @property
    def library(self) -> Path:
        return self.folder / LIBRARY

    @property
    def manifest(self) -> Path:
        return self.folder / MANIFEST

    def write_manifest(self, text: str) -> None:
        self.manifest.write_text(text)

    def edit_manifest(self, before: str, after: str) -> None:
        assert before in self.libraries.manifest, before
        self.write_manifest(self.libraries.manifest.replace(before, after, 1))

    def replace_library(self, name: str) -> None:
        """Puts another library in the place of this one, and its build-id into the manifest."""
        built = self.libraries.faulty / name
        shutil.copy(built, self.library)
        self.write_manifest(bound_to(built, self.libraries.manifest))

    def try_command(self, ask: Ask) -> Answer:
        if ask.command == "doctor":
            said = [f"{each['cause']}; {each['fix']}" for each in self.libraries.doctor
                    if each["file"].startswith(f"{self.folder}/")]
            return Answer(0, "\n".join(said))
        plugins = ["--plugin-path", self.libraries.scripted, "--plugin-path", str(self.folder)]
        pipeline = str(self.folder / "pipeline.yaml")
        out = self.folder / ask.command.replace(" ", "_")
        run = ["run", pipeline, "--out", str(out), "--isolate", "none"]
        isolated = ["--set", "filters.isolate=process", "--set", "filters.deadline_ms=1000"]
        words = {"list": ["plugins", "list"],
                 "why": ["plugins", "why", ID],
                 "devices": ["doctor"],
                 "describe": ["plugins", "describe", str(self.library)],
                 "check": ["check", pipeline],
                 "run": run,
                 "interrupted": run,
                 "isolated": [*run, *isolated]}[ask.command]
        answer = self.libraries.run([*plugins, *words], self.case.name, self.case.limit_bytes,
                              ask.command == "interrupted")
        if out.is_dir():
            answer.frames = states(out / "frames.jsonl")
        return answer


def bound_to(library: Path, manifest: str) -> str:
    """The manifest with the build-id of a library: the ELF note of type 3 by "GNU"."""
    content = library.read_bytes()
    at = content.find(b"\x14\0\0\0\x03\0\0\0GNU\0")
    build_id = content[at + 12:at + 32].hex() if at >= 0 else ""
    return re.sub(r'build_id: "\w*"', f'build_id: "{build_id}"', manifest)


def states(frames: Path) -> str:
    if not frames.exists():
        return ""
    lines = frames.read_text(encoding="utf-8", errors="strict").splitlines()
    return " ".join(json.loads(line)["state"] for line in lines)


def line_of(sandbox: Sandbox, ask: Ask, answer: Answer) -> str:
    """The sentence that an answer is about, without paths that change from run to run."""
    text = answer.text.replace(str(sandbox.folder), "SANDBOX").replace(sandbox.libraries.weft, "weft")
    found = re.search(ask.says, text, re.S)
    if not found:
        return text.strip().replace("\n", " / ")[-300:]
    start = text.rfind("\n", 0, found.start()) + 1
    end = text.find("\n", found.end())
    return re.sub(r"\s*\n\s*", " / ", text[start:end if end >= 0 else None].strip())


def fault_of(ask: Ask, answer: Answer) -> str:
    """What is wrong with an answer; empty where nothing is."""
    if answer.code is None:
        return f"no answer within {PATIENCE_S:.0f} s"
    if ask.code == "fails":
        if answer.code == 0:
            return "exit code 0"
    elif answer.code not in (ask.code if isinstance(ask.code, tuple) else (ask.code,)):
        return f"exit code {answer.code} where {ask.code} is expected"
    if not re.search(ask.says, answer.text, re.S):
        return f"does not say '{ask.says}'"
    if ask.never and re.search(ask.never, answer.text):
        return f"says '{ask.never}'"
    if ask.frames and answer.frames != ask.frames:
        return f"frames are '{answer.frames}'"
    return ""
