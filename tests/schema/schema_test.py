#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tries the schemas on all files of the repository: schema_test.py WEFT ROOT PLUGINS SCRIPTED

PLUGINS and SCRIPTED are the folders of the plugins and of those that tests use. The schemas must
take every pipeline and plan that is sound, and must refuse the malformed ones, but for what only the
program sees. Both must agree about keys, their forms and bounds.
"""

import copy
import json
import pathlib
import sys
import tempfile
import unittest

import yaml
from core_yaml import read
from jsonschema import Draft202012Validator
from program import Program, mistakes

WEFT, ROOT, PLUGINS, SCRIPTED = sys.argv[1], *map(pathlib.Path, sys.argv[2:5])
PIPELINES = sorted(file for folder in ("pipelines", "pipelines/benchmarks")
                   for file in (ROOT / folder).glob("*.yaml"))
PLANS = sorted(file for folder in ("pipelines/ablations", "tests/integration/plans")
               for file in (ROOT / folder).glob("*.yaml"))
MALFORMED = {file.stem: file for file in sorted((ROOT / "tests/hostile/malformed").glob("*.yaml"))}
WRONG_PLANS = {file.stem: file for file in sorted((ROOT / "tests/ablation/plans").glob("*.yaml"))
               if file.stem != "base"}
# Errors that no schema detects. They concern duplicate keys, names of stages, the wiring, files and
# variables, and documents that grow too large. They also concern numbers that JSON lacks or, like
# 2.0, takes for whole.
UNSEEN = set("""
    alias_bomb deep_nesting directive duplicate_parameter duplicate_root_key number_nan
    extends_a_folder extends_itself extends_missing extends_with_a_nul fraction_for_whole_number
    from_a_sink from_future_frame from_itself from_later_other_kind from_later_stage
    from_nothing_for_two_inputs from_other_kind
    from_two_for_one from_unknown_input from_unknown_name merge_of_one merge_without_from
    missing_file missing_matcher missing_pass name_twice name_twice_over_a_base nested_input_missing
    output_of_the_run_folder output_over_a_file output_twice sink_named_like_a_stage
    sink_without_input truth_in_secret unread_detector unread_filter_at_the_end unread_matches
    unread_warp_at_the_end variable_not_closed variable_not_set when_names_nobody wrong_order
""".split())
UNSEEN_OF_PLANS = set("""
    absent_data absent_pattern budget control_character_in_a_metric duplicate_key extends_a_pipeline
    extends_itself extends_nothing extends_without_unknown no_frames_to_compare realtime reference
    seeds_and_folders unknown_metric unknown_parameter
    unknown_plugin unknown_stage value_out_of_range variable_not_set wiring without_unknown_stage
