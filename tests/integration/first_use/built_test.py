# SPDX-License-Identifier: Apache-2.0
"""Holds what `cmake --install` copies against what scripts/demo.sh builds.

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
            if "_deps" in script.parts or "embedding" in script.parts:
                continue
            for name in re.findall(r'"([^"$;\n]+)"', script.read_text()):
                path = Path(name)
                if path.is_absolute() and path.is_relative_to(self.build) and path.suffix:
                    files.add(path)
        return files

    @unittest.skipUnless(shutil.which("ninja"), "needs ninja")
    def test_the_demo_builds_every_file_that_is_installed(self) -> None:
        answer = subprocess.run(["ninja", "-C", str(self.build), "-t", "graph", "weft_demo"],
                                capture_output=True, text=True, check=True)
        made = {Path(label) if Path(label).is_absolute() else self.build / label
                for label in re.findall(r'label="([^"]+)"', answer.stdout)}
        ruled = subprocess.run(["ninja", "-C", str(self.build), "-t", "targets", "all"],
                               capture_output=True, text=True, check=True)
        ours = {self.build / line.split(":")[0] for line in ruled.stdout.splitlines()}
        missing = sorted(str(path) for path in self.installed() & ours - made)
        self.assertEqual(missing, [], "install needs what weft_demo does not build")
        self.assertTrue(self.installed() & made)

    def test_an_installation_names_what_is_not_built_and_the_command_that_builds_it(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            lists = Path(folder, "installed")
            lists.mkdir()
            Path(lists, "runtime.txt").write_text("/nowhere/bin/weft\n")
            script = Path(__file__).parents[3] / "framework/cmake/CheckBuilt.cmake"
            ended = subprocess.run([self.cmake, f"-Dweft_build_folder={folder}", "-P", str(script)],
                                   capture_output=True, text=True, check=False)
            self.assertNotEqual(ended.returncode, 0)
            self.assertIn("/nowhere/bin/weft is not built. Build first:", ended.stderr)
            self.assertIn(f"cmake --build {folder} --target weft_installed", ended.stderr)
            of_python = subprocess.run(
                [self.cmake, f"-Dweft_build_folder={folder}", "-DCMAKE_INSTALL_COMPONENT=python", "-P",
                 str(script)], capture_output=True, text=True, check=False)
            self.assertEqual(of_python.returncode, 0, of_python.stderr)


if __name__ == "__main__":
    Built.build = Path(sys.argv[1])
    Built.cmake = sys.argv[2]
    unittest.main(argv=sys.argv[:1])
