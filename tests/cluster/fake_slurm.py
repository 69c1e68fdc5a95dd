#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stands for Slurm: sbatch, squeue, sinfo and scancel, called by these names, over a folder.

$FAKE_SLURM is the folder. Its `jobs` holds a folder for each job, with what sbatch was told
(`job.json`) and a file for each task with its state. fake_nodes.py runs the tasks. Unlike Slurm it
refuses options that it does not know, so that a test sees all that Weft uses.

The file `site` in $FAKE_SLURM has a word for each habit of a site: `talks` prints lines before and
behind each answer, `clusters` names clusters as a site of several does, `long` says `Submitted batch
job N`, `mute` names no job, `loses` submits and then fails, `lumps` has one line for all tasks of a
job that wait, `down` is a controller out of reach.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

PARTITIONS = ("main", "gpu", "long")
KNOWN = ("parsable", "partition", "nodes", "ntasks", "export", "chdir", "job-name", "array",
         "cpus-per-task", "requeue", "output", "open-mode", "dependency", "mem", "time",
         "clusters")
LOST = "error: {}: Socket timed out on send/recv operation"


def jobs_folder() -> Path:
    return Path(os.environ["FAKE_SLURM"]) / "jobs"


def habits() -> list[str]:
    site = Path(os.environ["FAKE_SLURM"]) / "site"
    return site.read_text().split() if site.exists() else []


def split(arguments: list[str]) -> tuple[dict[str, str], list[str]]:
    """Options of the form --name=value, and the other words."""
    options, words = {}, []
    for argument in arguments:
        name, _, value = argument.removeprefix("--").partition("=")
        if argument.startswith("--"):
            options[name] = value
        else:
            words.append(argument)
    return options, words


def write(file: Path, text: str) -> None:
    part = file.with_suffix(".part")
    part.write_text(text)
    part.rename(file)


def new_job() -> Path:
    number = 1
    while True:
        try:
            folder = jobs_folder() / str(number)
            folder.mkdir(parents=True)
            return folder
        except FileExistsError:
            number += 1


def sbatch(arguments: list[str]) -> str:
    options, words = split(arguments)
    if "version" in options:
        return "slurm 22.05.8"
    unknown = [name for name in options if name not in KNOWN]
    if unknown or len(words) != 1:
        sys.exit(f"sbatch: unrecognized option '--{(unknown or words or ['none'])[0]}'")
    if options.get("partition", "main") not in PARTITIONS:
        sys.exit("sbatch: error: invalid partition specified: " + options["partition"])
    folder = new_job()
    first, _, last = options.get("array", "").partition("-")
    tasks = [str(task) for task in range(int(first), int(last) + 1)] if first else ["alone"]
    for task in tasks:
        write(folder / f"{task}.state", "PENDING")
    job = options | {"script": words[0], "tasks": tasks,
                     "after": options.get("dependency", "").removeprefix("afterany:")}
    write(folder / "job.json", json.dumps(job))
    if "loses" in habits():
        sys.exit("sbatch: " + LOST.format("Batch job submission failed"))
    if "mute" in habits():
        return ""
    cluster = options.get("clusters", "")
    if "long" in habits():
        return f"Submitted batch job {folder.name}" + (f" on cluster {cluster}" if cluster else "")
    return folder.name + (f";{cluster}" if cluster else "")


def squeue(arguments: list[str]) -> str:
    options, _ = split(arguments)
    if "down" in habits():
        sys.exit("squeue: " + LOST.format("slurm_load_jobs"))
    assert options["format"] == "%j|%F|%K|%T|%r", options
    names = options["name"].split(",")
    lines = []
    for folder in sorted(jobs_folder().glob("*"), key=lambda each: int(each.name)):
        if not (folder / "job.json").exists():
            continue
        job = json.loads((folder / "job.json").read_text())
        if job.get("clusters", "") != options.get("clusters", ""):
            continue
        if "lumps" in habits() and job["job-name"] in names and "array" in job:
            lines.append(f"{job['job-name']}|{folder.name}|{job['array']}%4|PENDING|Priority")
            continue
        for task in job["tasks"]:
            state = (folder / f"{task}.state").read_text()
            if job["job-name"] in names and ("all" in options.get("states", "") or
                                             state in ("PENDING", "RUNNING")):
                held = (folder / f"{task}.held").exists()
                reason = "launch failed requeued held" if held else "None"
                lines.append(f"{job['job-name']}|{folder.name}|{task}|{state}|{reason}")
    return "\n".join(lines)


def scancel(arguments: list[str]) -> str:
    for number in split(arguments)[1]:
        (jobs_folder() / number / "cancelled").touch()
        for file in (jobs_folder() / number).glob("*.state"):
            if file.read_text() == "PENDING":
                write(file, "CANCELLED")
    return ""


def sinfo(_: list[str]) -> str:
    return "\n".join(PARTITIONS)


if __name__ == "__main__":
    answer = {"sbatch": sbatch, "squeue": squeue, "scancel": scancel,
              "sinfo": sinfo}[Path(sys.argv[0]).name](sys.argv[1:])
    if "talks" in habits():
        print("*** Maintenance on 2026-12-24 ***\n4712 of 9000 cores are busy\n")
        print(f"{Path(sys.argv[0]).name}: lua: your account is charged", file=sys.stderr)
    if {"clusters", "talks"} & set(habits()):
        print("CLUSTER: nautilus")
    if answer:
        print(answer)
    if "talks" in habits():
        print("have a nice day | see https://example.org/queue | status|ok|1|2|3")
