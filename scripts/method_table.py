#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks or writes the table of methods: method_table.py [--write] WEFT ROOT
or measures its figures anew:               method_table.py --measure ROOT RESULTS...

The lines of docs/methods.md between `<!-- methods -->` and `<!-- /methods -->` are the table of all
solvers. Who made them, what each reads and whether it is trained is what the manifests of the
installed plugins say (WEFT, the program; WEFT_PLUGIN_PATH). Errors and times are those of
docs/evidence/methods.json, which also has what no manifest says: whose settings a row has, and
against what the solver was verified. --measure writes the figures from the results folders of the
ablations solvers_first_test, solvers_folds, solvers_kinect, solvers_cloth and solvers_curved (mean
3D error, mm) and of one that was run with --timing (solvers_times, ms of processor time a frame). A
row that is not measured keeps its figures; values of the axis that are no solver are left out.

It also checks that every installed component with a reference says what it implements, that
plugins/README.md has a row for each component and for no other, and that the tables of README.md, of
plugins/README.md and of docs/methods.md carry the word of each solver, filter and warp.

Prints one line for each mistake and exits 1 if there is one; exits 2 on wrong usage.
"""

import json
import re
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

PAGE, FIGURES = "docs/methods.md", "docs/evidence/methods.json"
BEGIN, END = "<!-- methods -->", "<!-- /methods -->"
FIX = "write it anew with scripts/method_table.py --write WEFT ROOT"
# Plans, and the text of their column.
COLUMNS = {"solvers_first_test": "FREX, mm", "solvers_folds": "folds, mm",
           "solvers_kinect": "Kinect, mm",
           "solvers_cloth": "cloth, mm", "solvers_curved": "curved, mm", "solvers_times": "ms"}
# Rows that do not begin with the default start of their solver.
STARTS = {"particle_sft_flat_start": "`initial_guess`"}
# The words of each row in the file of figures.
WORDS = {"settings": "settings", "verified_against": "verified against"}
# The groups of the table, in this order.
GROUPS = ["paper", "reconstruction", "own"]
CATALOGUE = "plugins/README.md"
# Pages whose rows that begin with a component carry its word.
MARKED = ["README.md", CATALOGUE, PAGE]
HEAD = ["method", "by", "implements", *WORDS.values(), "registration", "wide baseline", "training",
        "start", *COLUMNS.values(),
        "code"]
# Rows that are a solver with other settings than its defaults, by a value of the plans' axis.
VARIANTS = {"chhatkuli_2014": "solvers/chhatkuli_stable", "chhatkuli_2017": "solvers/chhatkuli_stable",
            "ngo_laplacian_weft": "solvers/ngo_laplacian",
            "ostlund_laplacian_weft": "solvers/ostlund_laplacian",
            "particle_sft_flat_start": "solvers/particle_sft",
            "salzmann_closed_form_unpolished": "solvers/salzmann_closed_form",
            "salzmann_convex_weft": "solvers/salzmann_convex"}


def component_of(name: str) -> str:
    return VARIANTS.get(name, f"solvers/{name}")


def output_of(*command: str) -> Any:
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def components_of(weft: str) -> dict[str, dict[str, Any]]:
    """The manifest of each component that is installed, by id."""
    ids = [plugin["id"] for plugin in output_of(weft, "plugins", "list", "--json")["plugins"]
           if not plugin["shadowed"]]
    return {each: output_of(weft, "plugins", "show", each, "--json") for each in ids}


def author_of(name: str, manifest: dict[str, Any]) -> str:
    """`Bartoli 2015`: the first author of the first reference, and its year or that in the row's name."""
    if manifest["implements"] == "own":
        return "Weft"
    first = manifest["reference"].split(";")[0]
    years = re.findall(r"_((?:19|20)\d\d)$", name) or re.findall(r"\b(?:19|20)\d\d\b", first)
    return " ".join([first.split(",")[0].split()[0], *years[-1:]])


def group_of(manifest: dict[str, Any] | None) -> int:
    word = manifest["implements"] if manifest else ""
    return GROUPS.index(word) if word in GROUPS else len(GROUPS)


