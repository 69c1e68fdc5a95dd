#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Links small libraries, right and wrong, and expects the wrong ones to be named."""

import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

SCRIPT = Path(__file__).resolve().parent / "exported_symbols.py"
COMPILER = os.environ.get("CXX", "c++")
TABLE = 'extern "C" { extern const int weft_library; const int weft_library = 1; }\n'


def link(folder: Path, name: str, code: str, *flags: str) -> None:
    command = [COMPILER, "-x", "c++", "-", "-x", "none", "-shared", "-fPIC"]
    command += ["-o", str(folder / name), *flags]
    subprocess.run(command, input=code, text=True, check=True)


def check(folder: Path) -> subprocess.CompletedProcess:
    command = [sys.executable, str(SCRIPT), str(folder)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


class ExportedSymbols(unittest.TestCase):
    def setUp(self) -> None:
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = Path(self.scratch.name)

    def test_accepts_a_library_with_the_one_symbol(self) -> None:
        link(self.folder, "filters_right.so", TABLE)
        self.assertEqual(check(self.folder).returncode, 0)

    def test_names_a_second_symbol(self) -> None:
        link(self.folder, "filters_right.so", TABLE)
        link(self.folder, "filters_wrong.so", TABLE + "int leaked() { return 1; }\n")
        result = check(self.folder)
        self.assertEqual(result.returncode, 1)
        self.assertIn("filters_wrong.so: exports 1 more symbols (_Z6leakedv)", result.stdout)
        self.assertNotIn("filters_right.so", result.stdout)

    def test_names_a_missing_table(self) -> None:
        link(self.folder, "filters_empty.so", "static int hidden;\n")
        result = check(self.folder)
        self.assertEqual(result.returncode, 1)
        self.assertIn("filters_empty.so: does not export weft_library", result.stdout)

    def test_names_a_library_of_the_host(self) -> None:
        elsewhere = self.folder / "host"
        elsewhere.mkdir()
        link(elsewhere, "libweft_host.so", "int host() { return 1; }\n")
        flags = ("-Wl,--no-as-needed", f"-L{elsewhere}", "-lweft_host")
        link(self.folder, "filters_wrong.so", TABLE, *flags)
        result = check(self.folder)
        self.assertEqual(result.returncode, 1)
        self.assertIn("needs libweft_host.so", result.stdout)

    def test_names_a_look_at_the_clock_of_the_day(self) -> None:
        code = TABLE + "#include <chrono>\nusing namespace std::chrono;\n"
        steady = "static auto now() { return steady_clock::now(); } static auto start = now();\n"
        link(self.folder, "filters_right.so", code + steady)
        link(self.folder, "filters_wrong.so", code + steady.replace("steady", "system"))
        result = check(self.folder)
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stdout, r"filters_wrong.so: calls _ZNSt6chrono\w+system_clock\w+, ")
        self.assertNotIn("filters_right.so", result.stdout)

    def test_refuses_a_folder_without_plugins(self) -> None:
        self.assertEqual(check(self.folder).returncode, 2)


if __name__ == "__main__":
    unittest.main()
