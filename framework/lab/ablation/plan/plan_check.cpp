// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <weft/core/index.hpp>

#include "lab/ablation/plan/plan_parts.hpp"
#include "lab/metrics/forms/metric_path.hpp"

namespace weft::lab {
namespace {

/// Grids of this number of pipelines are checked as they are, all combinations at once.
constexpr std::size_t kFewPipelines = 64;

/// With more parts than these the rest is left to the grid, so that the answer comes at once.
constexpr std::size_t kMostParts = 150;

/// Lays the parts of a plan over its pipeline, one at a time.
class PartsCheck {
 public:
  PartsCheck(const Plan& plan, const host::Registry& registry,
             const std::vector<std::string>& settings, ConfigReport& report)
      : plan_(plan), registry_(registry), settings_(settings), report_(report) {
    for (const std::string& pipeline : plan.pipelines) {
      bases_.push_back(read_base(pipeline, registry_, paths_));
    }
  }

  void check() {
    const std::size_t before = report_.problems.size();
    std::vector<std::size_t> values(plan_.axes.size());
    lay(values, 0);
    for (std::size_t data = 1; data < plan_.data.size(); ++data) lay(values, data);
    std::size_t most = 0;
    for (const Axis& axis : plan_.axes) most = std::max(most, axis.values.size());
    for (std::size_t i = 1; i < most; ++i) {
      for (std::size_t axis = 0; axis < values.size(); ++axis) {
        if (i >= plan_.axes[axis].values.size()) continue;
        values[axis] = i;
        lay(values, 0);
        values[axis] = 0;
      }
    }
    for (auto& [place, mistake] : mistakes_) add(std::move(mistake));
    if (report_.problems.size() == before) check_metrics();
  }

 private:
  struct Mistake {
    ConfigSource source;
    yaml::Problem problem;
    std::string cell;       ///< the first that has it
    std::size_t parts = 1;  ///< how many have it
  };

  const NamedPatch* first_of(std::size_t data) const {
    const bool none = plan_.data.empty() || plan_.data[data].sequences.empty();
    return none ? nullptr : &plan_.data[data].sequences.front();
  }

  void lay(const std::vector<std::size_t>& values, std::size_t data) {
    if (parts_ == kMostParts) return;
    ++parts_;
    const std::size_t base = plan_.pipeline_of(values);
    auto document = laid_over(bases_[base], plan_.patches(first_of(data), values), settings_,
                              registry_, paths_);
    document.isolating = plan_.isolating;
    const auto [pipeline, report] = check_cell(plan_.pipelines[base], std::move(document),
                                               registry_, plan_.file().folder, &checks_);
    std::vector<std::string> filters;
    for (const StageConfig& stage : pipeline.config.stages) {
      if (rules_of(stage.role).marks) filters.push_back(stage.name);
    }
    filters_.insert(filters);
    std::set<std::string> seen;
    for (const yaml::Problem& problem : report.problems) {
      const std::string place = place_in(report.sources, problem.at) + ": " + problem.message;
      if (!seen.insert(place).second) continue;
      const auto source = to_index(problem.at.source);
      const Mistake mistake{report.sources.at(source), problem, name_of(values, data)};
      const auto [known, is_new] = mistakes_.emplace(place, mistake);
      if (!is_new) ++known->second.parts;
    }
  }

  std::string name_of(const std::vector<std::size_t>& values, std::size_t data) const {
    std::string name;
    for (std::size_t axis = 0; axis < values.size(); ++axis) {
      name += plan_.axes[axis].name + "=" + plan_.axes[axis].values[values[axis]].name + ", ";
    }
    const NamedPatch* sequence = first_of(data);
    return sequence == nullptr ? name + "any data" : name + "sequence=" + sequence->name;
  }

