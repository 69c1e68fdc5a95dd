#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Builds one plugin with several compilers and flags, and compares what it computes in this host.

    tests/abi/pairings/pairings.py --build build/release
    tests/abi/pairings/pairings.py --build build/release --quick

Prints a table in Markdown: a line for each compiler, a column for each mode. What GCC builds with
-O2 is what the others are compared with, in the sense of "Reproducible": of the same library the same
bytes, in the host's process and in one of its own; of another one masks that are equal but for
matches within 1e-6 px of the limit, and shapes within 1e-3 mm. A library that cannot be in this host
must be refused in a sentence, by each command, and what the sentence says to do must help. What a
compiler calls native may exceed what a virtual machine grants: such a library must be refused for
features that the processor does lack. Exits 1 where a pairing does none of these.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
LIBRARY = "filters_paired.affine.so"
FRAMES = 4
SKIPPED = 77  # the exit status that CTest takes for it
WITHIN_PX, WITHIN_MM = 1e-6, 1e-3

COMPILERS = {"g++": ["g++"], "clang++": ["clang++", "-stdlib=libstdc++"],
             "clang++, libc++": ["clang++", "-stdlib=libc++"]}
MODES = {"-O0": ["-O0"], "-O2": ["-O2"], "-O3": ["-O3"], "-O3 -march=native": ["-O3", "-march=native"],
         "-fsanitize=address": ["-O1", "-fsanitize=address"],
         "-fsanitize=undefined": ["-O1", "-fsanitize=undefined"],
         "-fsanitize=thread": ["-O1", "-fsanitize=thread"],
         "-D_GLIBCXX_DEBUG": ["-O1", "-D_GLIBCXX_DEBUG"]}
REFERENCE = ("g++", "-O2")
QUICK = [("clang++, libc++", "-O3 -march=native"), ("g++", "-fsanitize=address")]

PIPELINE = """weft: 1
source:
  use: sources/match_trials
  params: {{trials: {frames}, matches: 120, correct_rate: 0.9, noise_px: 0.5, seed: 3}}
template:
  use: templates/rectangular
  params:
    {{texture: {texture}, width_m: 0.297, height_m: 0.178, columns: 10, rows: 6}}
stages:
  - {{use: filters/paired.affine, isolate: {isolate}}}
  - {{use: solvers/paired.rigid, isolate: {isolate}}}
"""


class Wrong(Exception):
    """What a pairing did that is neither the same result nor a refusal."""


class Lacking(Exception):
    """The sentence of a library that was refused for features that the processor lacks."""


@dataclass
class Host:
    build: Path
    work: Path

    def ask(self, *words: str, preload: str = "") -> tuple[int, str]:
        environment = dict(os.environ, ASAN_OPTIONS="detect_leaks=0")
        environment.pop("WEFT_PLUGIN_PATH", None)
        if preload:
            environment["LD_PRELOAD"] = preload
        done = subprocess.run([str(self.build / "bin/weft"), *words], env=environment, text=True,
                              capture_output=True, check=False)
        return done.returncode, done.stdout + done.stderr

    def pipeline(self, isolate: str) -> str:
        return str(self.work / f"{isolate}.yaml")

    def write_pipelines(self) -> None:
        texture = ROOT / "pipelines/data/plain_sheet.png"
        for isolate in ("none", "process"):
            Path(self.pipeline(isolate)).write_text(
                PIPELINE.format(frames=FRAMES, texture=texture, isolate=isolate))


def build(host: Host, pairing: tuple[str, str]) -> Path:
    """Compiles the plugin as one without CMake does; its folder."""
    compiler, mode = pairing
    folder = host.work / re.sub(r"\W+", "_", f"{compiler} {mode}")
    folder.mkdir()
    flags = subprocess.run(["pkg-config", "--cflags", "weft", "eigen3"], text=True, check=True,
                           env=dict(os.environ, PKG_CONFIG_PATH=str(host.build)),
                           capture_output=True).stdout.split()
    command = [*COMPILERS[compiler], "-std=c++20", *MODES[mode], "-fPIC", "-fvisibility=hidden",
               "-shared", "-Wl,--build-id=sha1",
               f"-Wl,--version-script={ROOT}/framework/cmake/weft_plugin.map", *flags,
               str(HERE / "paired.cpp"), "-o", str(folder / LIBRARY)]
    done = subprocess.run(command, text=True, capture_output=True, check=False)
    if done.returncode != 0:
        raise Wrong(f"does not compile: {' '.join(command)}\n{done.stderr[-2000:]}")
    return folder


