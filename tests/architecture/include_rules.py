#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks who includes whom, who prints, the size of rooms, and the first lines of sources.

Usage: include_rules.py ROOT

Prints one line `file:line: rule` for each violation; exits 1 if there is one, 2 on wrong usage.
"""

import os
import re
import sys
from pathlib import Path, PurePosixPath
from typing import Iterator, NamedTuple

CODE = {".h", ".hpp", ".c", ".cpp"}
SCRIPTS = {".py", ".sh", ".cmake"}
ROOMS = ("framework", "plugins", "tests", "docs", "scripts", ".ci")

# A room may include itself and these; `host` alone stands for all rooms that begin with `host/`.
# The first ones are installed, in framework/include/weft; the others hold headers beside sources.
INSTALLED = {
    "core": "",
    "images": "core",
    "data": "core",
    "geometry": "core data",
    "geometry/solid": "core data geometry",
    "generators": "core data geometry",
    "truth": "core data geometry",
    "sdk": "core data geometry",
    "testing": "core data geometry generators sdk",
    "embedding": "core data",
}
INTERNAL = {
    "yaml": "core",
    "host/guarding": "core sdk",
    "host/describe": "core data sdk host/guarding host/roles",
    "host/roles": "core sdk",
    "host/records": "core data host/guarding",
    "host/loading": "core sdk yaml host/guarding host/describe host/roles host/records",
    "process": "core",
    "host/probing": "core process host/guarding host/describe host/records host/loading",
    "host/workers": "core process host/records host/loading",
    "host/calling": "core geometry host/guarding host/roles host/records host/loading host/workers",
    "host/serving": "core process host/guarding host/records host/loading host/workers host/calling",
    "pipeline/configuration": "core yaml host/roles host/loading host/workers",
    "pipeline/graph": "core host/roles pipeline/configuration",
    "pipeline/execution": "core data geometry host/roles host/records host/calling pipeline/graph",
    "pipeline/monitor": "core data geometry pipeline/execution",
    "pipeline/steering": "core yaml host/roles host/loading host/calling pipeline/configuration "
    "pipeline/graph pipeline/execution",
    "pipeline/dumps": "core data host/loading pipeline/configuration pipeline/execution",
    "pipeline/runs": "core data geometry host/roles host/loading pipeline/configuration pipeline/graph "
    "pipeline/execution pipeline/monitor pipeline/steering pipeline/dumps",
    "pipeline/embedding": "core data embedding host/records host/loading pipeline/runs",
    "pipeline/overview": "core yaml host/roles host/loading pipeline/configuration pipeline/graph",
    "pipeline/survey": "core images data geometry sdk yaml host/roles host/loading host/calling "
    "pipeline/execution",
    "lab/printing": "core data generators",
    "lab/calibration": "core images lab/printing",
    "lab/statistics": "core",
    "lab/metrics/runs": "core data host/roles host/records pipeline/execution lab/statistics",
    "lab/metrics/shapes": "core data geometry",
    "lab/metrics": "core data geometry truth lab/statistics lab/metrics/runs lab/metrics/shapes",
    "lab/metrics/forms": "core lab/metrics",
    "lab/results": "core data geometry host/records lab/statistics lab/metrics",
    "lab/ablation/plan": "core images yaml host/roles host/records host/loading pipeline/configuration pipeline/runs "
    "lab/statistics lab/metrics lab/results",
    "lab/ablation": "core data process host/roles host/records host/loading host/calling "
    "pipeline/execution "
    "pipeline/runs lab/metrics lab/results lab/ablation/plan",
    "lab/cluster": "core process host/records host/loading lab/metrics/runs lab/results lab/ablation/plan "
    "lab/ablation",
    "lab/report/text": "core",
    "lab/report/runs": "core data yaml lab/statistics lab/metrics lab/results lab/report/text",
    "lab/report/tables": "core lab/statistics lab/metrics lab/results",
    "lab/report/drawing": "core lab/statistics lab/report/text",
    "lab/report": "core lab/statistics lab/metrics lab/results lab/report/text lab/report/tables lab/report/drawing",
    "lab/report/paper": "core process lab/statistics lab/metrics lab/results lab/report lab/report/text lab/report/tables "
    "lab/report/drawing",
    "lab/report/pairs": "core yaml lab/statistics lab/metrics lab/results lab/report lab/report/text lab/report/tables "
    "lab/report/drawing lab/report/runs lab/report/paper",
    "lab/bench": "core data process host/records host/loading host/calling pipeline/configuration "
    "pipeline/graph pipeline/execution pipeline/runs lab/statistics",
    "lab/schema": "core yaml host/roles host/loading pipeline/configuration lab/ablation/plan",
    "lab/counting": "",
    "kit/conformance/probes": "core process host/guarding host/describe host/records host/loading testing",
    "kit/conformance": "core data process host/guarding host/describe host/records host/loading host/calling testing "
    "kit/conformance/probes",
    "cli": "core images data geometry generators truth sdk yaml host/describe host/roles process host pipeline lab/printing "
    "lab/calibration lab/metrics lab/results lab/ablation lab/cluster lab/report lab/bench lab/schema kit/conformance",
}
LAYERS = INSTALLED | INTERNAL
# Plugins and the one room that links OpenCV as they do share the readers of images and videos, and
# the live view calibrates as that room does.
SHARED_PLUGIN_CODE = {
    "lab/calibration": ("plugin:common/images", "plugin:common/films"),
    "plugin:sinks/live": ("lab/calibration",),
}
PLUGIN_LAYERS = ("core", "images", "data", "geometry", "geometry/solid", "generators", "truth", "sdk")

# abi.h is not a layer: these path prefixes may name it. data/array.hpp owns the dtypes and the
# array layout, which are the contract's.
ABI_READERS = (
    "framework/include/weft/core/params",
    "framework/include/weft/data/array.hpp",
    "framework/include/weft/data/layout.hpp",
    "framework/include/weft/sdk/",
    "framework/kit/conformance/",
    "framework/host/",
)

# Folders of rooms with headers beside the sources; other folders of framework/ have none.
ROOTS = tuple(f"framework/{root}/" for root in sorted({room.split("/")[0] for room in INTERNAL}))
FREE = ("framework/python/", "framework/kit/scaffold/", "framework/web/")
TESTING = ("framework/include/weft/testing/", "framework/kit/testing/")
# Library, pattern of its includes, path prefixes that may include it. tests/ and docs/ are free.
LIBRARIES = (
    (
        "yaml-cpp",
        r"yaml-cpp/",
        (
            "framework/yaml/",
            "plugins/common/cameras/",
            "plugins/common/yaml/",
            "plugins/sources/",
        ),
    ),
    ("Boost.DLL", r"boost/dll", ("framework/host/",)),
    ("Boost", r"boost/", ROOTS + ("plugins/",)),
    ("CGAL", r"CGAL/", ("plugins/",)),
    ("Embree", r"embree\d*/", ("plugins/",)),
    ("Ceres", r"ceres/", ("plugins/",)),
    ("OpenCL", r"(CL|OpenCL)/", ("plugins/",)),
    ("OpenCV", r"opencv2/", ("framework/lab/calibration/", "plugins/") + TESTING),
)
MOST_SOURCES = 25
MOST_HEADER_LINES = 200
# Programs besides `weft` itself that may write to stdout and stderr.
PRINTERS = (
    "framework/host/probing/main.cpp",
)
PRINTING = re.compile(
    r"\bstd\s*::\s*w?(?:cout|cerr|clog)\b"
    r"|\b(?:stdout|stderr)\b"
    r"|(?<![\w.>])v?printf\s*\("
    r"|(?<![\w.>])(?:puts|putchar|perror)\s*\("
    r"|\b(?:fmt|std)\s*::\s*v?print(?:ln)?\s*\("
)
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*([<"])([^>"\n]+)[>"]', re.MULTILINE)
TOKENS = re.compile(
    r'(?P<raw>\bR"(?P<mark>[^\s()\\]{0,16})\(.*?\)(?P=mark)")'
    r"|(?P<comment>//(?:\\\n|[^\n])*|/\*.*?\*/)"
    r'|(?P<text>"(?:\\.|[^"\\\n])*"|(?<![0-9A-Fa-f])\'(?:\\.|[^\'\\\n])*\')',
    re.DOTALL,
)


class Violation(NamedTuple):
    """One broken rule; `file` is relative to the root, `line` counts from 1."""

    file: str
    line: int
    rule: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.rule}"


def blank(text: str, kinds: tuple[str, ...]) -> str:
    """Replaces the tokens of these kinds by spaces and keeps every line break."""

    def replace(match: re.Match) -> str:
        if match.lastgroup == "mark" or match.group("raw"):
            kind = "text"
        else:
            kind = "comment" if match.group("comment") else "text"
        if kind not in kinds:
            return match.group(0)
        return re.sub(r"[^\n]", " ", match.group(0))

    return TOKENS.sub(replace, text)


def line_of(text: str, offset: int) -> int:
    return text.count("\n", 0, offset) + 1


def scope_of(path: str) -> str:
    """Room, `abi`, `plugin:role/name` or `free` (tests, docs, scripts) of a path."""
    parts = PurePosixPath(path).parts
    if path.startswith(FREE):
        return "free"
    if path.startswith(TESTING):
        return "testing"
    if path in ("framework/include/weft/abi.h", "framework/include/weft/budget.h"):
        return "abi"
    if path.startswith("framework/cli/"):
        return "cli"
    for start, rooms in (("framework/include/weft/", INSTALLED), ("framework/", INTERNAL)):
        if path.startswith(start):
            room = str(PurePosixPath(path[len(start) :]).parent)
            return room if room in rooms else "nowhere"
    if parts[0] == "plugins":
        return f"plugin:{parts[1]}/{parts[2]}" if len(parts) > 3 else "nowhere"
    return "free"


def folder_of(room: str) -> str:
    return f"framework/include/weft/{room}" if room in INSTALLED else f"framework/{room}"


def may_include(room: str) -> set[str]:
    """The rooms whose headers a room may include, besides its own."""
    allowed = set()
    for word in LAYERS[room].split():
        allowed |= {each for each in LAYERS if each == word or each.startswith(word + "/")}
    return allowed - {room}


def lists_of(room: str) -> list[str]:
    """The two lists that the README of a room holds: whom it may include, and who it."""
    users = sorted(each for each in LAYERS if each != room and room in may_include(each))
    users += ["plugins"] if room in PLUGIN_LAYERS else []
    users += ["tests"] if room == "testing" else []

    def line(what: str, rooms: list[str], none: str) -> str:
        return f"{what}: {', '.join(f'`{r}`' if r in LAYERS else r for r in rooms) or none}."

    return [
        line("May include", sorted(may_include(room)), "nothing of ours"),
        line("Included by", users, "nothing"),
    ]


def is_test(path: str) -> bool:
    """True for tests of any kind: tests/ and the folder tests/ of a plugin."""
    return "tests" in PurePosixPath(path).parts[:-1]


def is_tool(path: str) -> bool:
    """True for programs that draw or convert data and are no part of a plugin's library."""
    return "tools" in PurePosixPath(path).parts[:-1]