""".split())

PIPELINE = {
    "weft": 1,
    "source": {"use": "sources/test.scripted", "params": {"frames": 2}},
    "template": {"use": "templates/test.scripted", "params": {}},
    "stages": [
        {"use": "detectors/test.scripted", "template_params": {"count": 3}},
        {"use": "matchers/test.scripted", "isolate": "process", "deadline_ms": 1000},
        {"use": "filters/test.warped", "as": "warped", "from": {"correspondences": ["matchers"]},
         "params": {"warp": {"use": "warps/test.scripted", "params": {}}}},
        {"use": "filters/test.scripted", "when": {"not_ok": "warped", "every": 3}},
        {"use": "warps/test.scripted"}, {"use": "passes/test.scripted"},
        {"use": "solvers/test.scripted"},
    ],
    "sinks": [{"use": "sinks/test.scripted", "as": "lines", "params": {"path": "a.txt"},
               "overwrite": True}],
    "seed": 0, "lost_after": 30, "on_error": "continue", "max_failed": 0, "frames_at_once": 0,
    "threads": 0, "budget_ms": 0, "realtime": "all", "sequence": True,
}
PLAN = {
    "weft": 1, "name": "plan", "pipeline": str(ROOT / "tests/ablation/plans/base.yaml"),
    "data_use": "tuning",
    "axes": {
        "every": {"set": "filters.every", "values": [2]},
        "named": {"set": "filters.sleep_ms", "values": {"none": 0}},
        "detector": {"stage": "detectors", "use": ["detectors/test.scripted"], "except": [],
                     "set": {"test.scripted": {"count": 30}}, "values": {"as_it_is": {}}},
        "patch": {"values": {"one": {"set": {"seed": 3}}, "some": {"sweep": {"lost_after": [2]}},
                             "other": {"stages": [{"as": "filters", "params": {"every": 2}}],
                                       "without": [], "lost_after": 3}}},
    },
    "data": {"all": {"seeds": ["1-1", 3], "seed_setting": "source.frames"}},
    "seeds": [1, "3-4"],
    "metrics": {"alignment": "rigid", "match_tolerance_px": 2, "frames": True, "deadline_s": 60},
    "cluster": {"partition": "short", "sbatch": ["--mem=4G"], "chunk_minutes": 10,
                "cell_seconds": 2},
    "show": ["counts.solved"],
    "comparisons": [{"axis": "every", "reference": "2", "metric": "counts.solved"}],
    "expect": [{"where": {"every": "2"}, "metric": "counts.solved", "at_most": 9, "at_least": 1}],
}


def is_free(path):
    """Whether a map of the documents above has keys that only the program knows: names of inputs,
    of settings and of cells, and parameters of a stage that the plan does not say the plugin of."""
    return ("set" in path or path[-1:] in (("from",), ("where",), ("sweep",))
            or path == ("axes", "named", "values")
            or (path[:2] == ("axes", "patch") and path[-1] == "params"))


def maps_of(value, path=()):
    """The paths of all maps in a document, in which lists count too."""
    if isinstance(value, dict):
        yield path
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        if isinstance(inner, (dict, list)):
            yield from maps_of(inner, (*path, key))


def at(document, path):
    for key in path:
        document = document[key]
    return document


def changed(document, path, value=None, drop=False):
    """A copy in which what stands at the path is something else, or gone."""
    other = copy.deepcopy(document)
    holder = at(other, path[:-1])
    if drop:
        del holder[path[-1]]
    else:
        holder[path[-1]] = value
    return other


class Schemas(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program, cls.scripted = Program(WEFT, PLUGINS), Program(WEFT, SCRIPTED)
        cls.schemas = {kind: cls.program.schema(kind) for kind in ("pipeline", "plan")}
        cls.of_tests = {kind: cls.scripted.schema(kind) for kind in ("pipeline", "plan")}

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def check(self, kind, documents):
        """(refused by the schema, refused by the program) for each document."""
        files = []
        for number, document in enumerate(documents):
            files.append(self.folder / f"{kind}_{number}.yaml")
            files[-1].write_text(json.dumps(document), encoding="utf-8")
        taken = self.scripted.accepted(files)
        return [(bool(mistakes(self.of_tests[kind], document)), str(file) not in taken)
                for document, file in zip(documents, files)]

    def test_are_valid_and_all_references_lead_somewhere(self):
        for schema in (*self.schemas.values(), *self.of_tests.values()):
            Draft202012Validator.check_schema(schema)
            for path in maps_of(schema):
                reference = at(schema, path).get("$ref")
                if reference is not None:
                    self.assertTrue(reference.startswith("#/$defs/"), reference)
                    self.assertIn(reference[len("#/$defs/"):], schema["$defs"])

    def test_take_every_pipeline_and_plan_of_the_repository(self):
        self.assertTrue(PIPELINES and PLANS)
        for kind, files in (("pipeline", PIPELINES), ("plan", PLANS)):
            for file in files:
                with self.subTest(file=file.name):
                    self.assertEqual(mistakes(self.schemas[kind], read(file)), [])
        for kind, file in (("pipeline", "base.yaml"), ("plan", "sound/parent.yaml")):
            document = read(ROOT / "tests/ablation/plans" / file)
            self.assertEqual(mistakes(self.of_tests[kind], document), [])

    def refused(self, kind, files):
        found = set()
        for name, file in files.items():
            if name in ("alias_bomb", "deep_nesting"):
                continue
            try:
                document = read(file)
            except (yaml.YAMLError, UnicodeDecodeError, TypeError):
                found.add(name)  # every schema refuses a text that is no YAML
                continue
            if mistakes(self.of_tests[kind], document):
                found.add(name)
        return found

    def test_refuse_malformed_files_but_for_what_only_the_program_sees(self):
        self.assertEqual(set(MALFORMED) - self.refused("pipeline", MALFORMED), UNSEEN)
        self.assertEqual(set(WRONG_PLANS) - self.refused("plan", WRONG_PLANS), UNSEEN_OF_PLANS)

    def test_agree_with_the_reader_about_documents_that_have_every_key(self):
        for kind, document in (("pipeline", PIPELINE), ("plan", PLAN)):
            for key in self.of_tests[kind]["properties"]:
                if key not in ("extends", "without"):
                    self.assertIn(key, document, f"the {kind} of this test lacks a key")
            self.assertEqual(mistakes(self.of_tests[kind], document), [])
            self.assertEqual(self.check(kind, [document]), [(False, False)])

    def test_refuse_unknown_keys_wherever_the_reader_does(self):
        for kind, document in (("pipeline", PIPELINE), ("plan", PLAN)):
            paths = list(maps_of(document))
            found = self.check(kind, [changed(document, (*path, "no_such"), 1) for path in paths])
            for path, (by_schema, by_reader) in zip(paths, found):
                with self.subTest(kind=kind, path=path):
                    self.assertTrue(by_reader or not by_schema)
                    if by_reader and not is_free(path):
                        self.assertTrue(by_schema)

    def test_require_what_the_reader_requires(self):
        for kind, document in (("pipeline", PIPELINE), ("plan", PLAN)):
            paths = [(*path, key) for path in maps_of(document) for key in at(document, path)]
            found = self.check(kind, [changed(document, path, drop=True) for path in paths])
            for path, (by_schema, by_reader) in zip(paths, found):
                with self.subTest(kind=kind, path=path):
                    self.assertTrue(by_reader or not by_schema)
                    if path[-1] in ("weft", "source", "template", "use", "name", "pipeline",
                                    "data_use", "data", "values", "stage", "metric", "axis"):
                        self.assertEqual(by_schema, by_reader)

    def test_have_the_forms_and_bounds_of_the_reader(self):
        """Each key of the root: what its schema allows at the most, and a little more."""
        cases = []
        for kind, document in (("pipeline", PIPELINE), ("plan", PLAN)):
            for key, schema in self.of_tests[kind]["properties"].items():
                if "minimum" in schema:
                    low, high = schema["minimum"], schema["maximum"]
                    cases += [(kind, (key,), low, True), (kind, (key,), high, True),
                              (kind, (key,), low - 1, False), (kind, (key,), high + 1, False),
                              (kind, (key,), low + 0.5, False), (kind, (key,), str(low), False)]
                elif "enum" in schema:
                    cases += [(kind, (key,), value, True) for value in schema["enum"]
                              if key != "data_use"]
                    cases += [(kind, (key,), "no_such_choice", False)]
                if key not in ("extends", "without"):
                    cases += [(kind, (key,), {"no": ["such", {"thing": 1}]}, False)]
            for path in maps_of(document):
                if not is_free(path):
                    cases += [(kind, (*path, key), [[]], False) for key in at(document, path)]
        for kind in ("pipeline", "plan"):
            own = [case for case in cases if case[0] == kind]
            found = self.check(kind, [changed(self.document(kind), path, value)
                                      for _, path, value, _ in own])
            for (_, path, value, legal), (by_schema, by_reader) in zip(own, found):
                with self.subTest(kind=kind, path=path, value=value):
                    self.assertEqual((by_schema, by_reader), (not legal, not legal))

    @staticmethod
    def document(kind):
        return PIPELINE if kind == "pipeline" else PLAN

    def test_name_every_key_on_the_pages(self):
        for page, kind in (("pipelines.md", "pipeline"), ("ablations.md", "plan")):
            text = (ROOT / "docs" / page).read_text(encoding="utf-8")
            for key in self.schemas[kind]["properties"]:
                self.assertRegex(text, rf"\b{key}\b", f"{page} lacks the key {key}")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
