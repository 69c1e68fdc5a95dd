# SPDX-License-Identifier: Apache-2.0
"""Mistakes between the stages of legal pipelines: names, wiring, conditions, order.

Planters of a stage know which stages stand before and behind it. Those of the whole pipeline are alone
in it, because what a stage reads decides what can be said of the others.
"""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

from documents import List, Map, Node, Text, tree
from planting import Planted, put_value
from words import misspelt, unlike

TYPES = {"detectors": "keypoints", "matchers": "correspondences", "filters": "correspondences",
         "warps": "warp_samples", "passes": "sightlines", "solvers": "shape"}


@dataclass
class Stage:
    """A stage under its name, and the names of the others."""

    name: str
    makes: str
    before: list[Stage]
    behind: list[Stage]
    meant: bool = False  # an error of another stage refers to this name
    renamed: bool = False


def stages_of(root: Map) -> list[tuple[Map, Stage]]:
    found: list[tuple[Map, Stage]] = []
    unnamed: dict[str, int] = {}
    for part in root.find("stages").items:
        role = part.find("use").value.split("/")[0]
        if part.find("as") is None:
            unnamed[role] = unnamed.get(role, 0) + 1
        name = role if unnamed.get(role, 0) < 2 else f"{role}#{unnamed[role]}"
        name = part.find("as").value if part.find("as") is not None else name
        stage = Stage(name, TYPES[role], [other for _, other in found], [])
        for _, other in found:
            other.behind.append(stage)
        found.append((part, stage))
    return found


# --- of a stage -----------------------------------------------------------------------------------


def wrong_when(rng: Random, part: Map, stage: Stage) -> Planted | None:
    """Of the conditions under which the stage is called."""
    kind = rng.randrange(6)
    if kind == 0:
        return Planted("empty when", put_value(part, "when", Map()))
    if kind == 1:
        put_value(part, "when", tree({misspelt(rng, "every", ["not_ok"]): 3}))
        return Planted("misspelt condition", part.find("when").entries[0][0], "every")
    if kind == 2:
        wrong = rng.choice([Text("0"), Text("-1"), Text("often"), Text("2.5"), tree([2]),
                            Text("99999999999999999999")])
        put_value(part, "when", Map([(Text("every"), wrong)]))
        return Planted("wrong interval", wrong)
    if kind == 3:
        wrong = rng.choice([Text("always"), tree([1]), Text("", '"3"')])
        return Planted("wrong type", put_value(part, "when", wrong))
    named = [other for other in stage.before
             if len(other.name) >= 4 and "#" not in other.name and not other.renamed]
    later = [stage.name, *(other.name for other in stage.behind)]
    if kind == 4 and named:
        chosen = rng.choice(named)
        chosen.meant, right = True, chosen.name
        written = Text(misspelt(rng, right, [other.name for other in named]))
        put_value(part, "when", Map([(Text("not_ok"), rng.choice([written, List([written])]))]))
        return Planted("misspelt stage in when", written, right)
    written = Text(rng.choice([unlike(rng), *later]))
    put_value(part, "when", Map([(Text("not_ok"), written)]))
    return Planted("unknown stage in when", written)


def wrong_reference(rng: Random, part: Map, stage: Stage) -> Planted | None:
    """An input from the stage itself, a later one, one that makes something else, or from no frame."""
    chosen = part.find("from")
    if chosen is None:
        return None
    key, value = chosen.entries[0]
    others = [other.name for other in stage.before if other.makes != key.value]
    previous = f"previous.{key.value}"
    wrong = {"from itself": [stage.name], "from a later stage": [s.name for s in stage.behind],
             "from another kind": others, "from no frame": [previous + "@-1", previous + "@x",
                                                            previous + "@", "previous.nothing"]}
    sort = rng.choice([name for name, words in wrong.items() if words])
    written = Text(rng.choice(wrong[sort]))
    if isinstance(value, List):
        value.items[rng.randrange(len(value.items))] = written
    else:
        put_value(chosen, key.value, written)
    return Planted(sort, key)


