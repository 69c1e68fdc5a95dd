// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <set>
#include <weft/core/quote.hpp>

#include "lab/ablation/plan/plan_document.hpp"
#include "lab/ablation/plan/plan_keys.hpp"
#include "lab/ablation/plan/plan_parts.hpp"
#include "lab/metrics/forms/metric_path.hpp"

namespace weft::lab {
namespace {

namespace fs = std::filesystem;

class PlanReader {
 public:
  PlanReader(Plan& plan, const host::Registry& registry, std::vector<yaml::Problem>& problems)
      : plan_(plan), registry_(registry), values_(problems) {}

  void read(yaml::Node root) {
    if (root.kind != yaml::Kind::map) {
      return values_.problem(root.at, "a plan is a map with the keys weft, name, pipeline, data");
    }
    values_.correct_keys(root, "a plan", plan_keys());
    read_head(root);
    if (const yaml::Node* axes = root.find("axes"))
      plan_.axes = read_axes(*axes, registry_, values_, broken_);
    add_pipeline_axis(root);
    if (values_.has(root, "data", "a plan")) {
      const std::size_t before = values_.count();
      plan_.data = read_data(*root.find("data"), plan_, values_);
      data_broken_ = values_.count() > before;
    }
    if (const yaml::Node* seeds = root.find("seeds")) {
      plan_.seeds = values_.seeds(*seeds, "run seeds");
    }
    if (const yaml::Node* metrics = root.find("metrics")) read_measurement(*metrics);
    if (const yaml::Node* cluster = root.find("cluster")) {
      plan_.cluster = read_cluster(*cluster, values_);
    }
    if (const yaml::Node* show = root.find("show")) plan_.show = values_.texts(*show, "'show'");
    for (const yaml::Node& item : list(root, "comparisons")) read_comparison(item);
    for (const yaml::Node& item : list(root, "expect")) read_expectation(item);
    check_metrics();
    measure_named();
  }

 private:
  std::vector<yaml::Node> list(const yaml::Node& root, const char* key) {
    const yaml::Node* node = root.find(key);
    if (node == nullptr) return {};
    if (node->kind != yaml::Kind::sequence) {
      values_.problem(node->at, std::string("'") + key + "' must be a list");
    }
    return node->items;
  }

  void read_head(const yaml::Node& root) {
    if (values_.has(root, "weft", "a plan") && yaml::as_int64(*root.find("weft")) != 1) {
      values_.problem(root.find("weft")->at, "'weft' must be 1, the version of the plan format");
    }
    if (values_.has(root, "name", "a plan")) {
      const yaml::Node& name = *root.find("name");
      plan_.name = values_.text(name, "'name'");
      if (!plan_.name.empty()) values_.is_folder_name(plan_.name, name.at);
    }
    values_.data_use_known = root.find("data_use") != nullptr;
    if (values_.has(root, "data_use", "a plan")) {
      const yaml::Node& use = *root.find("data_use");
      plan_.reporting = use.scalar == "reporting";
      if (!plan_.reporting && use.scalar != "tuning") {
        values_.data_use_known = false;
        values_.problem(use.at, "'data_use' must be one of: tuning, reporting");
      }
    }
    if (values_.has(root, "pipeline", "a plan")) read_pipelines(*root.find("pipeline"));
  }

  /// A file, or several under names, which are then compared.
  void read_pipelines(const yaml::Node& node) {
    if (node.kind != yaml::Kind::map) return read_pipeline(node);
    if (node.entries.size() < 2) {
      values_.problem(node.at,
                      "'pipeline' must be a file, or a map of names and at least two files");
    }
    for (const yaml::Entry& entry : node.entries) {
      values_.is_name(entry.key, entry.at, "the name of a pipeline");
      read_pipeline(entry.value);
    }
  }

  void read_pipeline(const yaml::Node& node) {
    const auto paths = host::PathRules::of_process({}, {});
    const auto expanded = host::expand_path(values_.text(node, "'pipeline'"), paths);
    if (!expanded) return values_.problem(node.at, expanded.error().message);
    if (expanded->empty()) return;
    const auto file = (fs::path(plan_.folder_of(node.at)) / *expanded).lexically_normal().string();
    std::error_code code;
    if (!fs::is_regular_file(file, code)) {
      return values_.problem(node.at, "'pipeline': there is no file " + escaped(file));
    }
    plan_.pipelines.push_back(file);
  }

