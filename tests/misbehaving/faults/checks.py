#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Do the checks of `weft plugins check` find faults of plugins?

    tests/misbehaving/faults/checks.py --weft build/release/bin/weft filters/lpm warps/tps

puts the library of faults in front of these plugins, one fault a plugin, and runs the group of checks
that should find it; the plugin without a fault must pass that group. A seed chooses the plugin of a
fault. Exits with 1 where a plugin fails without a fault, or where fewer than 95 % of the faults are
found. A fault can be invisible in one plugin, as an error text that it never gives.
"""

from __future__ import annotations

import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import yaml
from trials import LIBRARY, bound_to

SHARE_TO_FIND = 0.95
PATIENCE_S = 1200.0
STAGES = "detectors,matchers,filters,warps,passes,solvers"
ROLES = {
    "stages": STAGES,
    "makers": f"sources,templates,{STAGES}",  # makers of records, the same ones for the same inputs
    "prepared": f"{STAGES},sinks",
}
# Faults by the group of checks that should find them: the fault, the roles to which it applies, and
# what a component must have.
FAULTS = {
    "load": """
        wrong_magic all
        major_2 all
        needs_minor all
        reserved_used all
        table_small all
        component_small all
        null_destroy all
        load_prints all
        load_thread all
        load_slow all
        load_flushes all
        describing_opens_file all
        describes_other_default all numbers
        """,
    "table": """
        answers_unknown_extension all
        extension_moves all extension
        reads_past_host makers
        reads_past_call makers
        confused_by_newer_host makers
        """,
    "parameters": """
        accepts_out_of_range all ranges
        crashes_at_end_of_range all ranges
        ignores_numbers all ranges
        accepts_wrong_type all numbers
        refuses_unknown all
        names_no_subject all ranges
        keeps_first_number all ranges
        """,
    "contract": """
        nan_in_output stages
        wrong_length stages
        flag_255 filters,solvers
        confidence_above_one filters,solvers
        negative_depth solvers
        keeps_rejected filters
        ok_with_nothing stages
        ok_in_place_of_warning filters,warps,solvers
        error_without_text filters,warps,solvers
        text_not_utf8 filters,warps,solvers
        writes_to_null makers
        ok_without_memory stages
        uses_undeclared_slot stages
        uses_unknown_array stages
        writes_input stages
        reads_past_input stages
        reads_input_afterwards stages
        ignores_padding stages
        needs_aligned_inputs stages
        depends_on_address detectors,matchers,filters,warps,solvers no_random
        reads_uninitialised makers
        last_row_unwritten makers
        writes_past_output makers
        crashes_with_nothing filters,warps
        exits makers
        half_when_cancelled stages
        wrong_hessian warps
        """,
    "calls": """
        remembers_input stages no_random
        counts_calls makers no_random
        depends_on_frame_order stages
        depends_on_thread stages
        depends_on_threads stages
        seeded_by_clock stages
        shares_instances stages
        creates_one_at_a_time all
        crashes_prepared_twice prepared
        crashes_unprepared prepared
        writes_call stages
        writes_host stages
        writes_record stages
        writes_array_entry stages
        swaps_arrays stages
        keeps_call stages
        logs_escape stages
        logs_lines stages
        logs_bad_text stages
        logs_huge stages
        logs_often stages
        invokes_others stages
        crashes_at_exit stages
        destructor_crashes stages
        prints_at_exit stages
        changes_exit_code stages
        """,
    "limits": """
        slow_to_cancel stages
        leaks_memory stages
        leaks_descriptor stages
        leaves_thread stages
        changes_locale stages
        changes_rounding stages
        flushes_denormals stages
        changes_signal_handler stages
        changes_signal_mask stages
        changes_folder stages
        changes_umask stages
        changes_environment stages
        limits_files stages
        starts_timer stages
        changes_priority stages
        changes_terminate stages
        prints stages
        uses_global_generator stages
        undeclared_seed stages no_random
        differs_in_worker stages
        hangs_on_large_input stages
        """,
    "geometry": """
        prefers_first_match filters no_random
        depends_on_match_order warps,solvers no_random
        duplicates_disagree filters no_random
        absolute_position filters,solvers no_random
        fixed_offset solvers no_random
        millimetres solvers
        mirrored solvers
        renumbered_vertices solvers
        off_by_half_pixel warps
        wrong_jacobian warps
        """,
}


@dataclass
class Plugin:
    """A library with one component."""

    manifest: Path
    component: dict

    @property
    def id(self) -> str:
        return self.component["id"]

    def suits(self, roles: str, having: str) -> bool:
        numbers = [each for each in self.component.get("parameters") or []
                   if each["type"] in ("f64", "i64") and "default" in each
                   and not isinstance(each["default"], list)]
        return (roles == "all" or self.id.split("/")[0] in ROLES.get(roles, roles).split(",")) and {
            "anything": True, "numbers": bool(numbers),
            "ranges": any("range" in each for each in numbers),
            "extension": bool(self.component["extensions"]),
            "no_random": not self.component["random"]}[having]


class Checker:
    def __init__(self, weft: Path, faulty: Path, work: Path, words: list[str]) -> None:
        self.weft, self.faulty, self.work, self.words = weft, faulty, work, words

    def check(self, manifest: Path, group: str, **more: str) -> tuple[int | None, str]:
        """The exit code, and the first line about a failure; None: it did not end."""
        words = [self.weft, "plugins", "check", *(self.words or ["--only", group]), manifest]
        try:
            ended = subprocess.run(words, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                                   errors="replace", timeout=PATIENCE_S, env={**os.environ, **more})
        except subprocess.TimeoutExpired:
            return None, f"no end after {PATIENCE_S:.0f} s"
        said = (ended.stdout + ended.stderr).strip()
        fails = re.search(r"^ *fails +(.*)$", said, re.M)
        return ended.returncode, (fails[1] if fails else said.split("\n")[-1])[:200]

    @cache
    def holds(self, manifest: Path, group: str) -> str:
        """Why a plugin without a fault fails; empty where it does not."""
        code, why = self.check(manifest, group)
        return "" if code == 0 else why

    def finds(self, fault: str, plugin: Plugin, group: str) -> tuple[bool, str]:
        if wrong := self.holds(plugin.manifest, group):
            return False, f"{plugin.id} without a fault: {wrong}"
        folder = self.work / f"{fault}.{plugin.id.replace('/', '_')}"
        folder.mkdir()
        manifest = folder / plugin.manifest.name
        stem = plugin.manifest.name.removesuffix(".plugin.yaml")
        shutil.copy(self.faulty, folder / f"{stem}.so")
        manifest.write_text(bound_to(self.faulty, plugin.manifest.read_text()))
        parameters = plugin.manifest.with_name(f"{stem}.check")
        if parameters.exists():
            shutil.copy(parameters, folder)
        code, why = self.check(manifest, group, WEFT_FAULT=fault,
                               WEFT_FAULT_PLUGIN=str(plugin.manifest.with_name(f"{stem}.so")))
        return code == 1, why


def unknown_faults() -> set[str]:
    """Names that are in the sources of the library and in no list, or the other way round."""
    here = Path(__file__).parent
    made = set(re.findall(r'has\("(\w+)"\)', "".join(
        file.read_text() for file in here.glob("*.cpp"))))
    listed = {line.split()[0] for lines in FAULTS.values() for line in lines.strip().split("\n")}
    others = "".join(file.read_text() for file in (
        here / "mistakes.py", here.parent / "unruly/conformance_test.cpp"))
    return {name for name in made | listed
            if name not in made or (name not in listed and f'"{name}"' not in others)}


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weft", required=True, type=Path, help="the program")
    parser.add_argument("--plugins", type=Path, help="folder of the plugins")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1, help="checks at once")
    parser.add_argument("--brief", action="store_true", help="make the brief checks of all groups")
    parser.add_argument("--only", default="", help="names of faults, separated by commas")
    parser.add_argument("ids", nargs="+", help="plugins, as role/name")
    options = parser.parse_args()
    if unknown := unknown_faults():
        sys.exit(f"made and not listed, or listed and not made: {sorted(unknown)}")
    weft = options.weft.resolve()
    build = weft.parent.parent
    installed = options.plugins or build / "lib/weft/plugins"
    plugins = []
    for each in options.ids:
        manifest = (installed / f"{each.replace('/', '_')}.plugin.yaml").resolve()
        plugins.append(Plugin(manifest, yaml.safe_load(manifest.read_text())["components"][0]))
    rng = random.Random(options.seed)
    tasks = []
    for group, lines in FAULTS.items():
        for line in lines.strip().split("\n"):
            fault, roles, having = (*line.split(), "anything")[:3]
            suitable = [plugin for plugin in plugins if plugin.suits(roles, having)]
            if suitable and (not options.only or fault in options.only.split(",")):
                tasks.append((fault, rng.choice(suitable), group))
    print(f"seed {options.seed}", flush=True)
    found = 0
    with tempfile.TemporaryDirectory(prefix="weft-faults-") as work:
        checker = Checker(weft, build / "tests/misbehaving/faulty" / LIBRARY, Path(work),
                          ["--brief"] if options.brief else [])
        with ThreadPoolExecutor(options.jobs) as pool:
            asked = sorted({(plugin.manifest, group) for _, plugin, group in tasks})
            wrong = [why for why in pool.map(lambda each: checker.holds(*each), asked) if why]
            answers = pool.map(lambda task: checker.finds(*task), tasks)
            for (fault, plugin, group), (is_found, why) in zip(tasks, answers):
                found += is_found
                print(f"{fault} in {plugin.id}, by {group}: {'found' if is_found else 'MISSED'}, {why}",
                      flush=True)
    print(f"{found} of {len(tasks)} faults are found")
    return 0 if tasks and not wrong and found >= SHARE_TO_FIND * len(tasks) else 1


if __name__ == "__main__":
    sys.exit(main())
