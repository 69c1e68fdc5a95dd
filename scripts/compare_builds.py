#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs the same pipelines and plans with two builds and compares what they write, byte by byte.

usage: scripts/compare_builds.py BEFORE AFTER [--work DIR] [--only NAME ...] [--pipelines-before DIR]

BEFORE and AFTER are build folders, with bin/weft and lib/weft/plugins. The pipelines and plans are
those of this checkout; BEFORE may run those of another folder, with the names of its time. The
comparison leaves out when, where and by which binaries a result was made: times, trace.json,
machines, build ids, hashes of programs and the keys made of them. Prints a line a file kind and job;
exits 1 where anything differs. A job whose data are absent ($WEFT_DATA) is skipped and listed.
"""

import argparse
import collections
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
FRAMES = 12
SHORT = ["--set", f"source.frames={FRAMES}"]

# name, verb, file, arguments
JOBS = [
    ("demo", "run", "demo.yaml", SHORT),
    ("sparse", "run", "sparse.yaml", SHORT),
    ("dense", "run", "dense.yaml", SHORT),
    ("tracked", "run", "tracked.yaml", SHORT),
    ("robusft", "run", "robusft.yaml", SHORT),
    ("robusft_plus", "run", "robusft_plus.yaml", SHORT),
    ("cloth", "run", "cloth.yaml", SHORT),
    ("cuts", "run", "cuts.yaml", [*SHORT, "--set", "source.cut_frames=[4, 7]",
                                  "--set", "source.invisible_frames=[3, 9]"]),
    ("self_occlusion", "run", "self_occlusion.yaml", SHORT),
    ("robusft_gpu", "run", "robusft_gpu.yaml", SHORT),
    ("kinect_paper", "run", "kinect_paper.yaml", []),
    ("first_look", "ablate", "ablations/first_look.yaml", []),
    ("match_sets", "ablate", "ablations/match_sets.yaml", []),
    ("fidelity", "ablate", "ablations/fidelity.yaml", []),
]
RECORDED = {"kinect_paper", "fidelity"}  # jobs that need $WEFT_DATA

# The content of any JSON that depends on the machine, the moment or the binaries.
VOLATILE = {"ms", "processor_ms", "machine", "build_id", "library", "libraries", "git", "timing",
            "check", "key", "rebuilt_key", "group", "command", "run", "files"}


REVISION = re.compile(r" \([0-9a-f]{12,40}(\+changes)?\)")  # behind the version, in reports


def without_volatile(value):
    if isinstance(value, dict):
        return {k: without_volatile(v) for k, v in value.items() if k not in VOLATILE}
    if isinstance(value, list):
        return [without_volatile(v) for v in value]
    return value


def canonical(text):
    """JSON, or lines of it, as text without what is volatile."""
    try:
        return json.dumps(without_volatile(json.loads(text)))
    except json.JSONDecodeError:
        return "\n".join(json.dumps(without_volatile(json.loads(line)))
                         for line in text.splitlines() if line)


class Side:
    """One of the two builds and the folder in which its jobs write."""

    def __init__(self, build, folder, pipelines):
        self.pipelines = pipelines
        self.program = build / "bin" / "weft"
        self.plugins = build / "lib" / "weft" / "plugins"
        self.folder = folder
        folder.mkdir(parents=True)

    def weft(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True,
                              env={**os.environ, "WEFT_PLUGIN_PATH": str(self.plugins)})
        return done.returncode, self.neutral(done.stdout), self.neutral(done.stderr)

    def neutral(self, text):
        """Without this side's folders, and without times."""
        for folder, name in ((self.folder, "OUT"), (self.plugins, "PLUGINS"),
                             (self.pipelines, "PIPELINES"),
                             (self.program.parent, "BIN")):
            text = text.replace(str(folder), name)
        return re.sub(r"\d+(\.\d+)? (ms|s|fps)\b", r"TIME \2", text)

    def job(self, name, verb, file, arguments):
        """Runs it; all that is to be compared, by name."""
        out = self.folder / name
        code, text, errors = self.weft(verb, self.pipelines / file, "--out", out, "--quiet",
                                       *arguments)
        found = {"exit code": str(code), "messages": text + errors}
        if verb == "run":
            code, text, errors = self.weft("eval", out, "--csv", out / "frames.csv", "--frames")
            found["table of weft eval"] = f"{code}\n{text}{errors}"
            found.update(self.run_folder(out))
        else:
            code, text, errors = self.weft("report", out)
            found["messages of weft report"] = f"{code}\n{text}{errors}"
            found.update(self.results_folder(out))
        return found

    def run_folder(self, out):
        found = {}
        for file in sorted(p for p in out.rglob("*") if p.is_file()):
            if file.name == "trace.json":
                continue
            kind = f"*{file.suffix} of {file.parent.relative_to(out)}/" if file.parent != out \
                else file.name
            found.setdefault(kind, []).append(self.content(file))
        return {kind: "\n".join(parts) for kind, parts in found.items()}

    def content(self, file):
        data = file.read_bytes()
        if file.suffix in (".json", ".jsonl"):
            return self.neutral(canonical(data.decode()))
        if file.suffix in (".yaml", ".csv", ".txt"):
            return self.neutral(data.decode())
        return hashlib.sha256(data).hexdigest()

    def results_folder(self, out):
        """By cell of the plan, since keys are made of the binaries."""
        plan = json.loads((out / "plan.json").read_text())
        lines = {}
        for file in sorted((out / "results").glob("*.jsonl")):
            for line in file.read_text().splitlines():
                lines[json.loads(line)["key"]] = line
        found = collections.defaultdict(list)
        for cell in plan["cells"]:
            line = lines.get(cell["key"])
            found["cells' lines"].append(canonical(line) if line else "none")
            for file in sorted((out / "cells" / cell["key"]).glob("*")):
                found[f"cells' *{file.suffix}"].append(self.content(file))
        found["plan.json"] = [self.neutral(canonical(json.dumps(plan)))]
        page = REVISION.sub("", (out / "report.html").read_text())
        for key in sorted(lines, key=len, reverse=True):
            page = page.replace(key, "KEY")
        found["report.html"] = [self.neutral(page)]
        return {kind: "\n".join(parts) for kind, parts in found.items()}


