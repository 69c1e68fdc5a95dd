// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/plan_keys.hpp"

#include <fmt/core.h>

#include "lab/ablation/plan/plan.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft::lab {

using yaml::KeyTable;
using yaml::KeyTableBuilder;

const KeyTable& plan_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .whole("weft", 1, 1, "version of the format")
          .required()
          .part("name", "folder_name", "of the plan, and of its results folder")
          .required()
          .text("extends", "a plan over which this one is laid")
          .texts("without", "what this plan omits from that one: AXIS, AXIS.VALUE or data.NAME")
          .part("pipeline", "pipelines",
                "the file over which all is laid, or names and files that are compared")
          .required()
          .choice("data_use", {"tuning", "reporting"},
                  "data seeds 1-100 are for tuning, from 101 on for reporting")
          .required()
          .part("axes", "axes", "what is varied")
          .part("data", "data",
                "names, and the settings of sequences that each changes in the pipeline")
          .required()
          .part("seeds", "seeds", "run seeds; default: that of the pipeline")
          .part("metrics", "metrics", "how cells are measured")
          .part("cluster", "cluster", "how cells are handed to a cluster")
          .texts("show", "metrics of the table, by their paths in what `weft eval --json` prints")
          .part("comparisons", "comparisons",
                "which values of an axis are compared, in which metric")
          .part("expect", "expect", "bounds of metrics; one that is missed fails the ablation");
  return kKeys;
}

const KeyTable& axis_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .text("set", "the setting that is varied, such as filters.alpha_s")
          .part("values", "values",
                "of the setting, as a list or under names; or names and patches")
          .required();
  return kKeys;
}

const KeyTable& component_axis_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .text("stage", "name of the stage, source or template that is exchanged")
          .required()
          .part("use", "words", "an id or a pattern (filters/*), or a list of these")
          .required()
          .part("except", "words", "ids, patterns or names that are omitted")
          .choice("sweep", {"threshold"},
                  "a value for each number over which the plugin declares that its threshold runs")
          .part("set", "parameters_of_some",
                "parameters of single components, by id, pattern or name")
          .part("values", "patches", "further values, which come first: names and patches");
  return kKeys;
}

const KeyTable& patch_keys() {
  static const KeyTable kKeys = [] {
    KeyTable keys;
    for (const char* name : {"source", "template", "stages", "without", "lost_after"}) {
      keys.push_back(yaml::key_of(pipeline_keys(), name));
      keys.back().required = false;
      keys.back().fallback.clear();
    }
    return KeyTable(
        KeyTableBuilder(keys).part("set", "settings", "settings, such as {filters.alpha_s: 0.2}"));
  }();
  return kKeys;
}

const KeyTable& axis_value_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder(patch_keys())
          .part("sweep", "sweep", "a value for each number: {PATH: [0.1, 0.2]}");
  return kKeys;
}

const KeyTable& data_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder(patch_keys())
          .part("seeds", "seeds", "data seeds; each makes a sequence")
          .text("seed_setting", "the parameter that takes them (default: source.seed)")
          .text("folders",
                "pattern of folders with frames/ (images), camera.yaml and gt/ (*.npz or "
                "*.csv); each makes a sequence");
  return kKeys;
}

const KeyTable& measurement_keys() {
  static const Measurement kDefaults{};
  static const KeyTable kKeys =
      KeyTableBuilder()
          .choice("alignment", {"none", "scale", "rigid"},
                  "motion that is removed from a shape before measuring")
          .otherwise(to_string(kDefaults.options.alignment))
          .positive("match_tolerance_px", "a match this near its true place is correct")
          .otherwise(fmt::format("{}", kDefaults.options.match_tolerance_px))
          .flag("frames", "keep the figures of each frame")
          .otherwise(kDefaults.frames ? "true" : "false")
          .positive("deadline_s", "seconds after which a cell has failed");
  return kKeys;
}

const KeyTable& cluster_keys() {
  static const KeyTable kKeys = KeyTableBuilder()
                                    .text("partition", "of Slurm, in which the tasks run")
                                    .texts("sbatch", "further options of sbatch")
                                    .positive("chunk_minutes", "that a task is to take")
                                    .positive("cell_seconds", "that a cell takes");
  return kKeys;
}

const KeyTable& comparison_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .text("axis", "whose values are compared")
          .required()
          .text("reference", "the value with which the others are compared")
          .text("metric", "its path in what `weft eval --json` prints")
          .required();
  return kKeys;
}

const KeyTable& expectation_keys() {
  static const KeyTable kKeys =
      KeyTableBuilder()
          .part("where", "where", "which cells: values of axes, data, sequence, seed")
          .text("metric", "its path in what `weft eval --json` prints; the mean over these cells")
          .required()
          .number("at_most", "upper bound")
          .number("at_least", "lower bound");
  return kKeys;
}

const std::vector<std::string>& reserved_axis_names() {
  static const std::vector<std::string> kNames{"data", "sequence", "seed", "cell", "key"};
  return kNames;
}

}  // namespace weft::lab