def refusal(text: str) -> str:
    """The sentence of a library that was refused, or empty."""
    found = re.search(r"it (is built with \w+Sanitizer, .*)", text)
    return found.group(1) if found else ""


def lacking(text: str) -> str:
    """The sentence of a library that needs features, if the processor has none of them."""
    found = re.search(r"it (needs processor features that this machine lacks: ([\w. ]+?)) *\(", text)
    if not found:
        return ""
    flags = re.search(r"^flags\s*:(.*)$", Path("/proc/cpuinfo").read_text(), re.MULTILINE)
    there = set(flags.group(1).split()) if flags else set()
    if "abm" in there:  # Linux calls it by the name of AMD
        there.add("lzcnt")
    wrongly = there & set(found.group(2).split())
    if wrongly:
        raise Wrong(f"refused for features that this machine has, {sorted(wrongly)}: {text}")
    return found.group(1)


def run(host: Host, folder: Path, isolate: str, preload: str) -> dict[str, np.ndarray]:
    """All arrays that filter and solver answered, by frame and name."""
    out = folder / f"{isolate}_run"
    code, text = host.ask("--plugin-path", str(folder), "run", host.pipeline(isolate), "--out",
                          str(out), "--dump", "filters", "--dump", "solvers", "--quiet",
                          preload=preload)
    if code == 2 and (sentence := lacking(text)):
        raise Lacking(sentence)
    if code != 0:
        raise Wrong(f"run, isolate: {isolate}: exit {code}: {text}")
    answers = {}
    for stage in ("filters", "solvers"):
        for frame in range(FRAMES):
            with np.load(out / f"dumps/{stage}/{frame:06}.npz") as arrays:
                for name in arrays:
                    if name.startswith("out."):
                        answers[f"{frame} {name}"] = arrays[name]
    if len(answers) < 8 * FRAMES:
        raise Wrong(f"run, isolate: {isolate}: only {sorted(answers)} were answered")
    return answers


def answers_of(host: Host, folder: Path, preload: str = "") -> dict[str, np.ndarray]:
    """What the library answers, in and out of the host's process to the same bytes."""
    code, text = host.ask("plugins", "describe", str(folder / LIBRARY), preload=preload)
    if code != 0:
        raise Wrong(f"describe: exit {code}: {text}")
    inside = run(host, folder, "none", preload)
    outside = run(host, folder, "process", preload)
    for name, array in inside.items():
        if array.tobytes() != outside[name].tobytes():
            raise Wrong(f"{name} differs in a process of its own")
    return inside


def compare(answers: dict[str, np.ndarray], wanted: dict[str, np.ndarray]) -> str:
    """How near the answers are; throws where they are not the same."""
    if answers.keys() != wanted.keys():
        raise Wrong(f"answers {sorted(answers.keys() ^ wanted.keys())} are there once")
    if all(array.tobytes() == wanted[name].tobytes() for name, array in answers.items()):
        return "same bytes"
    off_mm = 0.0
    for frame in range(FRAMES):
        mask = f"{frame} out.inlier_mask/"
        limit_px = wanted[mask + "diag.limit_px"]
        turned = answers[mask + "kept"] != wanted[mask + "kept"]
        near = np.abs(wanted[mask + "diag.residual_px"] - limit_px) < WITHIN_PX
        if np.any(turned & ~near):
            raise Wrong(f"frame {frame}: {np.sum(turned & ~near)} matches are judged otherwise")
        shape = f"{frame} out.shape/vertices_m"
        off_mm = max(off_mm, 1e3 * np.abs(answers[shape] - wanted[shape]).max())
    if not off_mm < WITHIN_MM:
        raise Wrong(f"shapes are {off_mm:.2g} mm apart")
    return f"same masks, shapes within {off_mm:.1g} mm"