  /// The axis of the pipelines, where there are several.
  void add_pipeline_axis(const yaml::Node& root) {
    const yaml::Node* pipelines = root.find("pipeline");
    if (pipelines == nullptr || pipelines->kind != yaml::Kind::map) return;
    for (const Axis& axis : plan_.axes) {
      if (axis.name != "pipeline") continue;
      values_.problem(root.find("axes")->find_entry("pipeline")->at,
                      "the plan's pipelines are an axis of this name already");
    }
    Axis axis{"pipeline", {}};
    for (const yaml::Entry& entry : pipelines->entries) axis.values.push_back({entry.key, {}});
    if (plan_.pipelines.size() < axis.values.size()) return plan_.pipelines.clear();
    plan_.axes.insert(plan_.axes.begin(), std::move(axis));
  }

  void read_measurement(const yaml::Node& node) {
    if (!values_.is_map(node, "'metrics'", measurement_keys())) return;
    Measurement& measurement = plan_.measurement;
    if (const yaml::Node* alignment = node.find("alignment")) {
      const auto known = alignment_of(alignment->scalar);
      if (known) measurement.options.alignment = *known;
      if (!known) values_.problem(alignment->at, "'alignment' must be one of: none, scale, rigid");
    }
    if (const yaml::Node* tolerance = node.find("match_tolerance_px")) {
      const auto value = values_.number(*tolerance, "'match_tolerance_px'");
      if (value) measurement.options.match_tolerance_px = *value;
      if (value && !(*value > 0.0))
        values_.problem(tolerance->at, "'match_tolerance_px' must be above 0");
    }
    if (const yaml::Node* frames = node.find("frames")) {
      measurement.frames = values_.flag(*frames, "'frames'").value_or(true);
    }
    if (const yaml::Node* deadline = node.find("deadline_s")) {
      const auto value = values_.number(*deadline, "'deadline_s'");
      if (value) measurement.deadline_s = *value;
      if (value && !(*value > 0.0)) values_.problem(deadline->at, "'deadline_s' must be above 0");
    }
  }

  void read_comparison(const yaml::Node& node) {
    if (!values_.is_map(node, "a comparison", comparison_keys())) return;
    PlanComparison comparison;
    yaml::Position metric_at;
    if (values_.has(node, "axis", "a comparison")) {
      const yaml::Node& axis = *node.find("axis");
      comparison.axis = values_.text(axis, "'axis'");
      const Axis* known = find_axis(comparison.axis, axis.at);
      if (const yaml::Node* reference = node.find("reference"); reference != nullptr && known) {
        comparison.reference = values_.text(*reference, "'reference'");
        if (broken_.count(comparison.axis) == 0) {
          check_choice("value of the axis", comparison.reference, reference->at,
                       names(known->values));
        }
      }
    }
    if (values_.has(node, "metric", "a comparison")) {
      comparison.metric = values_.text(*node.find("metric"), "'metric'");
      metric_at = node.find("metric")->at;
      if (comparison.metric == kErrorMetric && !plan_.measurement.frames) {
        values_.problem(metric_at,
                        "the 3D error is compared frame by frame, but 'metrics' keeps no 'frames'");
      }
    }
    plan_.comparisons.push_back({std::move(comparison), metric_at});
  }

  void read_expectation(const yaml::Node& node) {
    if (!values_.is_map(node, "an expectation", expectation_keys())) return;
    PlanExpectation expectation;
    yaml::Position metric_at;
    if (const yaml::Node* where = node.find("where")) read_selection(*where, expectation.where);
    if (values_.has(node, "metric", "an expectation")) {
      expectation.metric = values_.text(*node.find("metric"), "'metric'");
      metric_at = node.find("metric")->at;
    }
    const auto bound = [&](const char* key) {
      const yaml::Node* value = node.find(key);
      const auto number =
          value != nullptr ? values_.number(*value, std::string("'") + key + "'") : std::nullopt;
      return number.value_or(kUnknown);
    };
    expectation.at_most = bound("at_most");
    expectation.at_least = bound("at_least");
    if (node.find("at_most") == nullptr && node.find("at_least") == nullptr) {
      values_.problem(node.at, "an expectation needs 'at_most' or 'at_least'");
    }
    plan_.expect.push_back({std::move(expectation), metric_at});
  }

  void read_selection(const yaml::Node& where, Selection& selection) {
    if (where.kind != yaml::Kind::map) {
      return values_.problem(where.at, "'where' must be a map, such as {filter: myneighbor}");
    }
    for (const yaml::Entry& entry : where.entries) {
      const std::string value = values_.text(entry.value, "a value of 'where'");
      if (value.empty()) continue;
      selection.emplace_back(entry.key, value);
      if (const auto known = known_values(entry.key, entry.at)) {
        check_choice("value of " + quote(entry.key), value, entry.value.at, *known);
      }
    }
  }

