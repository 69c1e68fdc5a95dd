#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Plants a built tree, changes it, and expects clang-tidy on the batches concerned only."""

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
import green  # noqa: E402
import tidy  # noqa: E402

# Ninja tells what was recorded; clang-tidy notes the batch and minds the word PLANTED in its files.
NINJA = '#!/bin/sh\ncat "$2/deps.txt"\n'
CLANG_TIDY = """#!/bin/sh
[ "$1" != --version ] || { echo "version 14"; exit 0; }
for batch; do :; done
echo "$batch" >>"$CALLS"
for file in $(sed -n 's/^#include "\\(.*\\)"/\\1/p' "$batch"); do
  ! grep -q PLANTED "$file" || { echo "$file:1:1: error: planted"; exit 1; }
done
"""
SOURCES = {
    ".clang-tidy": "Checks: bugprone-*\n",
    ".gitignore": "/build/\n/bin/\n",
    "framework/include/weft/a.hpp": "int a();\n",
    "framework/src/one.cpp": "int one() { return 1; }\n",
    "framework/src/two.cpp": "#include <weft/a.hpp>\n",
    "plugins/filters/near/near.hpp": "int near();\n",
    "plugins/filters/near/near.cpp": '#include "near.hpp"\n',
    "plugins/filters/near/tests/near_test.cpp": "#include <weft/a.hpp>\n",
}
HOST, NEAR, TEST = "framework/host", "plugins/filters/near/near", "plugins/filters/near/near_test"
BATCHES = {
    HOST: ["framework/src/one.cpp", "framework/src/two.cpp"],
    NEAR: ["plugins/filters/near/near.cpp"],
    TEST: ["plugins/filters/near/tests/near_test.cpp"],
}
HEADERS = {HOST: "framework/include/weft/a.hpp", NEAR: "plugins/filters/near/near.hpp"}