def refused(host: Host, folder: Path) -> tuple[str, str]:
    """The sentence of a library that all commands refuse, and what it says to preload."""
    code, text = host.ask("plugins", "describe", str(folder / LIBRARY))
    if code == 0:
        return "", ""
    sentence = refusal(text)
    if not sentence or code != 3:
        raise Wrong(f"describe: exit {code}: {text}")
    for command in ("check", "run"):
        code, text = host.ask("--plugin-path", str(folder), command, host.pipeline("process"))
        if code != 2 or refusal(text)[:60] != sentence[:60]:  # the sentence has the file's name
            raise Wrong(f"{command}: exit {code}: {text}")
    fix = re.search(r"LD_PRELOAD=(.+)", sentence)
    return sentence, fix.group(1) if fix else ""


@dataclass
class Cell:
    result: str
    sentence: str = ""  # with which it was refused


def cell(host: Host, pairing: tuple[str, str], wanted: dict[str, np.ndarray]) -> Cell:
    folder = build(host, pairing)
    sentence, fix = refused(host, folder)
    if not sentence:
        try:
            return Cell(compare(answers_of(host, folder), wanted))
        except Lacking as refusal_by_processor:
            return Cell("", str(refusal_by_processor))
    if not fix:
        return Cell("", sentence)
    preload = subprocess.run(["sh", "-c", f"printf %s {fix}"], text=True, check=False,
                             capture_output=True).stdout
    return Cell(compare(answers_of(host, folder, preload), wanted), sentence)


def print_table(cells: dict[tuple[str, str], Cell]) -> None:
    sentences = sorted({one.sentence for one in cells.values() if one.sentence})
    print("| compiler | " + " | ".join(f"`{mode}`" for mode in MODES) + " |")
    print("|---" * (len(MODES) + 1) + "|")
    for compiler in COMPILERS:
        row = []
        for mode in MODES:
            one = cells.get((compiler, mode), Cell("–"))
            number = f"refused ({sentences.index(one.sentence) + 1})" if one.sentence else ""
            row.append("; so started: ".join(part for part in (number, one.result) if part))
        print(f"| {compiler} | " + " | ".join(row) + " |")
    for number, sentence in enumerate(sentences, 1):
        print(f"\n({number}) it {sentence}")


def makes_sense(compiler: str, mode: str) -> bool:
    return mode != "-D_GLIBCXX_DEBUG" or "libc++" not in compiler


def works(compiler: str) -> bool:
    """Whether a compiler and its standard library are installed."""
    try:
        return subprocess.run([*COMPILERS[compiler], "-x", "c++", "-std=c++20", "-fsyntax-only", "-"],
                              input="#include <memory>\n", text=True, capture_output=True,
                              check=False).returncode == 0
    except FileNotFoundError:
        return False


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--quick", action="store_true", help="two pairings")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    compilers = [compiler for compiler in COMPILERS if works(compiler)]
    if REFERENCE[0] not in compilers:
        print(f"not tried, as there is no {REFERENCE[0]}", file=sys.stderr)
        return SKIPPED
    pairings = [(compiler, mode) for compiler in compilers for mode in MODES
                if makes_sense(compiler, mode) and (compiler, mode) != REFERENCE
                and (not options.quick or (compiler, mode) in QUICK)]
    with tempfile.TemporaryDirectory() as work:
        host = Host(options.build.resolve(), Path(work))
        host.write_pipelines()
        wanted = answers_of(host, build(host, REFERENCE))
        cells = {REFERENCE: Cell("the reference")}
        wrong = []

        def fill(pairing: tuple[str, str]) -> None:
            try:
                cells[pairing] = cell(host, pairing, wanted)
            except Wrong as fault:
                wrong.append(" ".join(pairing))
                cells[pairing] = Cell("WRONG")
                print(f"{' '.join(pairing)}: {fault}", file=sys.stderr, flush=True)

        with ThreadPoolExecutor(options.jobs) as pool:
            list(pool.map(fill, pairings))
    print_table(cells)
    for compiler in COMPILERS.keys() - set(compilers):
        print(f"not tried, as it is not installed: {compiler}", file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
