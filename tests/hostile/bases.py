# SPDX-License-Identifier: Apache-2.0
"""Legal pipelines and plans of the scripted components, and what their parameters may be."""

from __future__ import annotations

from dataclasses import dataclass
from random import Random

from documents import Map, tree


@dataclass(frozen=True)
class Parameter:
    """A parameter: its kind, a few legal values, and values beyond its range."""

    kind: str  # whole, number, flag, choice, list, path, text
    legal: tuple = ()
    beyond: tuple = ()


def whole(low: int, high: int, *legal: int) -> Parameter:
    return Parameter("whole", legal, (low - 1, high + 1, -(10**15), 10**17))


def number(low: float, high: float, *legal: float) -> Parameter:
    return Parameter("number", legal, (low - 1.5, 2.0 * high + 1.5, 1e300, -1e300))


FRAMES = Parameter("list", ([], [1], [0, 2]), ([-1], [1, 2e9]))
FLAG = Parameter("flag", (False,))
SCRIPT = {"no_result_at": FRAMES, "degenerate_at": FRAMES, "nan_at": FRAMES, "refuse": FLAG}

PARAMETERS: dict[str, dict[str, Parameter]] = {
    "sources/test.scripted": SCRIPT | {
        "frames": whole(0, 10**6, 2, 3), "focal_px": number(-1e6, 1e6, 100.0, 99.5),
        "sleep_ms": whole(0, 10_000, 0, 1), "known_vertex": whole(-1, 10**6, -1, 3),
        "truth": Parameter("flag", (True, False)), "unknown_count": FLAG,
        "path": Parameter("path", ("present.txt",)), "note": Parameter("text", ("seen", "x y"))},
    "templates/test.scripted": {
        "columns": whole(2, 100, 5, 6), "rows": whole(2, 100, 4, 5),
        "defect": Parameter("choice", ("none", "flipped"))},
    "detectors/test.scripted": SCRIPT | {
        "count": whole(0, 10_000, 20, 24), "first_px": number(0, 1000, 10.0, 9.5)},
    "matchers/test.scripted": SCRIPT,
    "matchers/test.pattern": SCRIPT | {
        "count": whole(0, 10_000, 30), "bad_face": FLAG, "image_scale": number(0, 100, 0.5),
        "pattern": Parameter("choice", ("grid", "collinear", "duplicate"))},
    "matchers/test.merge": {},
    "filters/test.scripted": SCRIPT | {"every": whole(0, 1000, 0, 3, 4)},
    "filters/test.warped": {},
    "warps/test.scripted": SCRIPT | {"evaluate_no_result_at": FRAMES},
    "passes/test.scripted": SCRIPT | {"silent_at": FRAMES},
    "solvers/test.scripted": SCRIPT | {"distance_m": number(0.01, 100, 0.2, 0.25),
                                       "weak_at": FRAMES},
    "solvers/test.holder": {},
    "sinks/test.scripted": SCRIPT | {"refuse_open": FLAG},
}

ALL_PARAMETERS: dict[str, list[str]] = {
    component: [*known, "error_at", "throw_at", "wrong_length_at", "wrong_size_at", "warp", "initial_guess",
                "image_shift_px", "short_samples_at", "bad_vertex_at", "bad_state_at", "path", "sleep_ms",
                "refuse_finish"]
    for component, known in PARAMETERS.items()}

ROOT_KEYS = ["weft", "source", "template", "stages", "sinks", "seed", "lost_after", "on_error",
             "max_failed", "frames_at_once", "threads", "realtime", "extends", "without"]
STAGE_KEYS = ["use", "params", "as", "from", "when", "template_params", "isolate", "deadline_ms"]


def some_parameters(rng: Random, component: str) -> dict:
    """A few legal parameters; the last frame is left alone, so that runs have something to say."""
    known = PARAMETERS[component]
    names = rng.sample(sorted(known), min(len(known), rng.randrange(1, 4)))
    chosen = {name: rng.choice(known[name].legal) for name in names if known[name].legal}
    if component == "templates/test.scripted":
        chosen["defect"] = "none"
    return chosen


def component(rng: Random, use: str, **more: object) -> dict:
    given = dict(more)
    params = some_parameters(rng, use) | given.pop("params", {})
    return {"use": use} | given | ({"params": params} if params else {})


