#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes the sources of a small repository and expects only changes of code to be reported."""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import compare_tokens  # noqa: E402

CPP = '''// SPDX-License-Identifier: Apache-2.0
#include "a.hpp"
#define TWICE(x) ((x) + (x))  /* evaluates twice */
/// Adds one.
int next(int value) {  // a comment
  if (value < 1'000) print("small value");
  return value + 1;
}
'''
PYTHON = '''"""A module."""


def next_of(value):
    """Adds one."""
    # a comment
    return value + 1, f"small {value}"
'''


class CompareTokens(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name).resolve()
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.root)
        identity = {f"GIT_{role}_{field}": "test@weft" for role in ("AUTHOR", "COMMITTER")
                    for field in ("NAME", "EMAIL")}
        patch = mock.patch.dict(os.environ, {"GIT_CONFIG_GLOBAL": "/dev/null", **identity})
        patch.start()
        self.addCleanup(patch.stop)
        self.git("init", "--quiet", "--initial-branch=main")
        (self.root / "a.cpp").write_text(CPP)
        (self.root / "a.py").write_text(PYTHON)
        (self.root / "page.md").write_text("A page\n")
        self.commit()

    def git(self, *arguments: str) -> None:
        subprocess.run(["git", *arguments], check=True)

    def commit(self) -> None:
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message", "A change")

    def compare(self, *arguments: str) -> tuple[int, list[str]]:
        """The exit status and the reported differences."""
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = compare_tokens.main(list(arguments))
        return status, out.getvalue().splitlines()[:-1]

    def change(self, name: str, *changes: tuple[str, str]) -> tuple[int, list[str]]:
        """The comparison with HEAD after replacing texts of a file, which is then restored."""
        file = self.root / name
        before = text = file.read_text()
        for old, new in changes:
            self.assertIn(old, text)
            text = text.replace(old, new, 1)
        file.write_text(text)
        result = self.compare("HEAD")
        self.strict = self.compare("--strings", "HEAD")
        file.write_text(before)
        return result

    def test_ignores_text(self) -> None:
        for name, change in {
            "comment": ("a.cpp", ("// a comment", "// another \\\n comment of two lines")),
            "end of a directive": ("a.cpp", ("  /* evaluates twice */", " // twice")),
            "string": ("a.cpp", ('"small value"', '"below " R"x(a "thousand")x"\n "!"')),
            "line breaks": ("a.cpp", ("int next(int value) {", "int\nnext(\nint value)\n{")),
            "docstrings": ("a.py", ('"""Adds one."""', '"""Adds\n    one to `value`."""')),
            "no docstring": ("a.py", ('    """Adds one."""\n', "")),
            "Python comment": ("a.py", ("# a comment", "# another")),
            "Python string": ("a.py", ('f"small {value}"', '("below "\n            f"{value}")')),
            "page": ("page.md", ("A page", "Another page")),
        }.items():
            with self.subTest(name):
                self.assertEqual(self.change(*change), (0, []))

    def test_finds_changes_of_code(self) -> None:
        for change, expected in {
            ("a.cpp", ("return value + 1", "return number + 1")): "a.cpp:7: 'number', was 'value'",
            ("a.cpp", ("1'000", "1'001")): "a.cpp:6: \"1'001\", was \"1'000\"",
            ("a.cpp", ('"a.hpp"', '"b.hpp"')): "a.cpp:2: '\"b.hpp\"', was '\"a.hpp\"'",
            ("a.cpp", ("  /* evaluates twice */\n/// Adds one.\n", " ")):
                "a.cpp:3: 'int', was '<end of directive>'",
            ("a.cpp", ("  return value + 1;", "  // return value + 1;")): "a.cpp:8: '}', was 'return'",
            ("a.cpp", ("print(", "print('s', ")): "a.cpp:6: '<character>', was '<string>'",
            ("a.py", ("value + 1", "value - 1")): "a.py:7: '-', was '+'",
            ("a.py", ("    return", "    if value:\n        return")): "a.py:7: 'if', was 'return'",
            ("a.py", ('f"small {value}"', 'print(f"{value}")')): "a.py:7: 'print', was '<string>'",
            ("a.py", ("value):", "value:")): "a.py: cannot be read",
        }.items():
            with self.subTest(change=change):
                status, found = self.change(*change)
                self.assertEqual((status, len(found)), (1, 1))
                self.assertTrue(found[0].startswith(expected), found[0])

    def test_compares_strings_on_request(self) -> None:
        self.change("a.cpp", ('"small value"', '"small " "value"'), ("// a comment", ""))
        self.assertEqual(self.strict, (0, []))
        self.change("a.cpp", ('"small value"', '"small"'))
        self.assertEqual(self.strict, (1, ["a.cpp:6: '<string>small', was '<string>small value'"]))
        self.change("a.py", ("small {", "below {"))
        self.assertEqual(self.strict[0], 1)

    def test_reports_renamed_files(self) -> None:
        self.git("mv", "a.cpp", "b.cpp")
        self.commit()
        (self.root / "c.py").write_text("")
        self.assertEqual(self.compare("HEAD~1", "HEAD"),
                         (1, ["a.cpp: removed or renamed", "b.cpp: added"]))
        self.assertEqual(self.compare("HEAD"), (1, ["c.py: added"]))

    def test_compares_two_revisions(self) -> None:
        (self.root / "a.cpp").write_text(CPP.replace("a comment", "another comment"))
        self.commit()
        (self.root / "a.cpp").write_text(CPP.replace("next", "after"))
        self.assertEqual(self.compare("HEAD~1", "HEAD"), (0, []))
        self.assertEqual(self.compare("HEAD")[1], ["a.cpp:5: 'after', was 'next'"])

    def test_fails_on_an_unknown_revision(self) -> None:
        self.assertEqual(self.compare("nowhere")[0], 2)


if __name__ == "__main__":
    unittest.main()