  /// The values that `where` may use for this key; nothing after an error, or if they are unknown
  /// here.
  std::optional<std::vector<std::string>> known_values(const std::string& key, yaml::Position at) {
    std::vector<std::string> known;
    if (key == "seed") {
      for (const std::uint64_t seed : plan_.seeds) known.push_back(std::to_string(seed));
      return known.empty() ? std::nullopt : std::optional(known);
    }
    for (const PlannedData& data : plan_.data) {
      if (key == "data") known.push_back(data.name);
      if (key != "sequence") continue;
      for (const NamedPatch& sequence : data.sequences) known.push_back(sequence.name);
    }
    if (key == "data" || key == "sequence") {
      return data_broken_ ? std::nullopt : std::optional(known);
    }
    const Axis* axis = find_axis(key, at);
    return axis != nullptr && broken_.count(key) == 0 ? std::optional(names(axis->values))
                                                      : std::nullopt;
  }

  void check_choice(const std::string& what, const std::string& value, yaml::Position at,
                    const std::vector<std::string>& known) {
    const bool found = std::find(known.begin(), known.end(), value) != known.end();
    if (!found) values_.unknown(at, what, value, known);
  }

  const Axis* find_axis(const std::string& name, yaml::Position at) {
    std::vector<std::string> known;
    for (const Axis& axis : plan_.axes) {
      if (axis.name == name) return &axis;
      known.push_back(axis.name);
    }
    known.insert(known.end(), broken_.begin(), broken_.end());
    if (!name.empty() && broken_.count(name) == 0) values_.unknown(at, "axis", name, known);
    return nullptr;
  }

  static std::vector<std::string> names(const std::vector<NamedPatch>& values) {
    std::vector<std::string> all;
    for (const NamedPatch& value : values) all.push_back(value.name);
    return all;
  }

  /// Refuses metrics that no run can have, whatever its filters.
  void check_metrics() {
    for (const auto& [metric, at] : metrics_of(plan_)) {
      if (metric.empty() || metric.starts_with("filters")) continue;
      if (std::string because = why_no_metric(metric, {}); !because.empty()) {
        values_.problem(at, std::move(because));
      }
    }
  }

  /// Requests metrics that are measured on demand only.
  void measure_named() {
    for (const auto& [metric, at] : metrics_of(plan_)) {
      if (metric.find(".sampled_") == std::string::npos) continue;
      plan_.measurement.options.surface_samples = kSurfaceSamples;
    }
  }

  Plan& plan_;
  const host::Registry& registry_;
  PlanValues values_;
  std::set<std::string> broken_;  ///< axes with errors
  bool data_broken_ = false;
};

}  // namespace

std::vector<Patch> Plan::patches(const NamedPatch* sequence,
                                 const std::vector<std::size_t>& values) const {
  std::vector<Patch> all;
  if (sequence != nullptr) all.push_back({sources, sequence->patch});
  for (std::size_t axis = 0; axis < axes.size(); ++axis) {
    all.push_back({sources, axes[axis].values[values[axis]].patch});
  }
  yaml::Node no_sinks;
  no_sinks.kind = yaml::Kind::map;
  no_sinks.entries.push_back({"sinks", {}, {}});
  all.push_back({sources, std::move(no_sinks)});
  return all;
}

std::vector<std::pair<std::string, yaml::Position>> metrics_of(const Plan& plan) {
  auto metrics = plan.show;
  for (const PlannedComparison& each : plan.comparisons) {
    metrics.emplace_back(each.comparison.metric, each.metric_at);
  }
  for (const PlannedExpectation& each : plan.expect) {
    metrics.emplace_back(each.expectation.metric, each.metric_at);
  }
  return metrics;
}

std::pair<Plan, ConfigReport> read_plan(const std::string& file, const host::Registry& registry,
                                        const Helpers& helpers, const PlanChanges& changes) {
  PlanDocument document = read_plan_document(file, changes);
  Plan plan;
  plan.helpers = helpers;
  plan.sources = document.sources;
  plan.former_names = std::move(document.former_names);
  ConfigReport report{std::move(document.sources), std::move(document.problems), true, {}};
  if (document.complete) PlanReader(plan, registry, report.problems).read(document.root);
  report.sort();
  return {std::move(plan), std::move(report)};
}

}  // namespace weft::lab