class Tree:
    """The sources under a root, and the check of each rule on them."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self.files = sorted(self._walk())
        self.ours = [
            f for f in self.files if f.startswith(("framework/", "plugins/"))
        ]

    def _walk(self) -> Iterator[str]:
        if (self.root / "CMakeLists.txt").is_file():
            yield "CMakeLists.txt"
        for room in ROOMS:
            for folder, folders, names in os.walk(self.root / room):
                folders[:] = [
                    d for d in folders if not d.startswith((".", "build", "__pycache__", "node_modules"))
                ]
                for name in names:
                    path = Path(folder) / name
                    is_source = path.suffix in CODE | SCRIPTS or name == "CMakeLists.txt"
                    if is_source and path.is_file():
                        yield path.relative_to(self.root).as_posix()

    def check(self) -> list[Violation]:
        found: list[Violation] = []
        for path in self.files:
            text = (self.root / path).read_text(encoding="utf-8", errors="replace")
            found += self._check_head(path, text)
            if Path(path).suffix not in CODE or scope_of(path) == "free":
                continue
            if scope_of(path) == "nowhere":
                found.append(Violation(path, 1, "stands in no room and in no plugin's folder"))
                continue
            found += self._check_includes(path, blank(text, ("comment",)))
            found += self._check_printing(path, blank(text, ("comment", "text")))
        return found

    def check_rooms(self) -> Iterator[Violation]:
        """Each room says what it is, and no folder has more than a reader takes in at once."""
        sources = [f for f in self.files if Path(f).suffix in CODE]
        folders = {str(PurePosixPath(f).parent) for f in sources}
        for folder in sorted(folders):
            count = sum(str(PurePosixPath(f).parent) == folder for f in sources)
            if count > MOST_SOURCES:
                yield Violation(folder, 1, f"has {count} sources, more than {MOST_SOURCES}")
        for path in sources:
            if path.endswith(".hpp") and not is_test(path):
                lines = (self.root / path).read_text(encoding="utf-8").count("\n")
                if lines > MOST_HEADER_LINES:
                    yield Violation(path, lines, f"a header of more than {MOST_HEADER_LINES} lines")
        for room in sorted({scope_of(f) for f in sources} & set(LAYERS)):
            yield from self._check_readme(room)

    def _check_readme(self, room: str) -> Iterator[Violation]:
        page = f"{folder_of(room)}/README.md"
        if not (self.root / page).is_file():
            yield Violation(page, 1, "is missing: what lives there, whom it may include, who it")
            return
        text = (self.root / page).read_text(encoding="utf-8")
        paragraphs = {" ".join(part.split()) for part in text.split("\n\n")}
        for line in lists_of(room):
            if line not in paragraphs:
                yield Violation(page, 1, f"must say '{line}'")

    def _check_head(self, path: str, text: str) -> Iterator[Violation]:
        lines = text.split("\n")
        first = 1 if lines[0].startswith("#!") else 0
        head = lines[first] if len(lines) > first else ""
        if not re.match(r"(//|#|/\*) ?SPDX-License-Identifier: Apache-2\.0\b", head):
            rule = "the first line must be 'SPDX-License-Identifier: Apache-2.0' in a comment"
            yield Violation(path, first + 1, rule)
        if path.endswith(".hpp") and not re.search(r"^#pragma once$", text, re.MULTILINE):
            yield Violation(path, 1, "a header must contain '#pragma once'")

    def _check_includes(self, path: str, code: str) -> Iterator[Violation]:
        for match in INCLUDE.finditer(code):
            quoted, name = match.group(1) == '"', match.group(2).strip()
            line = line_of(code, match.start(1))
            targets = self._targets(path, name, quoted)
            if targets:
                rule = self._rule_for_spelling(path, name, targets, quoted)
                rule = rule or self._rule_for_ours(path, name, targets)
            else:
                rule = self._rule_for_library(path, name)
            if rule:
                yield Violation(path, line, rule)

    def _targets(self, path: str, name: str, quoted: bool) -> list[str]:
        """Paths of this tree that the include may mean; empty for a foreign header."""
        if name.startswith("weft/"):
            return ["framework/include/" + name]
        if quoted:
            beside = os.path.normpath(os.path.join(os.path.dirname(path), name))
            if ".." in PurePosixPath(name).parts or beside in self.ours:
                return [beside]
        return [f for f in self.ours if f == name or f.endswith("/" + name)]

    def _rule_for_spelling(self, path: str, name: str, targets: list[str], quoted: bool) -> str:
        """Headers of rooms are named by their rooms, wherever the includer stands."""
        if not path.startswith(ROOTS):
            return ""
        if quoted and name.startswith("weft/"):
            return f"include {name} as <{name}>"
        spelt = {f"{start}{name}" for start in ("framework/include/", "framework/", "plugins/")}
        return "" if spelt & set(targets) else f"include {name} as ROOM/{PurePosixPath(name).name}"

    def _rule_for_ours(self, path: str, name: str, targets: list[str]) -> str:
        rules = [self._rule_for_target(path, name, scope_of(target)) for target in targets]
        return "" if "" in rules else rules[0]

    def _rule_for_target(self, path: str, name: str, target: str) -> str:
        scope = scope_of(path)
        if target == scope:
            return ""
        if target == "abi":
            ok = path.startswith(ABI_READERS)
            return "" if ok else f"must not include {name}: only core/params, sdk and host read it"
        if scope == "abi":
            return f"abi.h must not include {name}: it includes nothing of this tree"
        if scope.startswith("plugin:"):
            return self._rule_for_plugin(path, name, target)
        allowed = may_include(scope)
        if target in SHARED_PLUGIN_CODE.get(scope, ()):
            return ""
        if target in allowed or (path.startswith("framework/kit/testing/") and target in LAYERS):
            return ""
        what = f"{scope} must not include {name} ({target})"
        return f"{what}; it may include {', '.join([scope] + sorted(allowed))}"

    def _rule_for_plugin(self, path: str, name: str, target: str) -> str:
        if target in PLUGIN_LAYERS or (target == "testing" and is_test(path)):
            return ""
        if target in SHARED_PLUGIN_CODE.get(scope_of(path), ()):
            return ""
        if target.startswith("plugin:common/"):
            return ""
        if target in {f"plugin:{role}/common" for role in self._roles_of(path)}:
            return ""
        if target.startswith("plugin:"):
            return f"a plugin must not include another plugin: {name} ({target[7:]})"
        if target == "testing":
            return f"only the tests of a plugin may include {name} (testing)"
        allowed = ", ".join(PLUGIN_LAYERS)
        return f"a plugin must not include {name} ({target}); it may include {allowed}"

    def _roles_of(self, path: str) -> set[str]:
        """Roles of the plugin's folder and of the other components that its library holds."""
        role, name = PurePosixPath(path).parts[1:3]
        roles = {role}
        for file in self.ours:
            if file.startswith(f"plugins/{role}/{name}/") and not is_test(file):
                text = (self.root / file).read_text(encoding="utf-8", errors="replace")
                roles |= set(re.findall(r'WEFT_COMPONENT\([^,]*,\s*"([a-z]+)/', text))
        return roles

    def _rule_for_library(self, path: str, name: str) -> str:
        for library, pattern, allowed in LIBRARIES:
            if re.match(pattern, name) and not path.startswith(allowed):
                return f"must not include {library} ({name}); allowed in {' '.join(allowed)}"
        if re.match(r"(gtest|gmock)/", name) and not (is_test(path) or path.startswith(TESTING)):
            return f"only tests and testing may include GoogleTest ({name})"
        if scope_of(path) == "geometry" and "/" in name:
            if not re.match(r"(unsupported/)?Eigen/", name):
                return f"geometry uses Eigen only, not {name}"
        return ""

    def _check_printing(self, path: str, code: str) -> Iterator[Violation]:
        if scope_of(path) == "cli" or path in PRINTERS or is_test(path) or is_tool(path):
            return
        for match in PRINTING.finditer(code):
            what = match.group(0).rstrip("( ")
            yield Violation(path, line_of(code, match.start()), f"only the program prints: {what}")


def main(arguments: list[str]) -> int:
    if len(arguments) != 1 or not (Path(arguments[0]) / "framework").is_dir():
        print("usage: include_rules.py ROOT (the folder that holds framework/)", file=sys.stderr)
        return 2
    tree = Tree(Path(arguments[0]))
    violations = tree.check() + list(tree.check_rooms())
    for violation in violations:
        print(violation)
    print(f"{len(violations)} violations in {len(tree.files)} files")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