def two_for_one(rng: Random, part: Map, stage: Stage) -> Planted | None:
    chosen = part.find("from")
    if chosen is None or isinstance(chosen.entries[0][1], List):
        return None
    key, value = chosen.entries[0]
    put_value(chosen, key.value, List([value, Text(value.value)]))
    return Planted("two for one", key)


def name_of_another(rng: Random, part: Map, stage: Stage) -> Planted | None:
    """The name of an earlier stage, which nobody means by it any more."""
    given = [other.name for other in stage.before if other.name not in TYPES and "#" not in other.name]
    if part.find("as") is not None or not given or stage.meant:
        return None
    stage.renamed = True
    return Planted("name twice", put_value(part, "as", Text(rng.choice(given))))


def wrong_template_parameters(rng: Random, part: Map, stage: Stage) -> Planted | None:
    if stage.makes != "keypoints":
        key = part.put("template_params", {})
        return Planted("template_params of no detector", next(
            value for name, value in part.entries if name is key))
    if rng.random() < 0.5:
        key = misspelt(rng, "first_px", ["count"])
        put_value(part, "template_params", tree({key: 20.0}))
        return Planted("misspelt parameter", part.find("template_params").entries[0][0], "first_px")
    wrong = rng.choice([Text("many"), Text("-1"), Text("10001"), Text("2.5"), tree([3])])
    put_value(part, "template_params", Map([(Text("count"), wrong)]))
    return Planted("wrong value", wrong)


STAGE = [wrong_when, wrong_when, wrong_reference, wrong_reference, two_for_one, name_of_another,
         wrong_template_parameters]


def of_stage(stage: Stage) -> list:
    """The planters as they are called, for a stage at its place."""
    return [lambda rng, part, plant=plant: plant(rng, part, stage) for plant in STAGE]


# --- of the whole pipeline ------------------------------------------------------------------------


def alone(sort: str, node: Node) -> Planted:
    return Planted(sort, node, None, 0, True)


def stage_missing(rng: Random, root: Map) -> Planted | None:
    """Leaves out the pass or the warp, whose reader is the one to blame."""
    stages = root.find("stages")
    role = rng.choice(["warps", "passes"])
    for index, part in enumerate(stages.items):
        if part.find("use").value.startswith(role + "/"):
            reader = stages.items[index + 1]
            solvers = len(stages.items) - index - 1
            if reader.find("from") is not None or (role == "passes" and solvers > 1):
                return None
            del stages.items[index]
            return alone("stage missing", reader)
    return None


def wrong_order(rng: Random, root: Map) -> Planted | None:
    """A stage before the one whose output it takes."""
    stages = root.find("stages").items
    index = next(i for i, part in enumerate(stages) if part.find("use").value.startswith("passes/"))
    if stages[index].find("from") is not None:
        return None
    stages[index - 1], stages[index] = stages[index], stages[index - 1]
    return alone("wrong order", stages[index - 1])


def unread_stage(rng: Random, root: Map) -> Planted:
    """A stage at the end, whose output nobody takes."""
    use = rng.choice(["detectors", "warps", "passes"])
    part = tree({"use": use + "/test.scripted", "as": "zebra"})
    root.find("stages").items.append(part)
    return alone("unread stage", part)


def lonely_merger(rng: Random, root: Map) -> Planted | None:
    """A merger that is not told what to unite, or united with nothing."""
    for part in root.find("stages").items:
        if part.find("use").value == "matchers/test.merge":
            part.entries = [entry for entry in part.entries if entry[0].value != "from"]
            return alone("merger without from", part)
    return None


def sink_like_a_stage(rng: Random, root: Map) -> Planted:
    names = [stage.name for _, stage in stages_of(root) if stage.name not in TYPES]
    name = put_value(root.find("sinks").items[0], "as", Text(rng.choice(
        [name for name in names if "#" not in name])))
    return alone("sink named like a stage", name)


ROOT = [stage_missing, wrong_order, unread_stage, lonely_merger, sink_like_a_stage]