def chain(rng: Random) -> list[dict]:
    """Detector, matcher, filter, warp, pass, solver; every reader says what it reads."""
    filtered = {"params": {"warp": {"use": "warps/test.scripted", "params": {"nan_at": []}}}}
    solver = {"params": {"initial_guess": {"use": "solvers/test.scripted", "params": {"distance_m": 0.3}}}}
    return [
        component(rng, "detectors/test.scripted"),
        component(rng, "matchers/test.scripted", **{"as": "pairs"}),
        component(rng, "filters/test.scripted", **{"as": "strict",
                                                   "from": {"correspondences": "pairs"}}),
        component(rng, "filters/test.warped", **filtered),
        component(rng, "warps/test.scripted", **{"as": "sheet"}),
        component(rng, "passes/test.scripted", **{"from": {"warp_samples": "sheet"}}),
        component(rng, "solvers/test.holder", **solver),
        component(rng, "solvers/test.scripted", **{"as": "refined"}),
    ]


def merged(rng: Random) -> list[dict]:
    """Two matchers that a third unites."""
    both = {"from": {"correspondences": ["pairs", "grid"]}}
    return [
        component(rng, "detectors/test.scripted", **{"as": "points"}),
        component(rng, "matchers/test.scripted", **{"as": "pairs",
                                                    "from": {"keypoints": "points"}}),
        component(rng, "matchers/test.pattern", **{"as": "grid"}),
        component(rng, "matchers/test.merge", **both),
        component(rng, "filters/test.scripted", **{"from": {"correspondences": "matchers"}}),
        component(rng, "warps/test.scripted"),
        component(rng, "passes/test.scripted"),
        component(rng, "solvers/test.scripted", **{"from": {"sightlines": "passes"}}),
    ]


def pipeline(rng: Random) -> Map:
    """A legal pipeline with three frames at most; the keys of the root in any order but `weft`."""
    entries = {
        "source": component(rng, "sources/test.scripted"),
        "template": component(rng, "templates/test.scripted"),
        "stages": rng.choice([chain, merged])(rng),
        "sinks": [component(rng, "sinks/test.scripted", **{"as": "lines"})],
        "seed": rng.randrange(100), "lost_after": rng.randrange(1, 50),
        "on_error": "continue", "max_failed": rng.randrange(5),
    }
    names = list(entries)
    rng.shuffle(names)
    return tree({"weft": 1} | {name: entries[name] for name in names})


BASE_OF_PLANS = """\
weft: 1
source: {use: sources/test.scripted, params: {frames: 2, truth: true}}
template: {use: templates/test.scripted}
stages:
  - {use: detectors/test.scripted}
  - {use: matchers/test.scripted}
  - {use: filters/test.scripted}
  - {use: warps/test.scripted}
  - {use: passes/test.scripted}
  - {use: solvers/test.scripted}
"""

PLAN_KEYS = ["weft", "name", "pipeline", "data_use", "axes", "data", "seeds", "metrics", "show",
             "comparisons", "expect"]
PATCH_KEYS = ["source", "template", "stages", "without", "lost_after", "set"]
METRICS = ["counts.solved_percent", "counts.estimated", "all.error_solved.mean_mm",
           "filters.tpr_percent"]


def plan(rng: Random) -> Map:
    """A legal plan of a dozen cells over the base; its axis `free` is named nowhere else."""
    bound = {"at_least": 0.5} if rng.random() < 0.5 else {"at_most": 2.5}
    return tree({
        "weft": 1, "name": "plan", "pipeline": "base.yaml", "data_use": "tuning",
        "axes": {
            "filter": {"values": {"every": {"set": {"filters.every": rng.randrange(2, 5)}},
                                  "chance": {"set": {"filters.use": "filters/test.random"}}}},
            "free": {"set": "detectors.first_px", "values": [10.0, 12.5]},
            "distance": {"set": "solvers.distance_m", "values": {"near": 0.2, "far": 0.3}}},
        "data": {"plain": {"seeds": "2-3", "seed_setting": "source.frames"},
                 "other": {"set": {"source.frames": 1, "source.truth": "true"}}},
        "seeds": rng.choice(["1-2", 7]),
        "metrics": {"alignment": rng.choice(["none", "rigid"]), "match_tolerance_px": 2.5,
                    "frames": True, "deadline_s": 3600},
        "show": rng.sample(METRICS, 2),
        "comparisons": [{"axis": "filter", "reference": "every", "metric": METRICS[0]}],
        "expect": [{"where": {"filter": "chance"}, "metric": METRICS[0]} | bound,
                   {"metric": METRICS[1], "at_least": 0.5}],
    })
