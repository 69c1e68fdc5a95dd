// SPDX-License-Identifier: Apache-2.0
#include "ablation/plan/plan_keys.hpp"

#include <fmt/core.h>

#include "ablation/plan/plan.hpp"
#include "pipeline/configuration/pipeline_keys.hpp"

namespace weft::evaluation {
namespace {

using yaml::Form;
using yaml::KeyTable;

KeyTable with(KeyTable keys, const KeyTable& more) {
  keys.insert(keys.end(), more.begin(), more.end());
  return keys;
}

}  // namespace

const KeyTable& plan_keys() {
  static const KeyTable kKeys{
      {.name = "weft",
       .help = "version of the format",
       .form = Form::whole,
       .low = 1,
       .high = 1,
       .required = true},
      {.name = "name",
       .help = "of the plan, and of its results folder",
       .form = Form::part,
       .part = "folder_name",
       .required = true},
      {.name = "extends", .help = "a plan over which this one is laid"},
      {.name = "without",
       .help = "what is left out of that plan: AXIS, AXIS.VALUE or data.NAME",
       .form = Form::texts},
      {.name = "pipeline",
       .help = "the file over which all is laid, or names and files that are compared",
       .form = Form::part,
       .part = "pipelines",
       .required = true},
      {.name = "data_use",
       .help = "data seeds 1-100 are for tuning, from 101 on for reporting",
       .form = Form::choice,
       .choices = {"tuning", "reporting"},
       .required = true},
      {.name = "axes", .help = "what is varied", .form = Form::part, .part = "axes"},
      {.name = "data",
       .help = "names, and what of sequences they lay over the pipeline",
       .form = Form::part,
       .part = "data",
       .required = true},
      {.name = "seeds",
       .help = "run seeds; left out: the pipeline's own",
       .form = Form::part,
       .part = "seeds"},
      {.name = "metrics", .help = "how cells are measured", .form = Form::part, .part = "metrics"},
      {.name = "cluster",
       .help = "how cells are handed to a cluster",
       .form = Form::part,
       .part = "cluster"},
      {.name = "show",
       .help = "metrics of the table, by their paths in what `weft eval --json` prints",
       .form = Form::texts},
      {.name = "comparisons",
       .help = "which values of an axis are compared, in which metric",
       .form = Form::part,
       .part = "comparisons"},
      {.name = "expect",
       .help = "bounds of metrics; one that is missed fails the ablation",
       .form = Form::part,
       .part = "expect"},
  };
  return kKeys;
}

const KeyTable& axis_keys() {
  static const KeyTable kKeys{
      {.name = "set", .help = "the setting that is varied, such as filters.alpha_s"},
      {.name = "values",
       .help = "of the setting, as a list or under names; or names and patches",
       .form = Form::part,
       .part = "values",
       .required = true},
  };
  return kKeys;
}

const KeyTable& component_axis_keys() {
  static const KeyTable kKeys{
      {.name = "stage",
       .help = "name of the stage, source or template that is exchanged",
       .required = true},
      {.name = "use",
       .help = "an id or a pattern (filters/*), or a list of these",
       .form = Form::part,
       .part = "words",
       .required = true},
      {.name = "except",
       .help = "ids, patterns or names that are left out",
       .form = Form::part,
       .part = "words"},
      {.name = "sweep",
       .help = "a value for each number over which the plugin declares that its threshold runs",
       .form = Form::choice,
       .choices = {"threshold"}},
      {.name = "set",
       .help = "parameters of single components, by id, pattern or name",
       .form = Form::part,
       .part = "parameters_of_some"},
      {.name = "values",
       .help = "further values, which come first: names and patches",
       .form = Form::part,
       .part = "patches"},
  };
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
    keys.push_back({.name = "set",
                    .help = "settings, such as {filters.alpha_s: 0.2}",
                    .form = Form::part,
                    .part = "settings"});
    return keys;
  }();
  return kKeys;
}

const KeyTable& axis_value_keys() {
  static const KeyTable kKeys =
      with(patch_keys(), {{.name = "sweep",
                           .help = "a value for each number: {PATH: [0.1, 0.2]}",
                           .form = Form::part,
                           .part = "sweep"}});
  return kKeys;
}

const KeyTable& data_keys() {
  static const KeyTable kKeys = with(
      patch_keys(),
      {{.name = "seeds",
        .help = "data seeds, each of which makes a sequence",
        .form = Form::part,
        .part = "seeds"},
       {.name = "seed_setting", .help = "the parameter that takes them (default: source.seed)"},
       {.name = "folders",
        .help = "pattern of folders with frames/ (images), camera.yaml and gt/ (*.npz or "
                "*.csv); each makes a sequence"}});
  return kKeys;
}

const KeyTable& measurement_keys() {
  static const Measurement kDefaults{};
  static const KeyTable kKeys{
      {.name = "alignment",
       .help = "what is taken out of a shape before it is measured",
       .form = Form::choice,
       .choices = {"none", "scale", "rigid"},
       .fallback = to_string(kDefaults.options.alignment)},
      {.name = "match_tolerance_px",
       .help = "a match this near its true place is correct",
       .form = Form::positive,
       .fallback = fmt::format("{}", kDefaults.options.match_tolerance_px)},
      {.name = "frames",
       .help = "keep the figures of each frame",
       .form = Form::flag,
       .fallback = kDefaults.frames ? "true" : "false"},
      {.name = "deadline_s",
       .help = "seconds after which a cell has failed",
       .form = Form::positive},
  };
  return kKeys;
}

const KeyTable& cluster_keys() {
  static const KeyTable kKeys{
      {.name = "partition", .help = "of Slurm, in which the tasks run"},
      {.name = "sbatch", .help = "further options of sbatch", .form = Form::texts},
      {.name = "chunk_minutes", .help = "that a task is to take", .form = Form::positive},
      {.name = "cell_seconds", .help = "that a cell takes", .form = Form::positive},
  };
  return kKeys;
}

const KeyTable& comparison_keys() {
  static const KeyTable kKeys{
      {.name = "axis", .help = "whose values are compared", .required = true},
      {.name = "reference", .help = "the value with which the others are compared"},
      {.name = "metric", .help = "its path in what `weft eval --json` prints", .required = true},
  };
  return kKeys;
}

const KeyTable& expectation_keys() {
  static const KeyTable kKeys{
      {.name = "where",
       .help = "which cells: values of axes, data, sequence, seed",
       .form = Form::part,
       .part = "where"},
      {.name = "metric",
       .help = "its path in what `weft eval --json` prints; the mean over these cells",
       .required = true},
      {.name = "at_most", .help = "upper bound", .form = Form::number},
      {.name = "at_least", .help = "lower bound", .form = Form::number},
  };
  return kKeys;
}

const std::vector<std::string>& reserved_axis_names() {
  static const std::vector<std::string> kNames{"data", "sequence", "seed", "cell", "key"};
  return kNames;
}

}  // namespace weft::evaluation
