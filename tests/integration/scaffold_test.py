#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Begins plugins by `weft plugins new` and does with them what it says: scaffold_test.py BUILD quick|long

quick: the arguments that it refuses, what it writes for each role, and a filter, built and checked. long:
a plugin of each role, and one of an installed Weft, as a Debian package too.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

# The kinds that the command accepts, and the folder of each.
ROLES = {"source": "sources", "template": "templates", "detector": "detectors", "matcher": "matchers",
         "filter": "filters", "warp": "warps", "pass": "passes", "solver": "solvers", "stage": "stages", "sink": "sinks"}
PYTHON_ROLES = ("source", "template", "filter", "pass", "solver", "sink")
STAGES = ("detector", "matcher", "filter", "warp", "pass", "solver", "stage")


def run(words, folder, weft=None):
    """A command with the program in its path, which finds no plugins but those beside it."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("WEFT_")}
    environment["PATH"] = f"{weft or BUILD / 'bin'}:{environment['PATH']}"
    environment["CXXFLAGS"] = "-Werror"
    return subprocess.run(words, cwd=folder, env=environment, text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, check=False)


class InAFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name).resolve()

    def done(self, words, folder=None, weft=None):
        """What a command prints that must succeed."""
        ended = run(words, folder or self.folder, weft)
        self.assertEqual(ended.returncode, 0, f"{words}\n{ended.stdout}")
        return ended.stdout

    def begin(self, role, name, *more, weft=None):
        """Begins a plugin and returns the commands that it says are next."""
        said = self.done(["weft", "plugins", "new", role, name, *more], weft=weft)
        self.assertIn(f"{name}/{name}.{'py' if 'python' in more else 'c' if 'c' in more else 'cpp'}\n", said)
        return [line.strip() for line in said.splitlines() if line.startswith("  cmake ")]

    def check(self, role, name, *more, weft=None):
        """Begins a plugin and types what it says."""
        commands = self.begin(role, name, *more, weft=weft)
        self.assertEqual(len(commands), 2, commands)
        said = self.done(["bash", "-eu", "-c", "\n".join(commands)], weft=weft)
        for test in ("test", "contract", "pipeline", "page"):
            self.assertRegex(said, rf"_{test} \.+ +Passed", said)
        self.assertIn("100% tests passed, 0 tests failed out of 4", said)

    def run_of(self, role, name, component):
        """The folder of the run of its pipeline, in which it answered in each frame."""
        folder = self.folder / name / f"build/{ROLES[role]}_{component}_run"
        lines = [json.loads(line) for line in (folder / "frames.jsonl").read_text().splitlines()]
        frames = [line for line in lines if "stages" in line]
        self.assertGreaterEqual(len(frames), 3)
        for frame in frames:
            statuses = {stage["stage"]: stage["status"] for stage in frame["stages"]}
            if role in STAGES:
                self.assertEqual(statuses[ROLES[role]], "ok", frame)
            self.assertEqual(statuses["solvers"], "ok", frame)
        return folder


class Refusals(InAFolder):
    def refused(self, code, *words):
        ended = run(["weft", "plugins", "new", *words], self.folder)
        self.assertEqual(ended.returncode, code, ended.stdout)
        return ended.stdout.strip()

    def test_an_unknown_role_is_reported_with_a_suggestion_or_with_all(self):
        self.assertEqual(self.refused(2, "fitler", "mine"),
                         "error: no role 'fitler'; did you mean 'filter'?")
        self.assertEqual(self.refused(2, "thing", "mine"),
                         "error: no role 'thing'; there are: source, template, detector, matcher, filter, "
                         "warp, pass, stage, solver, sink")

    def test_an_illegal_name_is_reported_with_a_legal_one(self):
        for word, legal in (("My-Filter", "my_filter"), ("2fast", "fast"), ("a.b", "a_b")):
            said = self.refused(2, "filter", word)
            self.assertIn(f"'{word}' cannot be the name of a plugin", said)
            self.assertIn(f"did you mean '{legal}'?", said)
        self.assertIn("'ACME' cannot be the vendor of a plugin",
                      self.refused(2, "filter", "mine", "--vendor", "ACME"))
        self.assertIn("has more than 100 characters", self.refused(2, "filter", 100 * "a"))

    def test_an_unknown_language_is_reported_with_the_known_ones(self):
        self.assertEqual(self.refused(2, "filter", "mine", "--language", "fortran"),
                         "error: plugins in 'fortran' cannot be made yet; there are: c++, c, python")
        self.assertIn("in C cannot be begun yet", self.refused(2, "solver", "mine", "--language", "c"))
        self.assertEqual(self.refused(2, "filter", "mine", "--language", "pyhton"),
                         "error: plugins in 'pyhton' cannot be made yet; did you mean 'python'?")
        for role in ("detector", "matcher", "warp", "stage"):
            self.assertIn("in Python cannot be begun yet",
                          self.refused(2, role, "mine", "--language", "python"))
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_a_folder_that_holds_something_is_left_as_it_is(self):
        (self.folder / "mine").mkdir()
        (self.folder / "mine/notes").write_text("mine")
        said = self.refused(3, "filter", "mine")
        self.assertEqual(said, "error: mine: exists and is not an empty folder; choose another with --out")
        self.assertEqual(list((self.folder / "mine").iterdir()), [self.folder / "mine/notes"])

    def test_what_it_is_made_of_may_be_missing(self):
        alone = self.folder / "alone/bin"
        alone.mkdir(parents=True)
        (alone / "weft").write_bytes((BUILD / "bin/weft").read_bytes())
        (alone / "weft").chmod(0o755)
        ended = run(["weft", "plugins", "new", "filter", "mine"], self.folder, alone)
        self.assertEqual(ended.returncode, 3, ended.stdout)
        self.assertIn("package weft-dev", ended.stdout)


class Files(InAFolder):
    def test_each_role_has_the_same_files_and_its_own_names_in_them(self):
        for role, folder in ROLES.items():
            out = self.folder / folder
            self.done(["weft", "plugins", "new", folder, "my_own_2", "--vendor", "acme", "--out", str(out)])
            files = {str(file.relative_to(out)): file for file in out.rglob("*") if file.is_file()}
            self.assertEqual(sorted(files), sorted((
                ".gitignore", "CMakeLists.txt", "README.md", "my_own_2.cpp", "pipeline.yaml",
                "tests/my_own_2_test.cpp", "texture.png")))
            texts = {name: file.read_text(encoding="utf-8") for name, file in files.items()
                     if name != "texture.png"}
            for name, text in texts.items():
                for word in ("my_plugin", "MyPlugin", "roles/", "roles_"):
                    self.assertNotIn(word, text, f"{role}: {name}")
            self.assertRegex(texts["my_own_2.cpp"], rf'WEFT_PLUGIN\(\s*MyOwn2{role.title()}, "{folder}/acme.my_own_2"')
            self.assertIn(f"weft_add_plugin({folder}/acme.my_own_2", texts["CMakeLists.txt"])
            self.assertTrue(texts["README.md"].startswith(f"# {folder}/acme.my_own_2\n"))
            self.check_example(texts["README.md"], texts["pipeline.yaml"])

    def test_in_python_a_module_replaces_the_source(self):
        for role in PYTHON_ROLES:
            folder = ROLES[role]
            out = self.folder / folder
            self.done(["weft", "plugins", "new", role, "my_own_2", "--vendor", "acme", "--language", "python",
                       "--out", str(out)])
            files = {str(file.relative_to(out)): file for file in out.rglob("*") if file.is_file()}
            self.assertEqual(sorted(files), sorted((
                ".gitignore", "CMakeLists.txt", "README.md", "my_own_2.py", "pipeline.yaml",
                "tests/my_own_2_test.py", "texture.png")))
            module = files["my_own_2.py"].read_text(encoding="utf-8")
            self.assertIn(f'class MyOwn2{role.title()}(weft.', module)
            self.assertIn(f'id = "{folder}/acme.my_own_2"', module)
            for name in ("my_own_2.py", "tests/my_own_2_test.py", "CMakeLists.txt", "README.md"):
                self.assertNotIn("my_plugin", files[name].read_text(encoding="utf-8"))
            self.assertIn("python3-numpy", files["README.md"].read_text(encoding="utf-8"))

    def test_in_c_the_tests_are_those_of_the_role(self):
        self.done(["weft", "plugins", "new", "filter", "my_own_2", "--vendor", "acme", "--language", "c"])
        out = self.folder / "my_own_2"
        files = sorted(str(file.relative_to(out)) for file in out.rglob("*") if file.is_file())
        self.assertEqual(files, sorted((
            ".gitignore", "CMakeLists.txt", "README.md", "my_own_2.c", "pipeline.yaml",
            "tests/my_own_2_test.cpp", "texture.png")))
        self.assertIn('.id = "filters/acme.my_own_2"', (out / "my_own_2.c").read_text(encoding="utf-8"))
        self.assertIn("SOURCES my_own_2.c\n", (out / "CMakeLists.txt").read_text(encoding="utf-8"))

    def check_example(self, page, pipeline):
        """The page shows lines of the pipeline, which is run."""
        example = page.partition("```yaml\n")[2].partition("```")[0]
        indent = "  " if example.startswith("- ") else ""
        self.assertTrue(example)
        self.assertIn(textwrap.indent(example, indent), pipeline)


class AFilter(InAFolder):
    def test_is_built_and_checked_by_what_is_typed(self):
        self.check("filter", "mine")
        self.run_of("filter", "mine", "mine")
        page = self.folder / "mine/README.md"
        right = page.read_text(encoding="utf-8")
        page.write_text(right.replace("| 30 |", "| 20 |"), encoding="utf-8")
        ended = run(["ctest", "--test-dir", "mine/build", "-R", "page", "--output-on-failure"], self.folder)
        self.assertNotEqual(ended.returncode, 0, "a table that is wrong is told")
        self.assertIn("the table of filters/mine is out of date", ended.stdout)
        self.done(["cmake", "--build", "mine/build", "--target", "filters_mine_page"])
        self.assertEqual(page.read_text(encoding="utf-8"), right)


class InC(InAFolder):
    def test_filter(self):
        self.check("filter", "mine", "--language", "c")
        self.run_of("filter", "mine", "mine")


class InPython(InAFolder):
    """Where components in Python can be built."""

    def checked(self, role):
        if not (BUILD / "framework/python/libweft_python.a").exists():
            self.skipTest("components in Python are left out of this build")
        self.check(role, "mine", "--language", "python")
        return self.run_of(role, "mine", "mine")

    def test_filter(self):
        self.checked("filter")

    def test_pass(self):
        self.checked("pass")

    def test_solver(self):
        self.checked("solver")

    def test_source(self):
        self.checked("source")

    def test_template(self):
        self.checked("template")

    def test_sink(self):
        folder = self.checked("sink")
        self.assertEqual(sorted(file.name for file in (folder / "vertices").iterdir()),
                         ["000000.csv", "000001.csv", "000002.csv"])


class EachRole(InAFolder):
    def checked(self, role):
        self.check(role, "my_own", "--vendor", "acme")
        return self.run_of(role, "my_own", "acme.my_own")

    def test_source(self):
        self.checked("source")

    def test_template(self):
        self.checked("template")

    def test_detector(self):
        self.checked("detector")

    def test_matcher(self):
        self.checked("matcher")

    def test_filter(self):
        self.checked("filter")

    def test_warp(self):
        self.checked("warp")

    def test_pass(self):
        self.checked("pass")

    def test_solver(self):
        self.checked("solver")

    def test_stage(self):
        self.checked("stage")

    def test_sink(self):
        folder = self.checked("sink")
        self.assertEqual(sorted(file.name for file in (folder / "vertices").iterdir()),
                         ["000000.csv", "000001.csv", "000002.csv"])


class OfAnInstallation(InAFolder):
    def test_is_built_packed_and_installed(self):
        self.done(["cmake", "--install", str(BUILD), "--prefix", str(self.folder / "here")])
        (self.folder / "here").rename(self.folder / "elsewhere")
        weft = self.folder / "elsewhere/bin"
        self.check("solver", "mine", weft=weft)
        build = self.folder / "mine/build"
        self.done(["cpack"], build, weft)
        packed = self.done(["dpkg-deb", "--contents", str(next(build.glob("*.deb")))], weft=weft)
        for file in ("lib/weft/plugins/solvers_mine.so", "lib/weft/plugins/solvers_mine.plugin.yaml",
                     "share/doc/weft-solvers-mine/README.md"):
            self.assertIn(f"./usr/{file}\n", packed)
        self.done(["cmake", "--install", str(build), "--prefix", str(weft.parent)], weft=weft)
        self.assertIn("rounds", self.done(["weft", "plugins", "show", "solvers/mine"], weft=weft))


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv[1]).resolve()
    CASES = {"quick": (Refusals, Files, AFilter), "long": (EachRole, InC, InPython, OfAnInstallation)}[sys.argv[2]]
    loader = unittest.TestLoader()
    suite = unittest.TestSuite(loader.loadTestsFromTestCase(case) for case in CASES)
    sys.exit(0 if unittest.TextTestRunner(verbosity=2).run(suite).wasSuccessful() else 1)
