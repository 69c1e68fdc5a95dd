#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names, types and docstrings of the package against what it is: python_stubs_test.py ROOT"""

import ast
import importlib.util
import inspect
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import weft
from weft.programs import _pipeline

ROOT = pathlib.Path(sys.argv[1])
PACKAGE = pathlib.Path(weft.__file__).parent
# The few that need no words: they are made by their class.
MADE = {"__init__", "__repr__", "_repr_html_", "__len__", "__iter__", "__getitem__", "__contains__", "__str__", "__enter__", "__exit__"}
SHAPED = ("vertices_m", "faces", "flat_px", "texture", "mask", "covariance_m2", "source", "true_points_m", "matrix",
          "project", "states", "confidences", "errors_mm", "stage", "metric")


def stubs_in(file):
    return ast.parse(file.read_text(encoding="utf-8"))


def public_names():
    return {name for name in dir(weft) if not name.startswith("_") and not inspect.ismodule(getattr(weft, name))}


class Stubs(unittest.TestCase):
    def test_name_all_that_is_public_where_it_is(self):
        named = {}
        for node in stubs_in(PACKAGE / "__init__.pyi").body:
            self.assertIsInstance(node, ast.ImportFrom)
            for each in node.names:
                self.assertEqual(each.name, each.asname, "a stub tells `x as x` only")
                named[each.name] = node.module
        self.assertEqual(set(named), public_names())
        for name, module in named.items():
            self.assertIs(getattr(importlib.import_module(module), name), getattr(weft, name))
        self.assertTrue((PACKAGE / "py.typed").exists())

    def test_of_the_compiled_part_have_its_methods_and_their_arguments(self):
        stubs = [node for node in stubs_in(PACKAGE / "programs/_pipeline.pyi").body if isinstance(node, ast.ClassDef)]
        self.assertEqual([stub.name for stub in stubs], ["Lens", "OpenedPipeline"])
        for stub in stubs:
            methods = {each.name: len(each.args.args) for each in stub.body}
            made = getattr(_pipeline, stub.name)
            self.assertEqual(set(methods), {name for name in vars(made) if not name.startswith("__")} | {"__init__"})
            for name, arguments in methods.items():
                line = getattr(made, name).__doc__.splitlines()[0]
                self.assertEqual(line.count(":") + line.count("*args") * 9, arguments, line)


class Words(unittest.TestCase):
    def documented(self, name, value):
        self.assertTrue(inspect.getdoc(value), f"{name} has no docstring")
        if inspect.isclass(value) and not issubclass(value, BaseException):
            for member, of_class in vars(value).items():
                if callable(of_class) or isinstance(of_class, (property, classmethod)) or hasattr(of_class, "attrname"):
                    if not member.startswith("_"):
                        self.assertTrue(inspect.getdoc(getattr(of_class, "__func__", of_class)), f"{name}.{member}")

    def test_are_there_for_each_public_name(self):
        for name in sorted(public_names()):
            self.documented(name, getattr(weft, name))

    def test_give_shape_or_unit_of_each_array(self):
        first_lines = {}
        for name in public_names():
            value = getattr(weft, name)
            if not inspect.isclass(value) or not value.__module__.startswith("weft.programs"):
                continue
            for member in {*vars(value), *getattr(value, "__dataclass_fields__", ())}:
                if member in SHAPED and (name, member) != ("Cell", "metric"):  # which is a number
                    text = inspect.getdoc(getattr(vars(value).get(member), "__func__", vars(value).get(member)))
                    is_own = member in vars(value) and text
                    first_lines[f"{name}.{member}"] = text if is_own else inspect.getdoc(value)
        self.assertGreaterEqual(len(first_lines), 15)
        for name, text in first_lines.items():
            self.assertRegex(text or "", r"\[[A-Z\d.]", name)


class Types(unittest.TestCase):
    @unittest.skipIf(importlib.util.find_spec("mypy") is None, "python3-mypy is missing")
    def test_are_those_that_examples_and_package_use(self):
        examples = sorted((ROOT / "docs/examples/python_module").glob("*.py"))
        self.assertGreaterEqual(len(examples), 3)
        with tempfile.TemporaryDirectory() as folder:
            wrong = pathlib.Path(folder) / "wrong.py"
            wrong.write_text("import weft\n\nrun = weft.open_run(3)\nrun.eror_mm\nweft.Camera(1.0)\n", encoding="utf-8")
            environment = {**os.environ, "MYPYPATH": str(ROOT / "framework/python")}

            def mypy(*words):
                return subprocess.run(
                    [sys.executable, "-m", "mypy", "--cache-dir", folder, "--ignore-missing-imports", *words], text=True,
                    capture_output=True, check=False, cwd=folder, env=environment)

            ended = mypy("--strict", "--follow-imports=silent", *map(str, examples))
            self.assertEqual(ended.returncode, 0, ended.stdout)
            ended = mypy("--strict", "-p", "weft.programs")
            self.assertEqual(ended.returncode, 0, ended.stdout)
            ended = mypy("--follow-imports=silent", str(wrong))
            for sentence in ('"open_run" has incompatible type "int"', 'has no attribute "eror_mm"',
                             'Missing positional arguments'):
                self.assertIn(sentence, ended.stdout)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
