# SPDX-License-Identifier: Apache-2.0
"""Mistakes that are planted into legal plans; no two in one part, so that none hides another."""

from __future__ import annotations

from random import Random

import planting
from grid_mistakes import (one_of, wrong_bound, wrong_cluster, wrong_component_axis, wrong_kind_of_data,
                           wrong_pipelines, wrong_sweep, wrong_where)
from bases import METRICS, PATCH_KEYS, PLAN_KEYS
from documents import Map, Text, tree
from planting import Planted, put_value, rename_key, unknown_key, with_control
from words import misspelt, unlike

FILTER = ["every", "no_result_at", "degenerate_at", "error_at", "throw_at", "nan_at",
          "wrong_length_at", "refuse"]


# --- of the root ----------------------------------------------------------------------------------


def wrong_head(rng: Random, root: Map) -> Planted:
    wrong = {"weft": one_of("2", "one", '"1"'), "data_use": one_of("training", "Tuning", "[]"),
             "name": [*one_of("../../x", "my plan", '""', "..", "a/../../b", "[]", "/tmp/x"),
                      with_control(rng, "plan")],
             "pipeline": one_of("absent.yaml", ".", '"${WEFT_HOSTILE_NOT_SET}/a"', "/dev/null",
                                '"base.yaml\\0"', '"base.y\\x1baml"', "[]"),
             "seeds": one_of("-1", "3-1", "1-", "soon", "99999999999999999999", "1.5", "[]",
                             "[1, 1]", "0-1000000000")}
    key = rng.choice(sorted(wrong))
    # Which stages there are is not known without the pipeline.
    return Planted(f"wrong {key}", put_value(root, key, rng.choice(wrong[key])), None, 0,
                   key == "pipeline")


def wrong_show(rng: Random, root: Map) -> Planted:
    right = rng.choice(METRICS[:3])
    first, last = right.rsplit(".", 1)
    if rng.random() < 0.6:
        root.find("show").items[0] = Text(f"{first}.{misspelt(rng, last, [])}")
        return Planted("unknown metric", root.find("show").items[0], last)
    root.find("show").items[0] = rng.choice(
        [Text("counts"), Text("all.error_solved"), with_control(rng, right), tree([1]),
         Text("", '""'), Text(".." * 40), Text("a." * 3000)])
    return Planted("unknown metric", root.find("show").items[0])


def misspelt_root_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["metrics", "show", "seeds"])
    return rename_key(rng, "misspelt key", root, key, PLAN_KEYS)


def unknown_root_key(rng: Random, root: Map) -> Planted:
    return unknown_key(rng, "unknown key", root)


def duplicate_root_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["name", "data_use", "seeds", "pipeline"])
    return Planted("duplicate key", root.put(key, Text(root.find(key).value)))


def missing_root_key(rng: Random, root: Map) -> Planted:
    key = rng.choice(["weft", "name", "data_use"])
    root.entries = [entry for entry in root.entries if entry[0].value != key]
    return Planted("missing key", root)


# --- settings of a patch --------------------------------------------------------------------------


def wrong_setting(rng: Random, patch: Map) -> Planted:
    """In the map `set` of a patch: a value, a parameter, or a stage."""
    chosen = patch.find("set")
    kind = rng.choice([2, 4]) if chosen.find("filters.use") else rng.randrange(5)
    if kind == 0:
        value = rng.choice(one_of("2000", "-1", "many", "1.5", '"3"', "[1]", "1e999", '"\\x1b"'))
        # No axis of the base overrules this one: a value without effect would be harmless.
        return Planted("wrong value", put_value(chosen, "solvers.refuse", value))
    if kind == 1:
        key = chosen.put("filters." + misspelt(rng, "every", FILTER), 3)
        return Planted("misspelt parameter", key, "every", len("filters."))
    if kind == 2:
        key = chosen.put(misspelt(rng, "filters", []) + ".refuse", "false")
        return Planted("misspelt stage", key, "filters")
    if kind == 3:
        key = chosen.put("filters." + unlike(rng), 3)
        return Planted("unknown parameter", key, "", len("filters."))
    right = "detectors/test.scripted"
    wrong = put_value(chosen, "detectors.use", Text(misspelt(rng, right, [])))
    return Planted("misspelt id", wrong, right)


def wrong_patch_key(rng: Random, patch: Map) -> Planted:
    if rng.random() < 0.5:
        return unknown_key(rng, "unknown key", patch)
    key = patch.put(misspelt(rng, "template", PATCH_KEYS), {})
    return Planted("misspelt key", key, "template")


def wrong_without(rng: Random, patch: Map) -> Planted:
    right = "passes"
    wrong = Text(misspelt(rng, right, []))
    patch.put("without", [wrong])
    return Planted("misspelt stage", wrong, right)


# --- an axis that is a setting --------------------------------------------------------------------


