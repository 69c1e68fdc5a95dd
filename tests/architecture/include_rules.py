#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks who includes whom, who prints, and the first lines of sources.

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
ROOMS = ("framework", "cli", "plugins", "tests", "docs", "scripts", ".ci")

# A layer may include itself and these.
LAYERS = {
    "core": "",
    "data": "core",
    "geometry": "core data",
    "sdk": "core data geometry",
    "testing": "core data geometry sdk host",
    "host": "core data geometry sdk",
    "pipeline": "core data geometry sdk host",
    "evaluation": "core data geometry sdk host pipeline",
    "cli": "core data geometry sdk host pipeline evaluation",
}
PLUGIN_LAYERS = ("core", "data", "geometry", "sdk")

# abi.h is not a layer: these path prefixes may name it. data/array.hpp owns the dtypes and the
# array layout, which are the contract's.
ABI_READERS = (
    "framework/include/weft/core/params",
    "framework/src/core/params",
    "framework/include/weft/data/array.hpp",
    "framework/include/weft/sdk/",
    "framework/src/sdk/",
    "framework/include/weft/host/",
    "framework/src/host/",
)

TESTING = ("framework/include/weft/testing/", "framework/src/testing/")
# Library, pattern of its includes, path prefixes that may include it. tests/ and docs/ are free.
LIBRARIES = (
    (
        "yaml-cpp",
        r"yaml-cpp/",
        (
            "framework/src/host/",
            "framework/src/pipeline/",
            "framework/src/evaluation/",
            "plugins/sources/",
        ),
    ),
    ("Boost.DLL", r"boost/dll", ("framework/src/host/",)),
    ("Boost", r"boost/", ("framework/src/", "framework/cli/", "cli/", "plugins/")),
    ("CGAL", r"CGAL/", ("plugins/",)),
    ("Embree", r"embree\d*/", ("plugins/",)),
    ("Ceres", r"ceres/", ("plugins/",)),
    ("OpenCL", r"(CL|OpenCL)/", ("plugins/",)),
    ("OpenCV", r"opencv2/", ("plugins/",) + TESTING),
)
# Programs besides `weft` itself that may write to stdout and stderr: the one that writes manifests.
PRINTERS = ("framework/src/sdk/describe_main.cpp", "framework/src/host/describe_main.cpp")
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
    """Layer, `abi`, `plugin:role/name` or `free` (tests, docs, scripts) of a path."""
    parts = PurePosixPath(path).parts
    if path.startswith("framework/include/weft/") or path.startswith("framework/src/"):
        inner = parts[3:] if parts[1] == "include" else parts[2:]
        if inner == ("abi.h",):
            return "abi"
        return inner[0] if len(inner) > 1 and inner[0] in LAYERS else "nowhere"
    if path.startswith("framework/cli/") or path.startswith("cli/"):
        return "cli"
    if parts[0] == "plugins":
        return f"plugin:{parts[1]}/{parts[2]}" if len(parts) > 3 else "nowhere"
    return "free"


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
            f for f in self.files if f.startswith(("framework/", "cli/", "plugins/"))
        ]

    def _walk(self) -> Iterator[str]:
        if (self.root / "CMakeLists.txt").is_file():
            yield "CMakeLists.txt"
        for room in ROOMS:
            for folder, folders, names in os.walk(self.root / room):
                folders[:] = [
                    d for d in folders if not d.startswith((".", "build", "__pycache__"))
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
                found.append(Violation(path, 1, "stands in no layer and in no plugin's folder"))
                continue
            found += self._check_includes(path, blank(text, ("comment",)))
            found += self._check_printing(path, blank(text, ("comment", "text")))
        return found

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
                rule = self._rule_for_ours(path, name, targets)
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
        allowed = LAYERS[scope].split()
        if target in allowed:
            return ""
        what = f"{scope} must not include {name} ({target})"
        return f"{what}; it may include {', '.join([scope] + allowed)}"

    def _rule_for_plugin(self, path: str, name: str, target: str) -> str:
        if target in PLUGIN_LAYERS or (target == "testing" and is_test(path)):
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
    violations = tree.check()
    for violation in violations:
        print(violation)
    print(f"{len(violations)} violations in {len(tree.files)} files")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
