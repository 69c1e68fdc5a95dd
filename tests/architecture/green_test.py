#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Changes what is behind a step and expects that it is due again, and only then."""

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


class GreenTest(unittest.TestCase):
    def setUp(self) -> None:
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.root = Path(self.scratch.name).resolve()
        for patch in (mock.patch.object(green, "ROOT", self.root),
                      mock.patch.object(green, "TOOLS", (("echo", "compiler 12"),)),
                      mock.patch.dict(os.environ, {"WEFT_DATA": ""})):
            patch.start()
            self.addCleanup(patch.stop)
        subprocess.run(["git", "init", "--quiet", str(self.root)], check=True)
        self.write("framework/src/a.cpp", "int a;\n")
        self.write("plugins/filters/near/README.md", "text\n")

    def write(self, path: str, text: str) -> None:
        (self.root / path).parent.mkdir(parents=True, exist_ok=True)
        (self.root / path).write_text(text)

    def said(self, *arguments: str) -> tuple[int, str]:
        green.content.cache_clear()
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            status = green.main(list(arguments))
        return status, out.getvalue().strip()

    def sources(self) -> str:
        return self.said("sources", "tsan")[1]

    def test_says_when_a_step_passed_on_the_same_content(self) -> None:
        before = self.sources()
        self.assertEqual(self.said("since", "tsan", before), (1, ""))
        self.assertEqual(self.said("record", "tsan", before), (0, ""))
        status, when = self.said("since", "tsan", self.sources())
        self.assertEqual(status, 0)
        self.assertRegex(when, r"^\d{4}-\d\d-\d\d \d\d:\d\d$")
        self.assertEqual(self.said("since", "tsan", "other")[0], 1)
        self.assertEqual(self.said("since", "tsan", "")[0], 1)

    def test_sees_sources_that_change_come_and_go(self) -> None:
        hashes = [self.sources()]
        self.write("framework/src/a.cpp", "long a;\n")
        hashes.append(self.sources())
        self.write("tests/unit/b_test.cpp", "")
        hashes.append(self.sources())
        (self.root / "framework/src/a.cpp").unlink()
        hashes.append(self.sources())
        self.assertEqual(len(set(hashes)), 4)

    def test_sees_another_compiler_and_other_data(self) -> None:
        before = self.sources()
        with mock.patch.object(green, "TOOLS", (("echo", "compiler 13"),)):
            self.assertNotEqual(self.sources(), before)
        with mock.patch.dict(os.environ, {"WEFT_DATA": "/data"}):
            self.assertNotEqual(self.sources(), before)

    def test_does_not_mind_pages_and_what_is_built(self) -> None:
        self.write(".gitignore", "/build/\n")
        before = self.sources()
        self.write("plugins/filters/near/README.md", "other text\n")
        self.write("build/release/a.cpp", "")
        self.assertEqual(self.sources(), before)

    def test_forgets_what_passed_before_another_content_did(self) -> None:
        store = green.Green(self.root / "build" / "x.green")
        store.record("a batch", "1")
        store.record("b", "1")
        store.record("a batch", "2")
        again = green.Green(self.root / "build" / "x.green")
        self.assertIsNone(again.since("a batch", "1"))
        self.assertIsNotNone(again.since("a batch", "2"))
        self.assertIsNotNone(again.since("b", "1"))

    def test_remembers_single_tests_that_passed_on_the_same_content(self) -> None:
        log = self.root / "ctest.log"
        log.write_text("      Start  7: a_test\n"
                       " 1/3 Test  #7: a_test ........................   Passed    0.62 sec\n"
                       " 2/3 Test #17: b_test ........................***Failed    0.62 sec\n"
                       " 3/3 Test #18: c_test ........................***Skipped   0.00 sec\n"
                       "50% tests passed, 1 tests failed out of 2\n")
        now = self.hashes("a_test", "b_test", "c_test")
        self.assertEqual(self.said("passed", "tests", now, "asan-quick"), (0, ""))
        self.assertEqual(self.said("tests", "tests", now, "asan-quick", str(log)), (0, ""))
        self.assertEqual(self.said("passed", "tests", now, "asan-quick"), (0, "a_test"))
        self.assertEqual(self.said("passed", "tests", now, "release-quick"), (0, ""))
        gone = str(self.root / "no.log")
        self.assertEqual(self.said("tests", "tests", gone, "asan-quick", str(log)), (0, ""))
        self.assertEqual(self.said("passed", "tests", gone, "asan-quick"), (0, ""))
        self.assertEqual(self.said("tests", "tests", now, "asan-quick", gone), (0, ""))
        self.write("framework/src/a.cpp", "long a;\n")
        other = self.hashes("a_test", "b_test", "c_test")
        self.assertEqual(self.said("passed", "tests", other, "asan-quick"), (0, ""))

    def hashes(self, *tests: str) -> str:
        """The file that `each` writes for a build folder with these tests: a_test is compiled from
        x/first.cpp and read x/near.hpp, and the library from framework/src/a.cpp."""
        build = self.root / "build/asan"
        entries, deps = [], ""
        for target, file, header in (("a_test", "x/first.cpp", "x/near.hpp"),
                                     ("library", "framework/src/a.cpp", "framework/src/a.hpp")):
            unity = build / f"x/CMakeFiles/{target}.dir/Unity/unity_0_cxx.cxx"
            self.write(str(unity.relative_to(self.root)),
                       f'/* made */\n#include "{self.root}/{file}"\n')
            entries.append({"file": str(unity), "directory": str(build),
                            "command": "c++ -include y/CMakeFiles/y.dir/y.hxx "
                                       f"-o x/CMakeFiles/{target}.dir/u.o -c {unity}"})
            deps += (f"x/CMakeFiles/{target}.dir/u.o: #deps 2, deps mtime 1 (VALID)\n"
                     f"    {self.root}/{file}\n    {self.root}/{header}\n\n")
        self.write("build/asan/compile_commands.json", json.dumps(entries))
        shown = {"tests": [{"name": test, "command": ["python3", str(self.root / "x" / f"{test}.py")]}
                           for test in tests]}
        shown["tests"].append({"name": "all", "command": ["codespell", str(self.root)]})
        shown["tests"].append({"name": "kept", "command": [
            "python3", str(self.root / "tests/architecture/kept_test.py")]})
        answer = green.output_of

        def output_of(*command: str) -> str:
            fakes = {"ctest": json.dumps(shown), "ninja": deps}
            return fakes.get(command[0]) or answer(*command)

        with mock.patch.object(green, "output_of", output_of):
            printed = self.said("each", "tests", str(build))[1]
        self.write("build/asan/log.sources", printed + "\n")
        return str(build / "log.sources")

    def test_a_test_is_due_by_what_it_can_read(self) -> None:
        self.write(".gitignore", "/build/\n")
        for file in ("x/first.cpp", "x/near.hpp", "framework/src/a.hpp", "x/b_test.py", "x/data.yaml",
                     "scripts/green.py", "tests/architecture/kept_test.py"):
            self.write(file, "1")
        tests = ["a_test", "b_test"]
        before = green.listed(self.hashes(*tests))
        for file, due in (("x/first.cpp", {"a_test", "all"}), ("x/near.hpp", {"a_test", "all"}),
                          ("x/b_test.py", {"b_test", "all"}), ("scripts/green.py", {"kept", "all"}),
                          ("framework/src/a.cpp", {"a_test", "b_test", "kept", "all"}),
                          ("framework/src/a.hpp", {"a_test", "b_test", "kept", "all"}),
                          ("x/data.yaml", {"a_test", "b_test", "kept", "all"})):
            text = (self.root / file).read_text()
            self.write(file, "2")
            now = green.listed(self.hashes(*tests))
            self.assertEqual({test for test in now if now[test] != before[test]}, due, file)
            self.write(file, text)
        self.assertEqual(green.listed(self.hashes(*tests)), before)

    def test_minds_pages_where_tests_read_them(self) -> None:
        before = self.said("sources", "tests")[1]
        self.write("plugins/filters/near/README.md", "other text\n")
        self.assertNotEqual(self.said("sources", "tests")[1], before)

    def test_refuses_what_it_does_not_know(self) -> None:
        for arguments in ((), ("sources",), ("sources", "release"), ("since", "tsan"),
                          ("forget", "tsan", "1")):
            self.assertEqual(self.said(*arguments)[0], 2)


if __name__ == "__main__":
    unittest.main()
