#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What modules in Python become when a library is built, and which are refused: embed_test.py PACKAGE"""

import pathlib
import subprocess
import sys
import tempfile
import textwrap
import unittest

HEAD = "import weft\n\n\n"
NEAR = '''
class Near(weft.Filter):
    """Keeps what is near. It says \\"more\\" and costs 5 \u20ac."""

    id = "filters/near"
    version = "1.2.0"
    reads = "camera"
    random = True
    sweep = ("radius_px", [1, 2.5])
    radius_px = weft.number(60, "px", (1, float("inf")), "neighbourhood")
    kind = weft.choice("fast", ("fast", "exact"), "how")
    sizes = weft.numbers([1, 2], "m", None, "sizes")
    cuts = weft.wholes([4, -2, 9], "", (-5, 10), "frames")
    parts = weft.texts(["left", "a b"], "names")
    path = weft.input_path("", "a file", required=True)
    warp = weft.component("warps", "warps/bbs", "the warp")

    def filter(self, given):
        return weft.Record()
'''


class Embed(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def embedded(self, first, text, name="near.py"):
        """Exit status, what was said, and the file that was written."""
        module, table = self.folder / name, self.folder / "table.cpp"
        module.write_text(HEAD + textwrap.dedent(text), encoding="utf-8")
        ended = subprocess.run([sys.executable, "-B", str(PACKAGE / "embed.py"), first, str(table), str(module)],
                               text=True, capture_output=True, check=False)
        written = table.read_text(encoding="utf-8") if table.exists() else ""
        return ended.returncode, ended.stderr.strip(), written

    def refused(self, text, first="filters/near"):
        status, said, written = self.embedded(first, text)
        self.assertEqual((status, written), (1, ""), said)
        return said

    def test_tables_say_what_the_class_declares(self):
        status, said, written = self.embedded("filters/near", NEAR)
        self.assertEqual((status, said), (0, ""))
        for expected in ('"filters/near", "1.2.0", "Keeps what is near."', "WEFT_FLAG_RANDOM",
                         '"radius_px", WEFT_VALUE_F64, 0, 1', "1.0, HUGE_VAL", '{"fast", "exact"}',
                         '"sizes", WEFT_VALUE_F64, 1, 2', '"cuts", WEFT_VALUE_I64, 1, 3',
                         '"parts", WEFT_VALUE_TEXT, 1, 2', '{"left", "a b"}', '"path", WEFT_VALUE_INPUT_PATH', '"warps", "", 0, 0}',
                         "sizeof(weft_sweep), 0, \"radius_px\"", "{1.0, 2.5}"):
            self.assertIn(expected, written)

    def test_the_text_of_the_module_travels_in_the_file_byte_by_byte(self):
        written = self.embedded("filters/near", NEAR)[2]
        self.assertIn('\\\\\\"more\\\\\\" and costs 5 \\342\\202\\254.', written)
        self.assertIn('{"near", "near.py",', written)
        self.assertIn('{"weft.bridge", "weft/bridge.py",', written)

    def test_the_named_component_is_the_first_of_several(self):
        other = NEAR.replace("class Near", "class Far").replace("filters/near", "filters/far")
        written = self.embedded("filters/far", NEAR + other)[2]
        self.assertLess(written.index('"filters/far"'), written.index('"filters/near"'))

    def test_classes_of_other_modules_and_those_without_an_id_are_no_components(self):
        base = NEAR.replace('    id = "filters/near"\n', "").replace("class Near", "class Base")
        written = self.embedded("filters/near", base + NEAR.replace("weft.Filter", "Base"))[2]
        self.assertEqual(written.count("&weft::python::process"), 1)

    def test_each_mistake_of_a_class_is_reported_with_its_name(self):
        for wrong, right, said in (
                ("filters/Near", "filters/near", "'filters/Near' is not of the form role/name"),
                ("passes/near", "filters/near", "its class is of the role filters"),
                ("def filtre(", "def filter(", "it has no method filter(self, given)"),
                ('version = ""', 'version = "1.2.0"', "it has no version"),
                ('weft.choice("slow"', 'weft.choice("fast"', "none of its choices"),
                ("prepare = weft.number", "radius_px = weft.number", "no parameter can have the name 'prepare'")):
            text = NEAR.replace(right, wrong)
            self.assertNotEqual(text, NEAR)
            found = self.refused(text, "filters/near")
            self.assertIn(f"near.py: Near: ", found)
            self.assertIn(said, found)

    def test_a_class_without_a_sentence_is_refused(self):
        text = "\n".join(line for line in NEAR.splitlines() if '"""' not in line)
        self.assertIn("its docstring does not say what it does", self.refused(text))

    def test_a_library_without_the_component_that_it_is_called_by_is_refused(self):
        self.assertIn("no class of it has the id 'filters/far'", self.refused(NEAR, "filters/far"))

    def test_a_module_that_would_hide_one_of_pythons_is_refused(self):
        for name in ("random.py", "numpy.py"):
            status, said, _ = self.embedded("filters/near", NEAR, name)
            self.assertEqual(status, 1)
            self.assertIn(f"a module cannot be called '{name[:-3]}'", said)

    def test_an_id_that_is_used_twice_is_refused(self):
        self.assertIn("the id 'filters/near' is used twice",
                      self.refused(NEAR + NEAR.replace("class Near", "class Again")))


class Classes(unittest.TestCase):
    """The package as an author's own tests use it, without a host."""

    def setUp(self):
        sys.path.insert(0, str(PACKAGE))
        self.addCleanup(sys.path.remove, str(PACKAGE))
        import weft
        scope = {"weft": weft}
        exec(NEAR, scope)
        self.near = scope["Near"]

    def test_an_instance_has_the_values_of_its_parameters(self):
        near = self.near(path="/tmp/a", radius_px=7.0)
        self.assertEqual((near.path, near.radius_px, near.kind, near.sizes), ("/tmp/a", 7.0, "fast", [1.0, 2.0]))
        near.sizes.append(3.0)
        self.assertEqual(self.near(path="/tmp/a").sizes, [1.0, 2.0])

    def test_values_that_no_pipeline_could_give_are_refused(self):
        for values, said in (({}, "needs its parameter 'path'"),
                             ({"path": "", "radius": 1.0}, "no parameter 'radius'"),
                             ({"path": "", "radius_px": 0.5}, "outside its range"),
                             ({"path": "", "kind": "slow"}, "none of its choices")):
            with self.assertRaisesRegex((TypeError, ValueError), said):
                self.near(**values)


if __name__ == "__main__":
    PACKAGE = pathlib.Path(sys.argv.pop(1)).resolve()
    unittest.main()
