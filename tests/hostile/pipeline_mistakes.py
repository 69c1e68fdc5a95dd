# SPDX-License-Identifier: Apache-2.0
"""Mistakes that are planted into legal pipelines, each with its place by construction.

A planter takes a component or the root, which then is taken: no two mistakes are in one component,
so that none can hide or bring about another.
"""

from __future__ import annotations

from random import Random

import planting
import wiring_mistakes
from bases import ALL_PARAMETERS, PARAMETERS, ROOT_KEYS, STAGE_KEYS
from documents import List, Map, Text, tree
from planting import Planted, put_value, rename_key, unknown_key, with_control
from words import misspelt, unlike

IDS = sorted(PARAMETERS)


def use_of(part: Map) -> str:
    return part.find("use").value


def params_of(part: Map) -> Map:
    found = part.find("params")
    return found if found is not None else put_value(part, "params", Map())


# --- of a component -------------------------------------------------------------------------------


def wrong_parameter(rng: Random, part: Map) -> Planted | None:
    known = PARAMETERS[use_of(part)]
    names = sorted(name for name in known if known[name].kind != "text")
    if not names:
        return None
    name = rng.choice(names)
    if known[name].beyond and rng.random() < 0.5:
        value = put_value(params_of(part), name, tree(rng.choice(known[name].beyond)))
        return Planted("out of range", value.items[-1] if isinstance(value, List) else value)
    value, blamed = planting.wrong_type(rng, known[name].kind)
    put_value(params_of(part), name, value)
    return Planted("wrong type", value.items[blamed] if blamed >= 0 else value)


def wrong_choice(rng: Random, part: Map) -> Planted | None:
    choices = {"templates/test.scripted": "defect", "matchers/test.pattern": "pattern"}
    name = choices.get(use_of(part))
    if name is None:
        return None
    return Planted("wrong choice", put_value(params_of(part), name, rng.choice(
        [Text(unlike(rng)), with_control(rng, "none"), Text("Grid"), Text("", '""')])))


def misspelt_parameter(rng: Random, part: Map) -> Planted | None:
    known = ALL_PARAMETERS[use_of(part)]
    given = [key.value for key, _ in params_of(part).entries if len(key.value) >= 4]
    given = [name for name in given if name in PARAMETERS[use_of(part)]]
    if not given:
        return None
    return rename_key(rng, "misspelt parameter", params_of(part), rng.choice(given), known)


def unknown_parameter(rng: Random, part: Map) -> Planted:
    return unknown_key(rng, "unknown parameter", params_of(part))


def duplicate_parameter(rng: Random, part: Map) -> Planted | None:
    if not params_of(part).entries:
        return None
    return planting.duplicate_key(rng, "duplicate parameter", params_of(part))


def misspelt_id(rng: Random, part: Map) -> Planted:
    right = use_of(part)
    return Planted("misspelt id",
                   put_value(part, "use", Text(misspelt(rng, right, IDS))), right)


def unreadable_id(rng: Random, part: Map) -> Planted:
    value = rng.choice([with_control(rng, use_of(part)), Text("../../plugins/x"), tree([1]),
                        Text("", '""'), Text("%s%n"), Text("a" * 5000)])
    return Planted("unreadable id", put_value(part, "use", value))


def no_use(rng: Random, part: Map) -> Planted:
    part.entries = [entry for entry in part.entries if entry[0].value != "use"]
    if not part.entries:
        part.put("params", {})
    return Planted("missing use", part)


def params_as_list(rng: Random, part: Map) -> Planted:
    return Planted("wrong type", put_value(part, "params", tree([3])))


def misspelt_component_key(rng: Random, part: Map) -> Planted | None:
    if part.find("params") is None:
        return None
    return rename_key(rng, "misspelt key", part, "params", STAGE_KEYS)


def unknown_component_key(rng: Random, part: Map) -> Planted:
    return unknown_key(rng, "unknown key", part)


def duplicate_component_key(rng: Random, part: Map) -> Planted:
    return planting.duplicate_key(rng, "duplicate key", part)


def absent_path(rng: Random, part: Map) -> Planted | None:
    if use_of(part) != "sources/test.scripted":
        return None
    value = rng.choice([
        Text("no/such.file"), Text("", '"${WEFT_HOSTILE_NOT_SET}/a"'), Text("", '"${HOME"'),
        Text("", '"present.txt\\0"'), with_control(rng, "present.txt"), Text("/dev/full/x"),
        Text("a" * 300), Text("x/" * 3000), Text("", '"${WEFT_HOSTILE_EMPTY}/nothing"')])
    return Planted("absent file", put_value(params_of(part), "path", value))


# --- of a stage -----------------------------------------------------------------------------------


def nested(part: Map) -> Map | None:
    for name in ("warp", "initial_guess"):
        found = params_of(part).find(name)
        if found is not None:
            return found
    return None


def wrong_nested(rng: Random, part: Map) -> Planted | None:
    inner = nested(part)
    if inner is None:
        return None
    right = use_of(inner)
    if rng.random() < 0.4:
        return rng.choice([wrong_parameter, misspelt_parameter])(rng, inner)
    # A filter has a nested warp, for which parameters alone are meant.
    if rng.random() < 0.3 and params_of(part).find("warp") is None:
        return Planted("missing use", no_use(rng, inner).node)
    if rng.random() < 0.5:
        role, name = right.split("/")
        wrong = misspelt(rng, role, []) + "/" + name
        return Planted("misspelt role", put_value(inner, "use", Text(wrong)), right)
    return misspelt_id(rng, inner)