class Tidy(unittest.TestCase):
    def setUp(self) -> None:
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = Path(scratch.name).resolve()
        self.build = self.root / "build" / "release"
        self.calls = self.root / "build" / "calls"
        identity = {f"GIT_{who}_{what}": "test@weft" for who in ("AUTHOR", "COMMITTER")
                    for what in ("NAME", "EMAIL")}
        path = f"{self.root / 'bin'}:{os.environ['PATH']}"
        for patch in (mock.patch.object(tidy, "ROOT", self.root),
                      mock.patch.object(green, "ROOT", self.root),
                      mock.patch.dict(os.environ, {"PATH": path, "CALLS": str(self.calls),
                                                   "GIT_CONFIG_GLOBAL": "/dev/null", **identity})):
            patch.start()
            self.addCleanup(patch.stop)
        self.plant()

    def plant(self) -> None:
        for path, text in SOURCES.items():
            self.write(path, text)
        for name, text in (("ninja", NINJA), ("clang-tidy", CLANG_TIDY)):
            self.write(f"bin/{name}", text)
            (self.root / "bin" / name).chmod(0o755)
        commands, record = [], ""
        for name, sources in BATCHES.items():
            unity = f"build/release/{self.batch(name)}"
            self.write(unity, "".join(f'#include "{self.root / each}"\n\n' for each in sources))
            command = (f"{os.environ.get('CXX', 'c++')} -I{self.root}/framework/include -o {name}.o"
                       f" -c {self.root / unity}")
            commands.append({"directory": str(self.build), "command": command,
                             "file": str(self.root / unity)})
            read = [f"../../{each}" for each in [*sources, *filter(None, [HEADERS.get(name)])]]
            record += f"{name}.o: #deps {len(read)}, deps mtime 1 (VALID)\n"
            record += "".join(f"    {each}\n" for each in [*read, "/usr/include/stdio.h"]) + "\n"
        self.write("build/release/compile_commands.json", json.dumps(commands))
        self.write("build/release/deps.txt", record)
        self.git("init", "--quiet", "--initial-branch=main")
        self.commit()

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def git(self, *arguments: str) -> None:
        subprocess.run(["git", "-C", str(self.root), *arguments], check=True)

    def commit(self) -> None:
        self.git("add", "--all")
        self.git("commit", "--quiet", "--allow-empty", "--message", "A change")

    def batch(self, name: str) -> str:
        return f"{Path(name).parent}/CMakeFiles/{Path(name).name}.dir/Unity/unity_0_cxx.cxx"

    def run_tidy(self, *arguments: str) -> tuple[int, str, list[str]]:
        """The exit status, what was said last, and the batches that clang-tidy read."""
        green.content.cache_clear()
        self.calls.write_text("")
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
            status = tidy.main([*arguments, "--jobs", "2", str(self.build)])
        names = {str(self.build / self.batch(name)): name for name in BATCHES}
        read = sorted(names[each] for each in self.calls.read_text().split())
        return status, (out.getvalue().splitlines() or [""])[-1], read

    def test_reads_each_batch_once_and_no_tests(self) -> None:
        status, said, read = self.run_tidy()
        self.assertEqual((status, read), (0, [HOST, NEAR]))
        self.assertRegex(said, r"^summary: ok: 2 of 2 batches, sources [0-9a-f]{12}$")
        status, said, read = self.run_tidy()
        self.assertEqual((status, read), (0, []))
        self.assertRegex(said, r"^summary: skipped: unchanged since its green run of "
                               r"\d{4}-\d\d-\d\d \d\d:\d\d, sources [0-9a-f]{12}$")
        self.assertEqual(self.run_tidy("--all")[2], [HOST, NEAR])

    def test_reads_a_batch_again_when_its_files_or_headers_change(self) -> None:
        self.run_tidy()
        self.write("plugins/filters/near/near.hpp", "long near();\n")
        status, said, read = self.run_tidy()
        self.assertEqual((status, read), (0, [NEAR]))
        self.assertIn("1 of 2 batches, 1 unchanged since they passed, sources ", said)
        self.write("framework/src/one.cpp", "int one() { return 2; }\n")
        self.assertEqual(self.run_tidy()[2], [HOST])
        self.write("plugins/filters/near/tests/near_test.cpp", "\n")
        self.assertEqual(self.run_tidy()[2], [])
        self.write(".clang-tidy", "Checks: misc-*\n")
        self.assertEqual(self.run_tidy()[2], [HOST, NEAR])

    def test_reads_what_failed_again_and_what_passed_beside_it_not(self) -> None:
        self.write("framework/src/one.cpp", "// PLANTED\n")
        status, said, read = self.run_tidy()
        self.assertEqual((status, read), (1, [HOST, NEAR]))
        self.assertEqual(said, "summary: FAILED: 1 of 2 batches")
        self.assertEqual(self.run_tidy()[2], [HOST])
        self.write("framework/src/one.cpp", "int one() { return 1; }\n")
        self.assertEqual(self.run_tidy()[::2], (0, [HOST]))

    def test_asks_the_compiler_where_the_build_is_out_of_date(self) -> None:
        record = self.build / "deps.txt"
        record.write_text(record.read_text().replace("VALID", "STALE"))
        self.run_tidy()
        self.write("framework/include/weft/a.hpp", "long a();\n")
        self.assertEqual(self.run_tidy()[2], [HOST])

    def test_finds_the_batches_that_hold_or_include_what_changed(self) -> None:
        self.write("framework/include/weft/a.hpp", "long a();\n")
        self.commit()
        status, said, read = self.run_tidy("--changed")
        self.assertEqual((status, read), (0, [HOST]))
        self.assertRegex(said, "^summary: ok: 1 of 2 batches, sources changed since [0-9a-f]+: 1, sources ")
        self.write("plugins/filters/near/near.cpp", "int near();\n")
        self.assertEqual(self.run_tidy("--changed")[2], [NEAR])  # not committed; the host passed
        self.assertEqual(self.run_tidy("--changed", "--all")[2], [HOST, NEAR])

    def test_has_nothing_to_do_where_only_tests_and_pages_changed(self) -> None:
        self.write("plugins/filters/near/tests/near_test.cpp", "\n")
        self.write("plugins/filters/near/README.md", "\n")
        self.commit()
        status, said, read = self.run_tidy("--changed")
        self.assertEqual((status, read), (0, []))
        self.assertRegex(said, "^summary: skipped: 0 of 2 batches, sources changed since .*: 0$")

    def test_compares_a_branch_with_where_it_left_main(self) -> None:
        self.git("switch", "--quiet", "--create", "branch")
        for path in ("framework/src/one.cpp", "plugins/filters/near/near.cpp"):
            self.write(path, "int f();\n")
            self.commit()
        self.assertEqual(self.run_tidy("--changed", "--all")[2], [HOST, NEAR])
        self.assertEqual(self.run_tidy("--changed", "--all", "--since", "HEAD~1")[2], [NEAR])

    def test_says_that_it_cannot_tell_where_nothing_is_before_the_commit(self) -> None:
        status, said, read = self.run_tidy("--changed")
        self.assertEqual((status, read), (0, []))
        self.assertIn("summary: NOT RUN: no earlier commit is known", said)

    def test_fails_where_it_cannot_run(self) -> None:
        self.assertEqual(self.run_tidy("--changed", "--since", "nowhere")[0], 2)
        (self.build / "compile_commands.json").unlink()
        status, said, _ = self.run_tidy()
        self.assertEqual(status, 2)
        self.assertIn("compile_commands.json", said)


if __name__ == "__main__":
    unittest.main()
