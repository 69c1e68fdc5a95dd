// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/index.hpp>

#include "lab/ablation/plan/plan_document.hpp"
#include "lab/metrics/forms/former_words.hpp"

namespace weft::lab {
namespace {

class Renamer {
 public:
  explicit Renamer(std::vector<host::FormerName>& found) : found_(found) {}

  void plan(yaml::Node& root) {
    for (yaml::Entry& entry : root.entries) {
      if (entry.key == "axes") {
        for (yaml::Entry& axis : entry.value.entries) ids(axis.value);
      } else if (entry.key == "show") {
        for (yaml::Node& path : entry.value.items) metric(path);
      } else if (entry.key == "comparisons" || entry.key == "expect") {
        for (yaml::Node& item : entry.value.items) metric_of(item);
      }
    }
  }

 private:
  void ids(yaml::Node& axis) {
    for (yaml::Entry& entry : axis.entries) {
      if (entry.key != "use" && entry.key != "except") continue;
      id(entry.value);
      for (yaml::Node& item : entry.value.items) id(item);
    }
  }

  void id(yaml::Node& word) {
    const std::string current(host::current_id(word.scalar));
    if (current == word.scalar) return;
    found_.push_back({word.at, word.scalar, current, "component"});
    word.scalar = current;
  }

  void metric_of(yaml::Node& item) {
    for (yaml::Entry& entry : item.entries) {
      if (entry.key == "metric") metric(entry.value);
    }
  }

  void metric(yaml::Node& path) {
    const std::string current = current_metric(path.scalar);
    if (current == path.scalar) return;
    found_.push_back({path.at, path.scalar, current, "metric"});
    path.scalar = current;
  }

  std::vector<host::FormerName>& found_;
};

/// Lays each value of an axis and each data once over the plan's pipelines.
class NameSearch {
 public:
  NameSearch(const Plan& plan, const host::Registry& registry, ConfigReport& report)
      : plan_(plan), registry_(registry), report_(report), found_(plan.former_names) {
    for (const std::string& pipeline : plan.pipelines) {
      bases_.push_back(read_base(pipeline, registry_, paths_));
    }
  }

  std::vector<host::FormerName> run() {
    std::vector<std::size_t> values(plan_.axes.size());
    lay(nullptr, values);
    for (const PlannedData& data : plan_.data) {
      for (const NamedPatch& sequence : data.sequences) lay(&sequence, values);
    }
    for (std::size_t axis = 0; axis < values.size(); ++axis) {
      for (std::size_t i = 1; i < plan_.axes[axis].values.size(); ++i) {
        values[axis] = i;
        lay(nullptr, values);
      }
      values[axis] = 0;
    }
    return std::move(found_);
  }

 private:
  void lay(const NamedPatch* sequence, const std::vector<std::size_t>& values) {
    if (bases_.empty()) return;
    const PipelineDocument& base = bases_[plan_.pipeline_of(values)];
    const auto document = laid_over(base, plan_.patches(sequence, values), {}, registry_, paths_);
    const auto in_plan = [&](yaml::Position at) {
      return document.sources.at(to_index(at.source)).name == plan_.file().name;
    };
    for (host::FormerName each : document.former_names) {
      if (!in_plan(each.at)) continue;
      each.at.source = 0;
      found_.push_back(std::move(each));
    }
    for (yaml::Problem each : document.problems) {
      if (!in_plan(each.at)) continue;
      each.at.source = 0;
      report_.problems.push_back(std::move(each));
    }
  }

  const Plan& plan_;
  const host::Registry& registry_;
  ConfigReport& report_;
  std::vector<host::FormerName> found_;
  host::PathRules paths_ = host::PathRules::of_process({}, plan_.file().folder);
  std::vector<PipelineDocument> bases_;
};

}  // namespace

void use_current_plan_names(yaml::Node& root, std::vector<host::FormerName>& found) {
  Renamer(found).plan(root);
}

std::pair<std::vector<host::FormerName>, ConfigReport> former_names_in_plan(
    const std::string& file, const host::Registry& registry, const Helpers& helpers) {
  auto [plan, report] = read_plan(file, registry, helpers);
  std::vector<host::FormerName> found;
  if (report.ok()) found = NameSearch(plan, registry, report).run();
  std::erase_if(found, [](const host::FormerName& each) { return each.at.source != 0; });
  report.sort();
  return {std::move(found), std::move(report)};
}

}  // namespace weft::lab