def wrong_from(rng: Random, part: Map) -> Planted | None:
    """A name that no stage has, at the key of the input; or an input that the stage has not."""
    chosen = part.find("from")
    if chosen is None:
        return None
    key, value = chosen.entries[0]
    if rng.random() < 0.3:
        key.value = unlike(rng)
        return Planted("unknown input", key)
    names = value if isinstance(value, List) else None
    right = names.items[0].value if names else value.value
    wrong = rng.choice([misspelt(rng, right, []), unlike(rng), None])
    written = Text(wrong) if wrong else with_control(rng, right, False)
    if names:
        names.items[0] = written
    else:
        put_value(chosen, key.value, written)
    suggested = None if wrong is None else "" if wrong.startswith("zq") else right
    return Planted("unknown name in from", key, suggested)


def from_of_wrong_kind(rng: Random, part: Map) -> Planted | None:
    if part.find("from") is None:
        return None
    if rng.random() < 0.5:
        wrong = rng.choice([Text("pairs"), tree([1])])
        return Planted("wrong type", put_value(part, "from", wrong))
    key = part.find("from").entries[0][0].value
    return Planted("wrong type", put_value(part.find("from"), key, rng.choice(
        [tree([]), tree({"a": 1}), tree([["a"]])])))


def illegal_name(rng: Random, part: Map) -> Planted | None:
    if part.find("as") is not None:
        return None
    return Planted("illegal name", put_value(part, "as", rng.choice(
        [Text("My Name"), Text("filters"), Text("previous"), with_control(rng, "name"),
         Text("", '""'), Text("../x"), tree([1])])))


def deep_nested(rng: Random, part: Map) -> Planted | None:
    """A mistake of a component in a component in the stage."""
    if use_of(part) != "solvers/test.holder":
        return None
    inner = tree({"use": "solvers/test.scripted", "params": {"distance_m": 0.3}})
    holder = Map([(Text("use"), Text("solvers/test.holder")),
                  (Text("params"), Map([(Text("initial_guess"), inner)]))])
    put_value(params_of(part), "initial_guess", holder)
    return rng.choice([wrong_parameter, misspelt_parameter, unknown_parameter, misspelt_id])(rng, inner)


def wrong_isolation(rng: Random, part: Map) -> Planted:
    if rng.random() < 0.5:
        return Planted("wrong choice", put_value(part, "isolate", Text("thread")))
    return Planted("missing key", put_value(part, "deadline_ms", Text("5")))


def not_a_stage(rng: Random, part: Map) -> Planted:
    wrong = rng.choice(["sinks/test.scripted", "sources/test.scripted"])
    part.entries = [entry for entry in part.entries if entry[0].value not in ("params",)]
    return Planted("wrong role", put_value(part, "use", Text(wrong)))


# --- of the root ----------------------------------------------------------------------------------


def wrong_root_value(rng: Random, root: Map) -> Planted | None:
    wrong = {"seed": ["-1", "99999999999999999999", "soon", "1.5", '"3"'],
             "lost_after": ["-1", "1000001", "soon", "1e9"],
             "on_error": ["ignore", "Stop", '"\\x1b"', "[]"],
             "max_failed": ["0.5", "-1", "2147483648", "{}"], "weft": ["2", "one", '"1"', "[1]"]}
    key = rng.choice(sorted(wrong))
    return Planted("wrong value", put_value(root, key, Text("", rng.choice(wrong[key]))))


def misspelt_root_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["seed", "lost_after", "on_error", "max_failed"])
    return rename_key(rng, "misspelt key", root, key, ROOT_KEYS)


def unknown_root_key(rng: Random, root: Map) -> Planted:
    return unknown_key(rng, "unknown key", root)


def duplicate_root_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["seed", "lost_after", "on_error", "max_failed"])
    second = root.put(key, Text(root.find(key).value))
    return Planted("duplicate key", second)


def no_template(rng: Random, root: Map) -> Planted:
    key = rng.choice(["weft", "template"])
    root.entries = [entry for entry in root.entries if entry[0].value != key]
    return Planted("missing key", root)


def without_extends(rng: Random, root: Map) -> Planted:
    return Planted("missing key", put_value(root, "without", tree(["lines"])))


def source_of_another_role(rng: Random, root: Map) -> Planted:
    key, wrong = rng.choice([("source", "templates"), ("template", "sources"), ("source", "solvers")])
    part = root.find(key)
    part.entries = [entry for entry in part.entries if entry[0].value != "params"]
    return Planted("wrong role", put_value(part, "use", Text(wrong + "/test.scripted")), None, 0, True)


COMPONENT = [wrong_parameter, wrong_parameter, wrong_choice, misspelt_parameter, misspelt_parameter,
             unknown_parameter, duplicate_parameter, misspelt_id, unreadable_id, no_use,
             params_as_list, misspelt_component_key, unknown_component_key, duplicate_component_key,
             absent_path]
STAGE = COMPONENT + [wrong_nested, wrong_nested, wrong_from, wrong_from, from_of_wrong_kind,
                     illegal_name, wrong_isolation, not_a_stage, deep_nested]
ROOT = [wrong_root_value, misspelt_root_key, unknown_root_key, duplicate_root_key, no_template,
        without_extends, source_of_another_role, *wiring_mistakes.ROOT]


def places(root: Map) -> list[tuple[Map, list]]:
    """Where mistakes may be planted, and which."""
    found = [(root, ROOT), (root.find("source"), COMPONENT), (root.find("template"), COMPONENT)]
    found += [(part, STAGE + wiring_mistakes.of_stage(stage))
              for part, stage in wiring_mistakes.stages_of(root)]
    return found + [(sink, COMPONENT) for sink in root.find("sinks").items]