def registration_of(manifest: dict[str, Any]) -> str:
    """What a method takes of the picture."""
    if "image" in manifest["needs"]:
        return "texture and matches"
    return "warp of matches" if "sightlines" in manifest["needs"] else "matches"


def baseline_of(manifest: dict[str, Any]) -> str:
    """A method that needs the frame before cannot find an object anew."""
    if "previous.shape" in manifest["needs"]:
        return "no"
    return "yes, and follows" if "previous.shape" in manifest["reads"] else "yes"


def training_of(manifest: dict[str, Any]) -> str:
    trained = any(each["name"].startswith("training_") for each in manifest["parameters"])
    return "simulated shapes" if trained else "none"


def start_of(manifest: dict[str, Any]) -> str:
    """The solver whose shape it begins with, where it takes one."""
    found = [each["default"] for each in manifest["parameters"] if each.get("role") == "solvers"]
    return f"`{found[0].split('/')[1]}`" if found else "none"


def figure(value: float | None) -> str:
    return "-" if value is None else f"{value:.2f}" if value < 10 else f"{value:.1f}"


def measured(figures: dict[str, dict[str, Any]]) -> set[str]:
    return {name for column in COLUMNS for name in figures.get(column, {})}


def table_of(solvers: dict[str, dict[str, Any]], figures: dict[str, dict[str, Any]]) -> list[str]:
    """The rows of the table: methods that were measured, by group, the most exact on FREX first."""
    names = sorted(measured(figures),
                   key=lambda name: (group_of(solvers.get(component_of(name))),
                                     figures.get("solvers_first_test", {}).get(name, 1e9), name))
    rows = []
    for name in names:
        component = component_of(name)
        manifest = solvers.get(component)
        if manifest is None:
            continue
        rows.append([f"`{name}`", author_of(name, manifest), manifest["implements"],
                     *(figures.get(word, {}).get(name, "-") for word in WORDS),
                     registration_of(manifest),
                     baseline_of(manifest), training_of(manifest),
                     STARTS.get(name) or start_of(manifest),
                     *(figure(figures.get(plan, {}).get(name)) for plan in COLUMNS),
                     f"[{manifest['version']}](../plugins/{component})"])
    return ["", f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|",
            *(f"| {' | '.join(row)} |" for row in rows), ""]


def unsaid(components: dict[str, dict[str, Any]]) -> list[str]:
    """Components with a reference that do not say how they relate to it."""
    return [f"{name}: has a reference, but does not say what it implements: begin it with one of: "
            f"{', '.join(f'{word}: ' for word in GROUPS).strip()}" for name, manifest in sorted(components.items())
            if manifest["reference"] and manifest["implements"] not in GROUPS]


def rows_of(root: Path, page: str) -> list[tuple[int, list[str]]]:
    """The rows of the tables of a page: their numbers and cells."""
    file = root / page
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    return [(number, [cell.strip() for cell in line.strip("| ").split("|")])
            for number, line in enumerate(lines, 1) if line.startswith("|")]


def unmarked(root: Path, components: dict[str, dict[str, Any]]) -> list[str]:
    """Rows of MARKED that begin with a solver, a filter or a warp and lack its word."""
    mistakes = []
    for page in MARKED:
        for number, cells in rows_of(root, page):
            named = re.match(r"[\[`]*((?:solvers|filters|warps)/\w+)", cells[0])
            manifest = components.get(named.group(1)) if named else None
            if manifest is None or manifest["implements"] in ["", *cells[1:]]:
                continue
            mistakes.append(f"{page}:{number}: the row of {named.group(1)} lacks a cell that says "
                            f"'{manifest['implements']}'")
    return mistakes


def unlisted(root: Path, components: dict[str, dict[str, Any]]) -> list[str]:
    """Components without a row in the catalogue, and rows without a component."""
    listed = {named.group(1): number for number, cells in rows_of(root, CATALOGUE)
              if (named := re.match(r"\[(\w+/\w+)\]", cells[0]))}
    return [f"{CATALOGUE}: no row begins with [{name}]" for name in sorted(components.keys() - listed)
            ] + [f"{CATALOGUE}:{listed[name]}: there is no component {name}"
                 for name in sorted(listed.keys() - components.keys())]