  /// Adds an error that does not follow from one of the grammar.
  void add(Mistake mistake) {
    const auto same = [&](const ConfigSource& source) {
      return source.name == mistake.source.name && source.is_setting == mistake.source.is_setting;
    };
    auto at = std::find_if(report_.sources.begin(), report_.sources.end(), same);
    const auto of_plan = static_cast<std::ptrdiff_t>(plan_.sources.size());
    const bool in_plan = at - report_.sources.begin() < of_plan;
    // Without its data a pipeline may lack what they would have brought.
    if (!in_plan && plan_.data.empty()) return;
    if (at == report_.sources.end()) at = report_.sources.insert(at, mistake.source);
    mistake.problem.at.source = static_cast<int>(at - report_.sources.begin());
    const auto follows = [&](const yaml::Problem& other) { return other.at == mistake.problem.at; };
    if (std::any_of(report_.problems.begin(), report_.problems.end(), follows)) return;
    if (!in_plan && mistake.parts < parts_) {
      mistake.problem.message += "\n    in the cell " + mistake.cell;
    }
    report_.problems.push_back(std::move(mistake.problem));
  }

  void check_metrics() {
    for (const auto& [metric, at] : metrics_of(plan_)) {
      if (!metric.starts_with("filters")) continue;
      std::string because;
      for (const std::vector<std::string>& filters : filters_) {
        because = why_no_metric(metric, filters);
        if (because.empty()) break;
      }
      if (!because.empty()) report_.problems.push_back({at, std::move(because)});
    }
  }

  const Plan& plan_;
  const host::Registry& registry_;
  const std::vector<std::string>& settings_;
  ConfigReport& report_;
  host::PathRules paths_ = host::PathRules::of_process({}, plan_.file().folder);
  std::vector<PipelineDocument> bases_;  ///< pipelines with what they extend, read once
  host::ComponentChecks checks_;  ///< checks a component once, in however many parts it is used
  std::map<std::string, Mistake> mistakes_;  ///< by place and message
  std::set<std::vector<std::string>> filters_;
  std::size_t parts_ = 0;
};

/// How many pipelines a plan has; no more than are too many.
std::size_t pipelines_of(const Plan& plan) {
  std::size_t count = 0;
  for (const PlannedData& data : plan.data) count += data.sequences.size();
  for (const Axis& axis : plan.axes) {
    if (count <= kFewPipelines) count *= axis.values.size();
  }
  return count;
}

}  // namespace

std::pair<CheckedPipeline, ConfigReport> check_cell(const std::string& file,
                                                    PipelineDocument document,
                                                    const host::Registry& registry,
                                                    const std::string& output_folder,
                                                    host::ComponentChecks* checks) {
  const auto place_of = [&](const char* key) {
    const yaml::Node* node = document.root.find(key);
    return node != nullptr ? node->at : yaml::Position{};
  };
  const auto at_realtime = place_of("realtime"), at_budget = place_of("budget_ms");
  auto checked = check_pipeline(file, std::move(document), registry, output_folder, checks);
  auto& [pipeline, report] = checked;
  if (pipeline.config.latest_only) {
    report.problems.push_back(
        {at_realtime,
         "with 'realtime: latest' each run takes other frames, so that cells cannot be compared; "
         "set realtime: all for an ablation"});
  }
  if (pipeline.config.budget_ms > 0) {
    report.problems.push_back(
        {at_budget,
         "with 'budget_ms' results depend on the speed of the machine, so that cells cannot be "
         "compared; set budget_ms: 0 for an ablation"});
  }
  report.sort();
  return checked;
}

std::pair<Plan, ConfigReport> load_plan(const std::string& file, const host::Registry& registry,
                                        const std::vector<std::string>& settings,
                                        const Helpers& helpers, const PlanChanges& changes) {
  auto loaded = read_plan(file, registry, helpers, changes);
  auto& [plan, report] = loaded;
  plan.isolating = changes.isolating;
  const bool complete = report.ok() && pipelines_of(plan) <= kFewPipelines;
  if (!complete && !plan.pipelines.empty()) {
    PartsCheck(plan, registry, settings, report).check();
    report.sort();
  }
  return loaded;
}

}  // namespace weft::lab
