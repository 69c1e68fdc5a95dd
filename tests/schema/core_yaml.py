# SPDX-License-Identifier: Apache-2.0
"""Reads YAML as the program does: the core schema of YAML 1.2, where `off` and `1-5` are texts."""

import re

import yaml


class Core(yaml.SafeLoader):
    """PyYAML without the types of YAML 1.1."""

    yaml_implicit_resolvers = {}


def _map(loader, node):
    return {key.value: loader.construct_object(value, deep=True) for key, value in node.value}


def _int(loader, node):
    return int(node.value, 0 if node.value[:2] in ("0x", "0o") else 10)


TYPES = {
    "null": (r"~|null|Null|NULL|", list("~nN") + [""], None),
    "bool": (r"true|True|TRUE|false|False|FALSE", list("tTfF"), None),
    "int": (r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", list("-+0123456789"), _int),
    "float": (r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?"
              r"|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)", list("-+.0123456789"), None),
}
for _name, (_pattern, _first, _constructor) in TYPES.items():
    _tag = f"tag:yaml.org,2002:{_name}"
    Core.add_implicit_resolver(_tag, re.compile(rf"^(?:{_pattern})$"), _first)
    if _constructor:
        Core.add_constructor(_tag, _constructor)
Core.add_constructor("tag:yaml.org,2002:map", _map)


def read(file):
    """The document in a file; yaml.YAMLError where it is none."""
    return yaml.load(file.read_text(encoding="utf-8"), Core)
