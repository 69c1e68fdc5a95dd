#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks or writes the parameter tables of plugins' pages: parameter_tables.py [--write] WEFT ROOT|PAGE

WEFT is the program; the plugins are those that it finds (WEFT_PLUGIN_PATH). The page of the library
`role_name.so` is plugins/role/name/README.md. On it the lines between `<!-- parameters -->` and
`<!-- /parameters -->` are the table of the component role/name, those behind
`<!-- parameters: ID -->` that of the component ID: name, meaning, type and range, default, as the
manifest says. Behind `<!-- parameters: ID besides OTHER -->` the rows that ID shares with OTHER are
left out. Every component must have its table on the page of its library.

For a PAGE of a plugin that lives elsewhere, its tables are all that is looked at; each names its ID.

Prints one line for each mistake and exits 1 if there is one; --write writes the tables anew first.
Exits 2 on wrong usage.
"""

import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Iterator, NamedTuple

BEGIN = re.compile(r"<!-- parameters(?:: (\S+)(?: besides (\S+))?)? -->")
END = "<!-- /parameters -->"
FIX = "write it anew with scripts/parameter_tables.py --write WEFT ROOT"
TYPES = {"f64": "number", "i64": "whole number", "bool": "true or false", "text": "text",
         "labels": "stems and texts", "input_path": "file to read", "output_path": "path to write"}
HEAD = ["| parameter | meaning | type and range | default |", "|---|---|---|---|"]


class Component(NamedTuple):
    page: str  # from the root
    table: list[str]


def output_of(*command: str) -> Any:
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def number(value: float) -> str:
    return str(int(value)) if value == int(value) and abs(value) < 1e16 else f"{value:.6g}"


def type_of(parameter: dict[str, Any]) -> str:
    """What may be given, in words: `list of numbers, px, 0 to 100`."""
    kind = parameter["type"]
    if kind == "choice":
        return ", ".join(f"`{choice}`" for choice in parameter["choices"])
    if kind == "component":
        return f"component of `{parameter['role']}`"
    words = TYPES.get(kind, kind)
    if parameter["list"]:
        words = f"list of {words}s"
    words += "".join(f", or `{choice}`" for choice in parameter.get("choices", []))
    if parameter.get("unit"):
        words += f", {parameter['unit']}"
    if "range" in parameter:
        low, high = parameter["range"]
        words += f", {number(low)} to {number(high)}"
    return words


def value_of(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return number(value)
    if isinstance(value, list):
        return f"[{', '.join(value_of(each) for each in value)}]"
    if isinstance(value, dict):
        return json.dumps(value)
    return f"`{value}`" if value else "none"


def cell(text: str) -> str:
    return re.sub(r"([|*])", r"\\\1", " ".join(text.split()))


def table_of(parameters: list[dict[str, Any]]) -> list[str]:
    if not parameters:
        return ["", "It has no parameters.", ""]
    rows = [(f"`{each['name']}`", each["help"], type_of(each),
             "required" if each["required"] else value_of(each.get("default")))
            for each in parameters]
    return ["", *HEAD, *(f"| {' | '.join(cell(text) for text in row)} |" for row in rows), ""]


def table_besides(table: list[str], other: list[str], name: str) -> list[str]:
    """The rows that `other`, the table of the component `name`, lacks, and which of its rows hold."""
    def rows(of: list[str]) -> list[str]:
        return [line for line in of if line.startswith("| `")]

    own = [row for row in rows(table) if row not in rows(other)]
    gone = [row.split()[1] for row in rows(other) if row not in rows(table)]
    but = f" but {', '.join(gone)}" if gone else ""
    return ["", *(HEAD if own else []), *own, "", f"Besides, those of `{name}`{but}.", ""]


def page_of(library: str) -> str:
    """Where the page of a library is: a role's name holds no underscore."""
    role, name = Path(library).stem.split("_", 1)
    return f"plugins/{role}/{name}/README.md"


def all_ids(weft: str) -> set[str]:
    plugins = output_of(weft, "plugins", "list", "--json")["plugins"]
    return {plugin["id"] for plugin in plugins if not plugin["shadowed"]}