def first_difference(one, two):
    for number, (a, b) in enumerate(zip(one.splitlines(), two.splitlines()), 1):
        if a != b:
            at = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
            start = max(0, at - 60)
            return f"line {number}: ...{a[start:at + 60]!r} / ...{b[start:at + 60]!r}"
    return "one ends before the other"


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n")[1])
    parser.add_argument("before", type=pathlib.Path)
    parser.add_argument("after", type=pathlib.Path)
    parser.add_argument("--work", type=pathlib.Path)
    parser.add_argument("--only", nargs="*")
    parser.add_argument("--pipelines-before", type=pathlib.Path, default=ROOT / "pipelines")
    options = parser.parse_args()
    work = options.work or pathlib.Path(tempfile.mkdtemp(prefix="weft-compare-"))
    # Folders of names of one length: some formats pad to a multiple of bytes.
    sides = [Side(options.before.resolve(), work / "1" / "out", options.pipelines_before.resolve()),
             Side(options.after.resolve(), work / "2" / "out", ROOT / "pipelines")]
    differing = 0
    for name, verb, file, arguments in JOBS:
        if options.only and name not in options.only:
            continue
        if name in RECORDED and not os.environ.get("WEFT_DATA"):
            print(f"{name:15} skipped: WEFT_DATA is not set")
            continue
        before, after = (side.job(name, verb, file, arguments) for side in sides)
        for kind in sorted({*before, *after}):
            one, two = before.get(kind), after.get(kind)
            if one == two:
                digest = hashlib.sha256(one.encode()).hexdigest()[:16]
                print(f"{name:15} {kind:28} same, {len(one)} characters, {digest}")
            else:
                differing += 1
                what = "only in one" if one is None or two is None else first_difference(one, two)
                print(f"{name:15} {kind:28} DIFFERS: {what}")
        sys.stdout.flush()
    if options.work is None:
        shutil.rmtree(work)
    print("everything is the same" if differing == 0 else f"{differing} differ")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