def wrong_axis(rng: Random, axis: Map) -> Planted:
    kind = rng.randrange(6)
    if kind == 0:
        return unknown_key(rng, "unknown key", axis)
    if kind == 1:
        right = "detectors.first_px"
        wrong = put_value(axis, "set", Text("detectors." + misspelt(rng, "first_px", ["count"])))
        return Planted("misspelt parameter", wrong, right.split(".")[1], len("detectors."))
    if kind == 2:
        return Planted("misspelt stage", put_value(
            axis, "set", Text(misspelt(rng, "detectors", []) + ".first_px")), "detectors")
    if kind == 3:
        values = axis.find("values").items
        values.append(rng.choice(one_of("1001", "-1", "far", "1e999", "99999999999999999999")))
        return Planted("wrong value", values[-1])
    if kind == 4:
        values = axis.find("values").items
        values.append(Text(values[0].value))
        return Planted("value twice", values[-1])
    return Planted("no values", put_value(axis, "values", rng.choice(one_of("{}", "[]", "3"))))


def wrong_axes(rng: Random, axes: Map) -> Planted:
    """An axis more, which is wrong as a whole."""
    value = {"set": "passes.refuse", "values": ["false"]}
    kind = rng.randrange(4)
    if kind == 0:
        return Planted("reserved name", axes.put(rng.choice(["data", "sequence", "seed"]), value))
    if kind == 1:
        return Planted("illegal name", axes.put(rng.choice(["a b", "ä"]), value))
    if kind == 2:
        axes.put("other", {"set": "solvers.distance_m", "values": [0.4]})
        return Planted("two axes set the same", axes.find("other").find("set"))
    axes.put("other", {"set": "passes.refuse"})
    return Planted("missing key", axes.find("other"))


# --- data, metrics, comparisons, expectations -----------------------------------------------------


def wrong_data(rng: Random, data: Map) -> Planted:
    """The sequences by seeds."""
    kind = rng.randrange(3)
    if kind == 0:
        return Planted("wrong seeds", put_value(data, "seeds", rng.choice(
            one_of("99-101", "3-1", "[3, 3]", "-1", "soon", "[]", "1.5"))))
    if kind == 1:
        wrong = Text("source." + misspelt(rng, "frames", ["frames"]))
        return Planted("misspelt parameter", put_value(data, "seed_setting", wrong), "frames",
                       len("source."))
    return unknown_key(rng, "unknown key", data)


def wrong_metrics(rng: Random, metrics: Map) -> Planted:
    if rng.random() < 0.3:
        return rename_key(rng, "misspelt key", metrics, "alignment",
                          ["alignment", "match_tolerance_px", "frames", "deadline_s"])
    wrong = {"alignment": one_of("affine", "None", "[]"), "frames": one_of("yes", "1", "[]"),
             "match_tolerance_px": one_of("0", "-1", "wide", "1e999", ".nan", '"2"'),
             "deadline_s": one_of("0", "-1", "soon", "1e999", ".nan", '"60"')}
    key = rng.choice(sorted(wrong))
    return Planted("wrong value", put_value(metrics, key, rng.choice(wrong[key])))


def wrong_comparison(rng: Random, comparison: Map) -> Planted:
    kind = rng.randrange(4)
    if kind == 0:
        return unknown_key(rng, "unknown key", comparison)
    key = ("axis", "reference", "metric")[kind - 1]
    right = comparison.find(key).value
    if key == "metric":
        first, last = right.split(".")
        return Planted("unknown metric", put_value(
            comparison, key, Text(f"{first}.{misspelt(rng, last, [])}")), last)
    known = ["filter", "free", "distance"] if key == "axis" else ["every", "chance"]
    return Planted("misspelt name", put_value(
        comparison, key, Text(misspelt(rng, right, known))), right)


def wrong_expectation(rng: Random, expectation: Map) -> Planted:
    kind = rng.randrange(4)
    if kind == 0:
        wrong = rng.choice(one_of("few", "[]", '"1"', ".nan", "1e999"))
        return Planted("wrong value", put_value(expectation, "at_most", wrong))
    if kind == 1:
        expectation.entries = [e for e in expectation.entries if e[0].value == "where"]
        expectation.put("at_least", 1)
        return Planted("missing key", expectation)
    if kind == 2 and expectation.find("where") is not None:
        key = expectation.find("where").key("filter")
        key.value = misspelt(rng, "filter", ["free", "distance"])
        return Planted("misspelt name", key, "filter")
    return unknown_key(rng, "unknown key", expectation)


def places(root: Map) -> list[tuple[Map, list]]:
    """Where mistakes may be planted, and which."""
    axes, data = root.find("axes"), root.find("data")
    patch = [wrong_setting, wrong_setting, wrong_patch_key, wrong_without]
    found = [(root, [wrong_head, wrong_head, wrong_show, misspelt_root_key, unknown_root_key,
                     duplicate_root_key, missing_root_key, wrong_cluster, wrong_pipelines]),
             (axes, [wrong_axes, wrong_component_axis, wrong_sweep]), (data, [wrong_kind_of_data]), (axes.find("free"), [wrong_axis]),
             (data.find("plain"), [wrong_data]), (data.find("other"), patch),
             (root.find("metrics"), [wrong_metrics])]
    found += [(value, patch) for _, value in axes.find("filter").find("values").entries]
    found += [(item, [wrong_comparison]) for item in root.find("comparisons").items]
    return found + [(item, [wrong_expectation, wrong_where, wrong_bound]) for item in root.find("expect").items]