def mistakes_of(root: Path, solvers: dict[str, dict[str, Any]], write: bool) -> list[str]:
    figures = json.loads((root / FIGURES).read_text(encoding="utf-8"))
    lines = (root / PAGE).read_text(encoding="utf-8").splitlines()
    if BEGIN not in lines or END not in lines[lines.index(BEGIN):]:
        return [f"{PAGE}: the lines {BEGIN} and {END} are missing"]
    begin = lines.index(BEGIN) + 1
    end = lines.index(END, begin)
    table = table_of(solvers, figures)
    unknown = sorted(name for name in measured(figures) if component_of(name) not in solvers)
    mistakes = [f"{FIGURES}: there is no solver {name}" for name in unknown]
    mistakes += [f"{FIGURES}: '{word}' says nothing of {name}" for word in WORDS
                 for name in sorted(measured(figures)) if name not in figures.get(word, {})]
    if lines[begin:end] != table:
        if write:
            text = "\n".join([*lines[:begin], *table, *lines[end:]]) + "\n"
            (root / PAGE).write_text(text, encoding="utf-8")
        else:
            mistakes.append(f"{PAGE}:{begin}: the table of methods is out of date: {FIX}")
    return mistakes


def means_of(folder: Path, timed: bool) -> dict[str, float]:
    """What each value of the axis `solver` has on average over the sequences: mm, or ms a frame."""
    plan = json.loads((folder / "plan.json").read_text(encoding="utf-8"))
    lines = [json.loads(line) for file in sorted((folder / "results").glob("*.jsonl"))
             if not file.name.startswith("withdrawn-")
             for line in file.read_text(encoding="utf-8").splitlines()]
    found = {line["key"]: line for line in reversed(lines)}
    values: dict[str, list[float]] = {}
    for cell in plan["cells"]:
        line = found.get(cell["key"])
        if line is None or line["outcome"] != "done":
            continue
        if timed:
            value = sum(stage["mean_processor_ms"] for stage in line["timing"]["stages"]
                        if stage["stage"] in ("warps", "passes", "solvers"))
        else:
            value = line["metrics"]["all"]["error_solved"]["mean_mm"]
        if value is not None:
            values.setdefault(cell["axes"]["solver"], []).append(value)
    return {name: round(statistics.fmean(each), 3) for name, each in sorted(values.items())}


def measure(root: Path, folders: list[str]) -> list[str]:
    figures = json.loads((root / FIGURES).read_text()) if (root / FIGURES).exists() else {}
    for folder in map(Path, folders):
        plan = json.loads((folder / "plan.json").read_text(encoding="utf-8"))["name"]
        timed = any(folder.glob("results/alone-*.jsonl"))
        column = "solvers_times" if timed else plan
        if column not in COLUMNS:
            return [f"{folder}: the plan {plan} has no column"]
        found = {name: value for name, value in means_of(folder, timed).items()
                 if (root / "plugins" / component_of(name)).is_dir()}
        figures[column] = {**figures.get(column, {}), **found}
    text = json.dumps(figures, indent=1, sort_keys=True) + "\n"
    (root / FIGURES).write_text(text, encoding="utf-8")
    return []


def main(arguments: list[str]) -> int:
    if arguments[:1] == ["--measure"] and len(arguments) > 2:
        mistakes, good = measure(Path(arguments[1]).resolve(), arguments[2:]), f"{FIGURES} is written"
    else:
        write = arguments[:1] == ["--write"]
        arguments = arguments[1:] if write else arguments
        if len(arguments) != 2 or not (Path(arguments[1]) / "plugins").is_dir():
            print(__doc__, file=sys.stderr)
            return 2
        root, components = Path(arguments[1]).resolve(), components_of(arguments[0])
        mistakes = [*unsaid(components), *unmarked(root, components), *unlisted(root, components),
                    *mistakes_of(root, components, write)]
        good = "the tables of methods and of components are up to date"
    print("\n".join(mistakes) if mistakes else good)
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
