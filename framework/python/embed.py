#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes what makes a library of components in Python: embed.py ID TABLE.cpp MODULE.py ...

Imports the modules, and writes a C++ file with their sources and what their components declare. ID is
the first component of the library. Exits 1 with a line for each mistake.
"""

import importlib
import math
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
TYPES = {"f64": "F64", "i64": "I64", "bool": "BOOL", "choice": "CHOICE", "text": "TEXT",
         "input_path": "INPUT_PATH", "output_path": "OUTPUT_PATH", "component": "COMPONENT",
         "labels": "LABELS"}
ID = re.compile(r"[a-z][a-z0-9_]*/([a-z][a-z0-9_]*\.)?[a-z][a-z0-9_]*")


def quoted(text):
    """A string literal of C++."""
    special = {"\n": "\\n", '"': '\\"', "\\": "\\\\", "?": "\\?"}
    return '"' + "".join(
        special.get(c, c if " " <= c <= "~" else "".join(f"\\{byte:03o}" for byte in c.encode()))
        for c in text) + '"'


def number(value):
    if value in (float("inf"), float("-inf")):
        return "HUGE_VAL" if value > 0 else "-HUGE_VAL"
    return repr(float(value))


def integers_in(low, high):
    """The ends of a range of integers, as C++."""
    first = math.ceil(low) if low > -2.0 ** 63 else None
    last = math.floor(high) if high < 2.0 ** 63 else None
    return ("INT64_MIN" if first is None else f"std::int64_t{{{first}}}",
            "INT64_MAX" if last is None else f"std::int64_t{{{last}}}")


class Table:
    """The text of the file."""

    def __init__(self):
        self.lines = []
        self.names = 0

    def array(self, kind, items):
        """The name of a constant array of these, or nullptr."""
        if not items:
            return "nullptr"
        name = f"kItems{self.names}"
        self.names += 1
        self.lines.append(f"constexpr {kind} {name}[] = {{{', '.join(items)}}};")
        return name

    def default(self, parameter):
        """The name of an array with the default value, and its length."""
        value = parameter.default
        if parameter.kind == "labels":
            return "nullptr", 0
        values = value if parameter.is_list else [value]
        if parameter.kind == "f64":
            return self.array("double", [number(each) for each in values]), len(values)
        if parameter.kind == "i64":
            return self.array("std::int64_t", [f"std::int64_t{{{each}}}" for each in values]), len(values)
        if parameter.kind == "bool":
            return self.array("std::uint8_t", ["1" if value else "0"]), 1
        return self.array("const char*", [quoted(each) for each in values]), len(values)

    def parameter(self, name, parameter):
        data, count = self.default(parameter)
        choices = self.array("const char*", [quoted(each) for each in parameter.choices])
        low, high = parameter.bounds or (-math.inf, math.inf)
        first, last = integers_in(low, high)
        value = (f"{{{quoted(name)}, WEFT_VALUE_{TYPES[parameter.kind]}, {int(parameter.is_list)}, {count}, "
                 f"{data}, {{}}}}")
        flags = int(parameter.is_deprecated) + 2 * int(parameter.is_prominent)
        return (f"{{sizeof(weft_parameter), {flags}, {value}, {quoted(parameter.unit)}, "
                f"{quoted(parameter.meaning)}, {number(low)}, {number(high)}, "
                f"{first}, {last}, {choices}, "
                f"{len(parameter.choices)}, {quoted(parameter.role)}, {quoted(parameter.was)}, "
                f"{int(parameter.required)}, 0}}")

    def sweep(self, component):
        if component.sweep is None:
            return "nullptr"
        parameter, values = component.sweep
        items = self.array("double", [number(each) for each in values])
        sweep = f"{{sizeof(weft_sweep), 0, {quoted(parameter)}, {items}, {len(values)}}}"
        return "&" + self.array("weft_sweep", [sweep]) + "[0]"

    def declaration(self, component, declared):
        parameters = [self.parameter(name, each) for name, each in declared.items()]
        return (f"{{{quoted(component.__module__)}, {quoted(component.__name__)}, "
                f"{self.array('weft_parameter', parameters)}, {len(parameters)}, "
                f"{quoted(component.role)}, "
                f"{self.sweep(component)}, {int(hasattr(component, 'check'))}}}")


def component_text(component, index):
    flags = " | ".join(name for name, has in (("WEFT_FLAG_RANDOM", component.random),
                                              ("WEFT_FLAG_USES_TRUTH", component.uses_truth)) if has)
    texts = [component.id, component.version, summary_of(component), component.reference,
             component.licence, component.determinism, component.needs, component.reads,
             component.produces]
    functions = f"weft::python::Functions<kLibrary, {index}>"
    return (f"{{sizeof(weft_component), {flags or '0'}, {', '.join(map(quoted, texts))}, "
            f"{2 ** len(component.methods) - 1}, &{functions}::describe, &{functions}::create, &weft::python::prepare, "
            f"&weft::python::process, &weft::python::destroy, &{functions}::get_extension}}")


def source_text(name, file, path, is_own):
    text = path.read_text(encoding="utf-8")
    lines = "\n    ".join(quoted(line) for line in text.splitlines(keepends=True)) or '""'
    is_package = int(path.name == "__init__.py")
    return f"{{{quoted(name)}, {quoted(file)},\n    {lines},\n    {is_package}, {int(is_own)}}}"


def sources(modules):
    """The package, its loader first, and the author's modules."""
    package = sorted((HERE / "weft").glob("*.py"), key=lambda path: (path.name != "loader.py", path.name))
    for path in package:
        name = "weft" if path.name == "__init__.py" else f"weft.{path.stem}"
        yield source_text(name, f"weft/{path.name}", path, False)
    for path in modules:
        yield source_text(path.stem, path.name, path, True)


