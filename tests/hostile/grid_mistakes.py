# SPDX-License-Identifier: Apache-2.0
"""Mistakes of whole parts of a plan: sweeps, axes of components, kinds of data, selections, clusters."""

from __future__ import annotations

from random import Random

from bases import METRICS
from documents import Map, Text, tree
from planting import Planted, put_value, unknown_key
from words import misspelt, unlike


def one_of(*raws: str) -> list[Text]:
    return [Text("", raw) for raw in raws]


def wrong_sweep(rng: Random, axes: Map) -> Planted:
    """A value more, for each number of what cannot be: of no setting, of no number, of no stage."""
    patch = Map()
    axes.find("filter").find("values").put("swept", patch)
    kind = rng.randrange(4)
    if kind == 0:
        wrong = rng.choice([tree([1]), Text("filters.every"), Map(),
                            tree({"filters.every": []}), tree({"filters.every": [2], "seed": [1]})])
        return Planted("no sweep", put_value(patch, "sweep", wrong))
    if kind == 1:
        wrong = rng.choice(one_of("many", "[1]", ".nan", '"3"', "{}"))
        put_value(patch, "sweep", tree({"filters.every": [2, wrong]}))
        return Planted("no number in a sweep", wrong)
    if kind == 2:
        key = Text("filters." + misspelt(rng, "every", ["refuse"]))
        put_value(patch, "sweep", Map([(key, tree([2, 3]))]))
        return Planted("misspelt parameter", key, "every", len("filters."))
    key = Text(misspelt(rng, "filters", []) + ".every")
    put_value(patch, "sweep", Map([(key, tree([2, 3]))]))
    return Planted("misspelt stage", key, "filters")


def wrong_component_axis(rng: Random, axes: Map) -> Planted:
    """An axis of components more."""
    kind = rng.randrange(6)
    axis = tree({"stage": "matchers", "use": ["matchers/test.scripted", "matchers/test.pattern"]})
    axes.put("matcher", axis)
    if kind == 0:
        right = "matchers"
        wrong = put_value(axis, "stage", Text(misspelt(rng, right, [])))
        return Planted("misspelt stage", wrong, right)
    if kind == 1:
        wrong = Text(rng.choice([f"matchers/{unlike(rng)}*", "warpz/*", "*/nothing"]))
        axis.find("use").items[0] = wrong
        return Planted("pattern of no component", wrong)
    if kind == 2:
        right = "matchers/test.pattern"
        wrong = Text(misspelt(rng, right, ["matchers/test.scripted", "matchers/test.merge"]))
        axis.find("use").items[1] = wrong
        return Planted("misspelt id", wrong, right)
    if kind == 3:
        return Planted("wrong choice", put_value(axis, "sweep", Text(unlike(rng))))
    if kind == 4:
        return Planted("missing key", missing(axis, "stage"))
    return unknown_key(rng, "unknown key", axis)


def missing(part: Map, key: str) -> Map:
    part.entries = [entry for entry in part.entries if entry[0].value != key]
    return part


def wrong_kind_of_data(rng: Random, data: Map) -> Planted:
    """Data more, which are neither by seeds nor of folders, or both."""
    kind = rng.randrange(4)
    if kind == 0:
        wrong = Text(rng.choice(["nowhere/*", "absent"]))
        data.put("more", Map([(Text("folders"), wrong)]))
        return Planted("no such folder", wrong)
    if kind == 1:
        part = Map([(Text("seeds"), Text("4-5")), (Text("seed_setting"), Text("source.frames")),
                    (Text("folders"), Text("a/*"))])
        data.put("more", part)
        return Planted("seeds and folders", part.entries[2][1])
    if kind == 2:
        wrong = Text("source.frames")
        data.put("more", Map([(Text("seed_setting"), wrong)]))
        return Planted("seed_setting alone", wrong)
    return Planted("illegal name", data.put(rng.choice(["a b", "ä"]), {}))


def wrong_where(rng: Random, expectation: Map) -> Planted:
    """What is expected of cells that there are not."""
    # Not of data: a name of theirs that is wrong leaves open which there are.
    values = {"filter": ["every", "chance"], "distance": ["near", "far"]}
    key = rng.choice(sorted(values))
    right = rng.choice([value for value in values[key] if len(value) >= 4])
    if rng.random() < 0.7:
        wrong = Text(misspelt(rng, right, values[key]))
        put_value(expectation, "where", Map([(Text(key), wrong)]))
        return Planted("misspelt value in where", wrong, right)
    if rng.random() < 0.5:
        wrong = Text(str(rng.choice([99, 1000])))
        put_value(expectation, "where", Map([(Text("seed"), wrong)]))
        return Planted("unknown seed in where", wrong)
    return Planted("wrong type", put_value(expectation, "where",
                                           rng.choice([Text("filter"), tree([1])])))


def wrong_cluster(rng: Random, root: Map) -> Planted:
    cluster = Map([(Text("partition"), Text("short"))])
    root.put("cluster", cluster)
    if rng.random() < 0.4:
        key = cluster.put(misspelt(rng, "chunk_minutes", []), 5)
        return Planted("misspelt key", key, "chunk_minutes")
    key = rng.choice(["chunk_minutes", "cell_seconds"])
    wrong = rng.choice(one_of("0", "-1", "soon", ".nan", "[]", '"5"'))
    return Planted("wrong value", put_value(cluster, key, wrong))


def wrong_bound(rng: Random, expectation: Map) -> Planted:
    """An expectation of no metric."""
    right = METRICS[0]
    first, last = right.rsplit(".", 1)
    wrong = Text(f"{first}.{misspelt(rng, last, [])}")
    return Planted("unknown metric", put_value(expectation, "metric", wrong), last)


def wrong_pipelines(rng: Random, root: Map) -> Planted:
    """Several pipelines that are one, or not there."""
    if rng.random() < 0.5:
        wrong = tree({"old": "base.yaml"})
        return Planted("one pipeline of several", put_value(root, "pipeline", wrong))
    wrong = Text("absent.yaml")
    put_value(root, "pipeline", Map([(Text("old"), Text("base.yaml")), (Text("new"), wrong)]))
    return Planted("wrong pipeline", wrong, None, 0, True)
