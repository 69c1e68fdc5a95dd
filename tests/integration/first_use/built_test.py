# SPDX-License-Identifier: Apache-2.0
"""Holds what `cmake --install` copies against what the target weft_installed builds.

usage: built_test.py BUILD CMAKE
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path


class Built(unittest.TestCase):
    build = Path()
    cmake = ""

    def installed(self) -> set[Path]:
        """The files of the build that installation scripts name."""
        files: set[Path] = set()
        for script in self.build.rglob("cmake_install.cmake"):
            for names in re.findall(r'FILES((?:\s+"[^"]+")+)', script.read_text()):
                files |= {Path(name) for name in re.findall(r'"([^"]+)"', names)}
        return {file for file in files if file.is_relative_to(self.build)}

    @unittest.skipUnless(shutil.which("ninja"), "needs ninja")
    def test_the_target_builds_every_file_that_is_installed(self) -> None:
        answer = subprocess.run(["ninja", "-C", str(self.build), "-t", "graph", "weft_installed"],
                                capture_output=True, text=True, check=True)
        made = {Path(label) if Path(label).is_absolute() else self.build / label
                for label in re.findall(r'label="([^"]+)"', answer.stdout)}
        # A configured file is not built and has no target.
        ruled = subprocess.run(["ninja", "-C", str(self.build), "-t", "targets", "all"],
                               capture_output=True, text=True, check=True)
        ours = {self.build / line.split(":")[0] for line in ruled.stdout.splitlines()}
        missing = sorted(str(path) for path in self.installed() & ours - made)
        self.assertFalse(missing, f"weft_installed does not build, but cmake installs: {missing}")
        self.assertGreater(len(self.installed() & made), 3)

    def test_an_installation_names_what_is_not_built_and_the_command_that_builds_it(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            lists = Path(folder, "installed")
            lists.mkdir()
            Path(lists, "runtime.txt").write_text("/nowhere/bin/weft\n")
            script = Path(__file__).parents[3] / "framework/cmake/CheckBuilt.cmake"
            ended = subprocess.run([self.cmake, f"-Dweft_build_folder={folder}", "-P", str(script)],
                                   capture_output=True, text=True, check=False)
            self.assertNotEqual(ended.returncode, 0)
            said = " ".join(ended.stderr.split())
            self.assertIn("/nowhere/bin/weft is not built. Build first:", said)
            self.assertIn(f"cmake --build {folder} --target weft_installed", said)
            of_python = subprocess.run(
                [self.cmake, f"-Dweft_build_folder={folder}", "-DCMAKE_INSTALL_COMPONENT=python", "-P",
                 str(script)], capture_output=True, text=True, check=False)
            self.assertEqual(of_python.returncode, 0, of_python.stderr)


if __name__ == "__main__":
    Built.build = Path(sys.argv[1])
    Built.cmake = sys.argv[2]
    unittest.main(argv=sys.argv[:1])
