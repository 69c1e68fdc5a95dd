# SPDX-License-Identifier: Apache-2.0
"""Mutants of pipelines and plans: with planted mistakes, or written anew with the same meaning."""

from __future__ import annotations

import re
from pathlib import Path
from random import Random

import bases
import pipeline_mistakes
import plan_mistakes
import planting
from documents import Map, Style, Text, nodes, write
from judging import Expected, Mutant
from overlay_mutants import pipeline_overlay, plan_overlay
from planting import Planted
from program import Answer, Program


def plant(rng: Random, root: Map, places) -> list[Planted]:
    """One to four mistakes in as many places; or a single one of syntax."""
    if rng.random() < 0.08:
        return [rng.choice([planting.syntax, planting.syntax, planting.deep])(rng, root)]
    count, planted = rng.randrange(1, 5), []
    free = places(root)
    rng.shuffle(free)
    free.sort(key=lambda place: place[0] is not root)  # a part that the root loses is not taken
    for part, kinds in free:
        there = any(node is part for node in nodes(root))
        if len(planted) < count and there and (part is not root or rng.random() < 0.4):
            mistake = rng.choice(kinds)(rng, part)
            if mistake and mistake.alone:  # an error of the root, which comes first
                return [mistake]
            planted += [mistake] if mistake else []
    return planted


def expected_of(file: str, planted: list[Planted]) -> list[Expected]:
    return [Expected(mistake.kind, file, *mistake.at, mistake.suggestion) for mistake in planted]


def encoded(text: str) -> bytes:
    return text.encode(errors="surrogateescape")


def respelt(rng: Random, root: Map) -> None:
    """Numbers in other words, which mean the same."""
    for node in nodes(root):
        if isinstance(node, Text) and re.fullmatch(r"\d+\.\d+", node.value) and rng.random() < 0.5:
            value = float(node.value)
            node.raw = rng.choice([node.value + "00", f"{value / 10:.6f}e1", f"{value * 10:.6f}E-1",
                                   f"+{node.value}"])


def dressed(rng: Random, text: str) -> str:
    """With what may surround a document."""
    before = rng.choice(["", "", "\ufeff", "---\n", "# first\n\n", "%YAML 1.2\n---\n", "\n\n"])
    behind = rng.choice(["", "", "\n\n", "...\n", "# last", "# no end"])
    return before + text + behind


def files_beside() -> dict[str, object]:
    return {"present.txt": b"present\n"}


# --- pipelines ------------------------------------------------------------------------------------


def as_number(text: str) -> str:
    try:
        return repr(float(text))
    except ValueError:
        return text


def run_text(program: Program, folder: Path, name: str) -> str:
    """What a run of three frames at most leaves, without times and places."""
    ran = program.ask(folder, "run", name, "--out", f"run-{name}", "--quiet")
    out = folder / f"run-{name}"
    if ran.code not in (0, 1) or not (out / "pipeline.yaml").exists():
        return f"{name}: run ends with {ran.code}: {ran.err}"
    lines = re.sub(r'"(?:processor_)?ms":(\{[^}]*\}|[\d.e-]+)', "", (out / "frames.jsonl").read_text())
    config = (out / "pipeline.yaml").read_text().replace(str(out), "")
    config = re.sub(r"[+-]?[\d.]+([eE][+-]?\d+)?", lambda found: as_number(found[0]), config)
    arrays = [file.read_bytes().hex() for file in sorted(out.glob("frames/*.npz"))]
    return "\n".join([config, lines, *arrays])


def same_run(program: Program, folder: Path, answer: Answer) -> str:
    before = run_text(program, folder, "legal.yaml")
    return "" if before == run_text(program, folder, "pipeline.yaml") else "runs differ"


def pipeline_mutant(rng: Random) -> Mutant:
    if rng.random() < 0.15:
        return pipeline_overlay(rng)
    root = bases.pipeline(rng)
    command = ["check", "pipeline.yaml"]
    if rng.random() < 0.15:
        legal = write(root)
        respelt(rng, root)
        text = dressed(rng, write(root, Style.random(rng)))
        files = {"legal.yaml": encoded(legal), "pipeline.yaml": encoded(text)}
        return Mutant("pipeline", files | files_beside(), command, same=same_run)
    planted = plant(rng, root, pipeline_mistakes.places)
    text = write(root, Style.random(rng))
    return Mutant("pipeline", {"pipeline.yaml": encoded(text)} | files_beside(), command,
                  expected_of("pipeline.yaml", planted))


# --- plans ----------------------------------------------------------------------------------------


def keys_of(program: Program, folder: Path, plan: str) -> str:
    """The cells of a plan with their keys, which cover all that matters."""
    ran = program.ask(folder, "ablate", plan, "--out", f"out-{plan}", "--quiet")
    try:
        text = (folder / f"out-{plan}" / "plan.json").read_text()
    except OSError:
        return f"{plan}: exit {ran.code}: {ran.err}"
    return re.sub(r'"check": "\w+"', "", text.replace(plan, ""))  # it covers the plan's name too


def same_cells(program: Program, folder: Path, answer: Answer) -> str:
    before = keys_of(program, folder, "legal.yaml")
    return "" if before == keys_of(program, folder, "plan.yaml") else "cells differ"


def plan_mutant(rng: Random) -> Mutant:
    if rng.random() < 0.1:
        return plan_overlay(rng)
    root = bases.plan(rng)
    base = {"base.yaml": bases.BASE_OF_PLANS.encode()}
    command = ["ablate", "plan.yaml", "--status", "--out", "out"]
    if rng.random() < 0.15:
        legal = write(root)
        respelt(rng, root.find("metrics"))
        respelt(rng, root.find("expect"))
        text = dressed(rng, write(root, Style.random(rng)))
        files = {"legal.yaml": encoded(legal), "plan.yaml": encoded(text)}
        return Mutant("plan", files | base, command, same=same_cells, codes=(0, 1))
    planted = plant(rng, root, plan_mistakes.places)
    text = write(root, Style.random(rng))
    return Mutant("plan", {"plan.yaml": encoded(text)} | base, command,
                  expected_of("plan.yaml", planted))
