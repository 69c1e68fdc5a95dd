#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Does what docs/tutorials/my-filter-against-nine.md says: tutorial_test.py BUILD ROOT

Its files (`<!-- file: NAME -->` stands before each) and its shell blocks are one script, in the page's
order, which runs in an empty home folder whose `weft` is this repository with its build; commands in the
text are checked only. The first thing that the report says must be an answer: which filters are better.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

PAGE = "docs/tutorials/my-filter-against-nine.md"
FURTHER = re.compile(r"`weft ablate (against_nine\.yaml [^`]*)`")
FILE = re.compile(r"<!-- file: ([\w.]+)")
MOST_LINES = 60  # lines of the filter


def script_of(page):
    """The page as one shell script, and the files in it."""
    script, files = [], {}
    blocks = re.finditer(r"^([^\n]*)\n```(\w+)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    for before, language, text in (block.groups() for block in blocks):
        file = FILE.match(before)
        if file:
            files[file[1]] = text
            script.append(f"cat > {file[1]} <<'END OF FILE'\n{text}END OF FILE\n")
        elif language == "sh":
            script.append(text)
    script += [f"weft check {words}\n" for words in FURTHER.findall(page)]
    return "".join(script), files


class Tutorial(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.home = pathlib.Path(folder.name)
        (self.home / "weft/build").mkdir(parents=True)
        (self.home / "weft/build/release").symlink_to(BUILD)
        (self.home / "weft/pipelines").symlink_to(ROOT / "pipelines")

    def test_answers_whether_my_filter_is_better(self):
        script, files = script_of((ROOT / PAGE).read_text(encoding="utf-8"))
        self.assertEqual(list(files), ["local_affine.cpp", "CMakeLists.txt", "against_nine.yaml"])
        self.assertLessEqual(files["local_affine.cpp"].count("\n"), MOST_LINES)
        environment = {name: value for name, value in os.environ.items()
                       if not name.startswith("WEFT_")} | {"HOME": str(self.home)}
        start = time.monotonic()
        done = subprocess.run(["bash", "-eu", "-c", script], cwd=self.home, env=environment,
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              check=False)
        minutes = (time.monotonic() - start) / 60
        self.assertEqual(done.returncode, 0, done.stdout)
        self.assertIn("120 cells (120 distinct): 120 done, 0 failed, 0 left", done.stdout)
        results = self.home / "my_filter/ablations/against_nine"
        tables = (results / "report/tables.md").read_text(encoding="utf-8")
        verdict = next(line for line in tables.splitlines() if line.startswith("- **filter**"))
        print(f"{minutes:.1f} minutes: {verdict}")
        self.assertNotIn("oo few sequences", verdict)
        self.assertRegex(verdict, r"etter than local\\_affine in F1 of kept matches: \w")
        page = (results / "report.html").read_text(encoding="utf-8")
        first = re.sub(r"<[^>]*>", "", page.partition("<body")[2])[:2000]
        self.assertIn("etter than local_affine in F1", first, "it stands on the first screen")


if __name__ == "__main__":
    BUILD, ROOT = (pathlib.Path(word).resolve() for word in sys.argv[1:3])
    unittest.main(argv=sys.argv[:1])