def summary_of(component):
    """The first sentence of its docstring."""
    text = " ".join((component.__dict__.get("__doc__") or "").split())
    return re.match(r".*?\.(?=\s|$)|.*", text).group()


def components_in(modules):
    """Classes with an id, in the order of the modules and, in each, of their lines."""
    from weft.roles import Component
    for module in modules:
        for each in vars(module).values():
            if (isinstance(each, type) and issubclass(each, Component) and each.__module__ == module.__name__
                    and "id" in vars(each)):
                yield each


def mistakes_in(component, declared):
    """What the describing program does not see."""
    if not ID.fullmatch(component.id):
        yield f"'{component.id}' is not of the form role/name or role/vendor.name"
    elif component.id.split("/")[0] != component.role:
        yield f"its id is '{component.id}', but its class is of the role {component.role or 'of none'}"
    if not component.version:
        yield "it has no version"
    if not summary_of(component):
        yield "its docstring does not say what it does"
    for method in component.methods:
        if not callable(getattr(component, method, None)):
            yield f"it has no method {method}(self, given)"
    for name, parameter in declared.items():
        if hasattr(object, name) or name in ("id", "version", "role", "prepare", *component.methods):
            yield f"no parameter can have the name '{name}'"
        if parameter.kind == "choice" and parameter.default not in parameter.choices:
            yield f"the default of parameter '{name}' is none of its choices"


def written(first, components, modules):
    from weft.parameters import parameters_of
    table, separator = Table(), ",\n  "
    declarations = [table.declaration(each, parameters_of(each)) for each in components]
    items = "\n".join(table.lines)
    pointers = ", ".join(f"&kComponents[{i}]" for i in range(len(components)))
    return f"""// Written by embed.py for {first}; do not edit.
#include <cmath>
#include <iterator>

#include "python_library.hpp"

namespace {{

using weft::python::Declaration;
using weft::python::Library;
using weft::python::Source;

{items}

constexpr Source kSources[] = {{
  {separator.join(sources(modules))}}};

constexpr Declaration kDeclarations[] = {{
  {separator.join(declarations)}}};

constexpr Library kLibrary{{kSources, std::size(kSources), kDeclarations}};

constexpr weft_component kComponents[] = {{
  {separator.join(component_text(each, i) for i, each in enumerate(components))}}};
constexpr const weft_component* kPointers[] = {{{pointers}}};

}}  // namespace

const weft_library_table weft_library = {{WEFT_ABI_MAGIC, WEFT_ABI_MAJOR, WEFT_ABI_MINOR,
  sizeof(weft_library_table), std::size(kPointers), WEFT_ABI_NAME, kPointers, WEFT_ISA, WEFT_COMPILER, 0, 0, 0, {{0, 0, 0, 0}}}};
"""


def main(arguments):
    if len(arguments) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    first, target, *files = arguments
    paths = [pathlib.Path(file).resolve() for file in files]
    for path in paths:
        if path.stem in sys.stdlib_module_names or path.stem in ("numpy", "weft"):
            print(f"{path}: a module cannot be called '{path.stem}', as one that is there already",
                  file=sys.stderr)
            return 1
    sys.dont_write_bytecode = True
    sys.path[:0] = [str(HERE), *dict.fromkeys(str(path.parent) for path in paths)]
    components = list(components_in([importlib.import_module(path.stem) for path in paths]))
    from weft.parameters import parameters_of
    mistakes = [f"{each.__module__}.py: {each.__name__}: {mistake}" for each in components
                for mistake in mistakes_in(each, parameters_of(each))]
    ids = [each.id for each in components]
    if first not in ids:
        mistakes.append(f"{files[0]}: no class of it has the id '{first}'")
    mistakes += [f"{files[0]}: the id '{each}' is used twice" for each in sorted(set(ids)) if ids.count(each) > 1]
    if mistakes:
        print("\n".join(mistakes), file=sys.stderr)
        return 1
    components.sort(key=lambda each: each.id != first)
    pathlib.Path(target).write_text(written(first, components, paths), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
