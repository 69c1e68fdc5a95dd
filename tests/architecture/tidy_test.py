#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants a configured tree, changes it, and expects clang-tidy on the sources concerned only."""

import contextlib
import io
import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "scripts"))
import tidy  # noqa: E402

# Records the source, and reports the word PLANTED in it.
CLANG_TIDY = """#!/bin/sh
for source; do :; done
echo "$source" >>"$CALLS"
! grep -q PLANTED "$source" || { echo "$source:1:1: error: planted"; exit 1; }
"""
ONE, TWO = "framework/host/one.cpp", "framework/host/two.cpp"
NEAR, FAR = "plugins/filters/near/near.cpp", "plugins/filters/far/near_by.cpp"
TEST = "plugins/filters/near/tests/near_test.cpp"
TREE = {
    ".gitignore": "/build/\n/bin/\n",
    "framework/include/weft/a.hpp": "int a();\n",
    "framework/include/weft/b.hpp": "#include <weft/a.hpp>\n",
    ONE: "int one() { return 1; }\n",
    TWO: "#include <weft/b.hpp>\n",
    "plugins/filters/near/near.hpp": "int near();\n",
    NEAR: '#include "near.hpp"\n',
    FAR: '#include "filters/near/near.hpp"\n',
    TEST: "#include <weft/a.hpp>\n",
}


class Tidy(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name).resolve()
        self.build = self.root / "build" / "clang"
        self.calls = self.root / "build" / "calls"
        identity = {f"GIT_{who}_{what}": "test@weft" for who in ("AUTHOR", "COMMITTER")
                    for what in ("NAME", "EMAIL")}
        path = f"{self.root / 'bin'}:{os.environ['PATH']}"
        for patch in (mock.patch.object(tidy, "ROOT", self.root),
                      mock.patch.dict(os.environ, {"PATH": path, "CALLS": str(self.calls),
                                                   "GIT_CONFIG_GLOBAL": "/dev/null", **identity})):
            patch.start()
            self.addCleanup(patch.stop)
        for name, text in TREE.items():
            self.write(name, text)
        self.write("bin/clang-tidy", CLANG_TIDY)
        (self.root / "bin" / "clang-tidy").chmod(0o755)
        entries = [{"directory": str(self.build), "command": "", "file": str(self.root / name)}
                   for name in (ONE, TWO, NEAR, FAR, TEST)]
        self.write("build/clang/compile_commands.json", json.dumps(entries))
        self.git("init", "--quiet", "--initial-branch=main")
        self.commit()
        self.commit()

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def git(self, *arguments: str) -> None:
        subprocess.run(["git", "-C", str(self.root), *arguments], check=True)

    def commit(self) -> None:
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message", "A change")

    def run_tidy(self, *arguments: str) -> tuple[int, str, list[str]]:
        """The exit status, the last line, and the sources that clang-tidy read."""
        self.write("build/calls", "")
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = tidy.main([*arguments, "--jobs", "2", str(self.build)])
        read = sorted(os.path.relpath(each, self.root) for each in self.calls.read_text().split())
        return status, (out.getvalue().splitlines() or [""])[-1], read

    def test_reads_all_sources_and_no_tests(self) -> None:
        status, said, read = self.run_tidy("--all")
        self.assertEqual((status, read), (0, sorted([ONE, TWO, NEAR, FAR])))
        self.assertEqual(said, "summary: ok: 4 of 4 sources")

    def test_reads_what_changed_and_a_source_for_each_header_that_changed(self) -> None:
        for changed, expected in ((ONE, [ONE]), ("framework/include/weft/a.hpp", [TWO]),
                                  ("plugins/filters/near/near.hpp", [NEAR]), (TEST, [])):
            with self.subTest(changed):
                self.write(changed, TREE[changed] + "// changed\n")
                status, said, read = self.run_tidy("--since", "HEAD~1")
                self.assertEqual((status, read), (0, expected))
                self.assertRegex(said, "^summary: ok: [01] of 4 sources, files changed since ")
                self.commit()
                self.assertEqual(self.run_tidy("--since", "HEAD~1")[2], expected)
                self.commit()

    def test_leaves_out_a_file_that_is_gone(self) -> None:
        (self.root / ONE).unlink()
        self.assertEqual(self.run_tidy("--since", "HEAD~1")[::2], (0, []))

    def test_fails_where_something_is_found(self) -> None:
        self.write(ONE, "// PLANTED\n")
        status, said, read = self.run_tidy("--since", "HEAD~1")
        self.assertEqual((status, said, read), (1, "summary: FAILED: 1 of 1 sources", [ONE]))

    def test_fails_where_it_cannot_run(self) -> None:
        self.assertEqual(self.run_tidy("--since", "nowhere")[0], 2)
        (self.build / "compile_commands.json").unlink()
        status, said, _ = self.run_tidy("--all")
        self.assertEqual(status, 2)
        self.assertIn("compile_commands.json", said)


if __name__ == "__main__":
    unittest.main()