def components_of(weft: str, ids: set[str]) -> dict[str, Component]:
    """Those of these ids that are installed."""
    found = {}
    for name in sorted(ids):
        shown = subprocess.run([weft, "plugins", "show", name, "--json"], capture_output=True, text=True,
                               check=False)
        if shown.returncode == 0:
            component = json.loads(shown.stdout)
            found[name] = Component(page_of(component["library"]), table_of(component["parameters"]))
    return found


class Page(NamedTuple):
    lines: list[str]  # with all tables as they must be
    shown: set[str]  # components that have a table
    mistakes: list[str]  # errors that --write corrects, and others


def renewed(path: str, lines: list[str], components: dict[str, Component],
            fix: str = FIX) -> Page:
    """The page with its tables written anew, and what was wrong with it."""
    page = Page([], set(), [])
    at = 0
    while at < len(lines):
        page.lines.append(lines[at])
        begin = BEGIN.fullmatch(lines[at].strip())
        at += 1
        if not begin:
            continue
        component = begin.group(1) or "/".join(Path(path).parts[-3:-1])
        end = next((i for i in range(at, len(lines)) if lines[i].strip() == END), None)
        if end is None:
            page.mistakes.append(f"{path}:{at}: no line {END} follows")
            continue
        other = begin.group(2)
        unknown = [name for name in (component, other) if name and name not in components]
        if unknown:
            page.mistakes.append(f"{path}:{at}: there is no component {unknown[0]}")
        else:
            page.shown.add(component)
            table = components[component].table
            if other:
                table = table_besides(table, components[other].table, other)
            if lines[at:end] != table:
                page.mistakes.append(
                    f"{path}:{at}: the table of {component} is out of date: {fix}")
            page.lines.extend(table)
            at = end
    return page


def mistakes_of(root: Path, components: dict[str, Component], write: bool) -> Iterator[str]:
    pages = {str(file.relative_to(root)) for file in root.glob("plugins/*/*/README.md")}
    shown: dict[str, set[str]] = {}
    for path in sorted(pages):
        text = (root / path).read_text(encoding="utf-8")
        page = renewed(path, text.splitlines(), components)
        shown[path] = page.shown
        if write:
            (root / path).write_text("\n".join(page.lines) + "\n", encoding="utf-8")
            page = renewed(path, page.lines, components)
        yield from page.mistakes
    for component, (path, _) in sorted(components.items()):
        if path not in pages:
            yield f"{path}: there is no such page, and {component} needs one"
        elif component not in shown[path]:
            yield (f"{path}: no table of {component}: put the lines `<!-- parameters: {component} -->` "
                   f"and `{END}` there, then {FIX}")


def named_on(file: Path) -> set[str]:
    """The components of the tables of a page that stands for itself."""
    return {name for begin in BEGIN.finditer(file.read_text(encoding="utf-8"))
            for name in begin.groups() if name}


def mistakes_of_page(file: Path, components: dict[str, Component], write: bool) -> Iterator[str]:
    if not named_on(file):
        yield (f"{file}: no table of a component: put the lines `<!-- parameters: ROLE/NAME -->` and "
               f"`{END}` there")
        return
    fix = f"write it anew with {sys.argv[0]} --write WEFT {file}"
    page = renewed(str(file), file.read_text(encoding="utf-8").splitlines(), components, fix)
    if write:
        file.write_text("\n".join(page.lines) + "\n", encoding="utf-8")
        page = renewed(str(file), page.lines, components, fix)
    yield from page.mistakes


def main(arguments: list[str]) -> int:
    write = arguments[:1] == ["--write"]
    arguments = arguments[1:] if write else arguments
    if len(arguments) == 2 and Path(arguments[1]).is_file():
        page = Path(arguments[1])
        mistakes = list(mistakes_of_page(page, components_of(arguments[0], named_on(page)), write))
        print("\n".join(mistakes) if mistakes else f"{arguments[1]}: the tables are up to date")
        return 1 if mistakes else 0
    if len(arguments) != 2 or not (Path(arguments[1]) / "plugins").is_dir():
        print(__doc__, file=sys.stderr)
        return 2
    components = components_of(arguments[0], all_ids(arguments[0]))
    mistakes = list(mistakes_of(Path(arguments[1]).resolve(), components, write))
    print("\n".join(mistakes) if mistakes else f"{len(components)} components have their tables")
    return 1 if mistakes else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
