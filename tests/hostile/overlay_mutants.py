# SPDX-License-Identifier: Apache-2.0
"""Pipelines and plans that extend others, with mistakes in the overlay or in what it extends."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import bases
from documents import Map, Style, Text, tree, write
from judging import Expected, Mutant
from planting import Planted, put_value, unknown_key
from words import misspelt, unlike

Files = dict[str, Map]


def expected_in(file: str, planted: Planted) -> Expected:
    return Expected(planted.kind, file, *planted.at, planted.suggestion)


def written(rng: Random, files: Files) -> dict[str, object]:
    return {name: write(root, Style.random(rng)).encode(errors="surrogateescape")
            for name, root in files.items()}


def wrong_extends(rng: Random, top: Map) -> Planted:
    """A file that is not there, none, or one of those that lead here."""
    wrong = rng.choice([Text("absent.yaml"), Text("pipeline.yaml"), Text("."), Text("/dev/null"),
                        Text("", '"${WEFT_HOSTILE_NOT_SET}/a.yaml"'), tree(["base.yaml"]),
                        tree({"a": 1}), Text("", '""'), Text("x" * 300)])
    return Planted("wrong extends", put_value(top, "extends", wrong), None, 0, True)


# --- pipelines ------------------------------------------------------------------------------------


def overlay(rng: Random) -> Map:
    """Legal over bases.BASE_OF_PLANS."""
    return tree({
        "weft": 1, "extends": "base.yaml", "seed": rng.randrange(100),
        "source": {"params": {"frames": rng.choice([2, 3])}},
        "stages": [{"use": "filters/test.scripted", "params": {"every": rng.choice([2, 3])}},
                   {"use": "filters/test.scripted", "as": "again", "from": {"correspondences": "filters"}}],
    })


def left_out(rng: Random, top: Map) -> Planted:
    """A stage to leave out that the base does not have, or no list of stages."""
    if rng.random() < 0.6:
        wrong = Text(misspelt(rng, "passes", []))
        put_value(top, "without", tree([wrong]))
        return Planted("misspelt stage in without", wrong, "passes")
    if rng.random() < 0.5:
        wrong = Text(unlike(rng))
        put_value(top, "without", tree([wrong]))
        return Planted("unknown stage in without", wrong, "")
    return Planted("wrong type", put_value(top, "without", rng.choice([Text("passes"), tree({"a": 1})])))


def parameter_over(rng: Random, top: Map) -> Planted:
    """A parameter of the source, whose `use` stands in the base alone."""
    params = top.find("source").find("params")
    if rng.random() < 0.5:
        key = misspelt(rng, "frames", list(bases.PARAMETERS["sources/test.scripted"]))
        params.entries[0] = (Text(key), params.entries[0][1])
        return Planted("misspelt parameter", params.entries[0][0], "frames")
    wrong = rng.choice([Text("-1"), Text("many"), Text("2.5"), tree([3]), Text("", '"3"')])
    return Planted("wrong value", put_value(params, "frames", wrong))


def stage_over(rng: Random, top: Map) -> Planted:
    """The new stage takes what nobody makes."""
    part = top.find("stages").items[1]
    wrong = misspelt(rng, "filters", [])
    put_value(part.find("from"), "correspondences", Text(wrong))
    return Planted("unknown name in from", part.find("from").entries[0][0], "filters")


def key_over(rng: Random, top: Map) -> Planted:
    return unknown_key(rng, "unknown key", rng.choice([top, top.find("source")]))


def mistake_below(rng: Random, base: Map) -> Planted:
    """Of a stage of the base that the overlay leaves as it is."""
    part = base.find("stages").items[0]
    if rng.random() < 0.5:
        return unknown_key(rng, "unknown key below", part)
    wrong = rng.choice([Text("-1"), Text("many"), Text("20000"), tree([3])])
    put_value(part, "params", Map([(Text("count"), wrong)]))
    return Planted("wrong value below", wrong)


def pipeline_overlay(rng: Random) -> Mutant:
    base, top = tree_of_base(), overlay(rng)
    files: Files = {"base.yaml": base, "pipeline.yaml": top}
    if rng.random() < 0.2:
        planted = [("pipeline.yaml", wrong_extends(rng, top))]
    elif rng.random() < 0.1:
        base.put("extends", "pipeline.yaml")
        planted = [("base.yaml", Planted("extends in a circle", base.find("extends")))]
    else:
        # The inputs of the stages are unknown while the omitted stages are unknown.
        kinds = rng.sample([rng.choice([left_out, stage_over]), parameter_over, key_over,
                            mistake_below], rng.randrange(1, 4))
        planted = [("base.yaml", plant(rng, base)) if plant is mistake_below
                   else ("pipeline.yaml", plant(rng, top)) for plant in kinds]
    content = written(rng, files)
    return Mutant("pipeline", content | {"present.txt": b"present\n"}, ["check", "pipeline.yaml"],
                  [expected_in(file, each) for file, each in planted])


def tree_of_base() -> Map:
    """bases.BASE_OF_PLANS as a tree."""
    stages = [{"use": f"{role}/test.scripted"}
              for role in ("detectors", "matchers", "filters", "warps", "passes", "solvers")]
    return tree({"weft": 1, "source": {"use": "sources/test.scripted",
                                       "params": {"frames": 2, "truth": True}},
                 "template": {"use": "templates/test.scripted"}, "stages": stages})


# --- plans ----------------------------------------------------------------------------------------


def plan_overlay(rng: Random) -> Mutant:
    below = bases.plan(rng)
    top = tree({"weft": 1, "name": "over", "extends": "below.yaml",
                "axes": {"free": {"values": [11.0]}},
                "metrics": {"match_tolerance_px": 3.5}})
    planted = rng.choice([plan_extends, plan_without, plan_without, plan_axis, plan_metric])(rng, top)
    content = written(rng, {"below.yaml": below, "plan.yaml": top})
    return Mutant("plan", content | {"base.yaml": bases.BASE_OF_PLANS.encode()},
                  ["ablate", "plan.yaml", "--status", "--out", "out"],
                  [expected_in("plan.yaml", planted)])


def plan_extends(rng: Random, top: Map) -> Planted:
    planted = wrong_extends(rng, top)
    if planted.node.value == "pipeline.yaml" if isinstance(planted.node, Text) else False:
        planted = replace(planted, node=put_value(top, "extends", Text("plan.yaml")))
    return planted


def plan_without(rng: Random, top: Map) -> Planted:
    right, word = rng.choice([("filter", "filter"), ("filter.every", "every"), ("data.plain", "plain")])
    first = right.removesuffix(word)
    wrong = Text(first + misspelt(rng, word, ["free", "distance", "chance", "other"]))
    top.put("without", [wrong])
    return Planted("misspelt name in without", wrong, word)


def plan_axis(rng: Random, top: Map) -> Planted:
    axis = top.find("axes").find("free")
    if rng.random() < 0.5:
        return unknown_key(rng, "unknown key", axis)
    wrong = rng.choice([Text("1001"), Text("-1"), Text("far")])
    put_value(axis, "values", tree([wrong]))
    return Planted("wrong value", wrong)


def plan_metric(rng: Random, top: Map) -> Planted:
    wrong = rng.choice([Text("0"), Text("wide"), Text("-2.5")])
    return Planted("wrong value", put_value(top.find("metrics"), "match_tolerance_px", wrong))
