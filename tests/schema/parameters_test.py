#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What is said of each parameter, wherever it is said: parameters_test.py WEFT PLUGINS

The manifest of a plugin, `weft plugins show` as text and as JSON, and the schemas must agree. That
the table of a plugin's page agrees with the JSON is tested by scripts/parameter_tables.py.
"""

import pathlib
import sys
import unittest

from core_yaml import read
from program import Program

WEFT, PLUGINS = sys.argv[1], pathlib.Path(sys.argv[2])
TYPES = {"f64": "number", "i64": "integer", "bool": "boolean"}


def form_of(parameter):
    """The schema that a parameter of a manifest should have, but for description and default."""
    kind = parameter["type"]
    if kind == "choice":
        return {"enum": parameter["choices"]}
    if kind == "component":
        return {"$ref": f"#/$defs/nested_{parameter['role']}"}
    if kind == "labels":
        return {"type": ["object", "null"], "additionalProperties": form_of({"type": "text"})}
    if kind not in TYPES:
        return {"type": ["string", "number", "boolean"]}
    form = {"type": TYPES[kind]}
    if "range" in parameter:
        form["minimum"], form["maximum"] = parameter["range"]
    return {"type": "array", "items": form} if parameter.get("vector") else form


def default_of(parameter):
    """None where there is none that a file could say."""
    value = None if parameter.get("required") else parameter.get("default")
    if parameter["type"] == "component":
        return {"use": value}
    return None if value in ("", {}) else value


class Parameters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program = Program(WEFT, PLUGINS)
        cls.components = {component["id"]: component for file in PLUGINS.glob("*.plugin.yaml")
                          for component in read(file)["components"]}

    def test_are_the_same_in_manifest_and_schemas(self):
        for kind in ("pipeline", "plan"):
            definitions = self.program.schema(kind)["$defs"]
            for name, component in self.components.items():
                schema = definitions[name.replace("/", ".")]
                self.assertEqual(schema["description"], component["summary"])
                self.assertEqual(list(schema["properties"]),
                                 [each["name"] for each in component["parameters"]], name)
                for parameter in component["parameters"]:
                    with self.subTest(plugin=name, parameter=parameter["name"]):
                        found = dict(schema["properties"][parameter["name"]])
                        unit = f" [{parameter['unit']}]" if parameter.get("unit") else ""
                        self.assertEqual(found.pop("description"), parameter["help"] + unit)
                        self.assertEqual(found.pop("default", None), default_of(parameter))
                        self.assertEqual(found, form_of(parameter))

    def test_are_required_by_the_schema_where_the_manifest_says_so(self):
        rules = self.program.schema("pipeline")["$defs"]["complete"]["allOf"]
        required = {rule["if"]["properties"]["use"]["const"]:
                    rule["then"].get("properties", {}).get("params", {}).get("required", [])
                    for rule in rules}
        for name, component in self.components.items():
            expected = [each["name"] for each in component["parameters"] if each.get("required")]
            self.assertEqual(required.get(name, []), expected, name)

    def test_are_the_same_in_manifest_and_help(self):
        for name, component in self.components.items():
            shown = self.program.json("plugins", "show", name, "--json")["parameters"]
            text = self.program.printed("plugins", "show", name)
            self.assertEqual(len(shown), len(component["parameters"]), name)
            for parameter, other in zip(component["parameters"], shown):
                with self.subTest(plugin=name, parameter=parameter["name"]):
                    for key in ("name", "type", "help", "choices", "role", "range"):
                        self.assertEqual(other.get(key), parameter.get(key), key)
                    self.assertEqual(other.get("unit", ""), parameter.get("unit", ""))
                    self.assertEqual(other["list"], bool(parameter.get("vector")))
                    self.assertEqual(other["required"], bool(parameter.get("required")))
                    if not other["required"]:
                        self.assertEqual(other["default"] or None, parameter["default"] or None)
                    self.assertIn(f"\n  {parameter['name']}: {parameter['help']}\n", text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
