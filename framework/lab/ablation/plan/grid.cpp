// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/grid.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <weft/core/index.hpp>

#include "lab/ablation/plan/grid_parts.hpp"
#include "lab/ablation/plan/plan_parts.hpp"
#include "lab/metrics/forms/metric_path.hpp"

namespace weft::lab {

/// Expands a plan and collects what is wrong with it.
class GridBuilder {
 public:
  GridBuilder(Plan plan, const host::Registry& registry, std::vector<std::string> settings) {
    grid_.plan_ = std::move(plan);
    grid_.registry_ = &registry;
    grid_.checks_ = std::make_shared<host::ComponentChecks>();
    grid_.settings_ = std::move(settings);
    for (const std::string& pipeline : grid_.plan_.pipelines) {
      grid_.bases_.push_back(read_base(pipeline, registry, grid_.paths()));
    }
    parts_.resize(grid_.bases_.size());
    report_.sources = grid_.plan_.sources;
    for (const host::FormerName& each : grid_.plan_.former_names) {
      report_.warnings.push_back(warning_of(each, report_.sources));
    }
  }

  std::pair<Grid, ConfigReport> build() {
    const std::vector<Axis>& axes = grid_.plan_.axes;
    std::vector<std::size_t> values(axes.size());
    for (bool more = true; more;) {
      add_pipelines(values);
      std::size_t axis = axes.size();  // the last one runs fastest
      for (more = false; axis > 0 && !more; --axis) {
        values[axis - 1] = (values[axis - 1] + 1) % axes[axis - 1].values.size();
        more = values[axis - 1] != 0;
      }
    }
    report_mistakes();
    check_metrics();
    report_.sort();
    grid_.checks_.reset();  // a cell that is loaded later may find other files
    return {std::move(grid_), std::move(report_)};
  }

 private:
  struct Mistake {
    ConfigSource source;
    yaml::Problem problem;
    std::string cell;           ///< the first that has it
    std::size_t last = 0;       ///< the number of the last pipeline that has it
    std::size_t pipelines = 1;  ///< how many have it
  };

  void add_pipelines(const std::vector<std::size_t>& values) {
    for (std::size_t data = 0; data < grid_.plan_.data.size(); ++data) {
      const std::size_t count = grid_.plan_.data[data].sequences.size();
      for (std::size_t sequence = 0; sequence < count; ++sequence) {
        add_cells({values, data, sequence, 0, {}, {}});
      }
    }
  }

  void add_cells(Cell cell) {
    PipelineDocument document = grid_.document(cell);
    for (const host::FormerName& each : document.former_names) warn(document.sources, each);
    ++pipelines_;
    const std::vector<std::uint64_t>& seeds = grid_.plan_.seeds;
    const PartNames names = part_names(document.root);
    KnownParts& parts = parts_[grid_.plan_.pipeline_of(cell.values)];
    const bool legal = document.problems.empty();
    auto known = legal ? parts.find(names, seeds) : std::nullopt;
    if (!known) {
      auto [pipeline, report] = grid_.load(cell, std::move(document));
      if (report.ok()) {
        parts.note(names, pipeline, seeds, grid_.plan_.measurement, *grid_.identifier_,
                   report.problems);
      }
      for (const yaml::Problem& problem : report.problems) note(report.sources, problem, cell);
      known = parts.find(names, seeds);
      if (!known) return;  // after an error the grid is not used
    }
    filters_.insert(known->filters);
    cell.stages = std::move(known->stages);
    for (std::size_t i = 0; i < known->seeds.size(); ++i) {
      cell.seed = known->seeds[i];
      cell.identity = std::move(known->identities[i]);
      grid_.cells_.push_back(cell);
    }
  }

  void note(const std::vector<ConfigSource>& sources, const yaml::Problem& problem,
            const Cell& cell) {
    const std::string key = place_in(sources, problem.at) + ": " + problem.message;
    const auto known = mistakes_.find(key);
    if (known == mistakes_.end()) {
      const auto source = to_index(problem.at.source);
      mistakes_.emplace(key, Mistake{sources.at(source), problem, name_of(cell), pipelines_});
    } else if (known->second.last != pipelines_) {
      known->second.last = pipelines_;
      ++known->second.pipelines;
    }
  }

  /// Each position once, even if many cells have it.
  void warn(const std::vector<ConfigSource>& sources, const host::FormerName& name) {
    yaml::Problem warning = warning_of(name, sources);
    if (!warned_.insert(place_in(sources, name.at) + warning.message).second) return;
    warning.at.source = report_source(sources.at(to_index(name.at.source)));
    report_.warnings.push_back(std::move(warning));
  }

  /// The index of a text among those of the report.
  int report_source(const ConfigSource& source) {
    const auto same = [&](const ConfigSource& other) {
      return other.name == source.name && other.is_setting == source.is_setting;
    };
    auto at = std::find_if(report_.sources.begin(), report_.sources.end(), same);
    if (at == report_.sources.end()) at = report_.sources.insert(at, source);
    return static_cast<int>(at - report_.sources.begin());
  }

  /// An error in a part that the plan merges into a pipeline has one place. A value of another file
  /// may be wrong because of a merged part, so that the first such cell is named.
  void report_mistakes() {
    for (auto& entry : mistakes_) {
      auto& mistake = entry.second;
      mistake.problem.at.source = report_source(mistake.source);
      const bool in_plan = to_index(mistake.problem.at.source) < grid_.plan_.sources.size();
      if (!in_plan && mistake.pipelines < pipelines_) {
        mistake.problem.message += "\n    in the cell " + mistake.cell;
      }
      report_.problems.push_back(std::move(mistake.problem));
    }
  }

  std::string name_of(const Cell& cell) const {
    std::string name;
    for (const Axis& axis : grid_.plan_.axes) {
      name += axis.name + "=" + grid_.value_of(cell, axis.name) + ", ";
    }
    return name + "sequence=" + grid_.value_of(cell, "sequence");
  }

  void check_metrics() {
    if (!report_.problems.empty()) return;  // the stages are not known then
    for (const auto& [metric, at] : metrics_of(grid_.plan_)) check_metric(metric, at);
  }

  void check_metric(const std::string& metric, yaml::Position at) {
    std::string because;
    for (const std::vector<std::string>& filters : filters_) {
      because = why_no_metric(metric, filters);
      if (because.empty()) return;
    }
    report_.problems.push_back({at, std::move(because)});
  }

  Grid grid_;
  ConfigReport report_;
  std::vector<KnownParts> parts_;  ///< parts of each pipeline: texts count from its file on
  std::map<std::string, Mistake> mistakes_;  ///< by place and message
  std::set<std::vector<std::string>> filters_;
  std::set<std::string> warned_;  ///< places and messages
  std::size_t pipelines_ = 0;
};

std::pair<Grid, ConfigReport> Grid::expand(Plan plan, const host::Registry& registry,
                                           std::vector<std::string> settings) {
  return GridBuilder(std::move(plan), registry, std::move(settings)).build();
}

host::PathRules Grid::paths() const { return host::PathRules::of_process({}, plan_.file().folder); }

PipelineDocument Grid::document(const Cell& cell) const {
  const NamedPatch& sequence = plan_.data[cell.data].sequences[cell.sequence];
  const PipelineDocument& base = bases_[plan_.pipeline_of(cell.values)];
  auto document =
      laid_over(base, plan_.patches(&sequence, cell.values), settings_, *registry_, paths());
  document.isolating = plan_.isolating;
  return document;
}

std::pair<CheckedPipeline, ConfigReport> Grid::load(const Cell& cell,
                                                    PipelineDocument document) const {
  auto loaded = check_cell(plan_.pipelines[plan_.pipeline_of(cell.values)], std::move(document),
                           *registry_, {}, checks_.get());
  if (!plan_.seeds.empty()) loaded.first.config.seed = cell.seed;
  return loaded;
}

std::pair<CheckedPipeline, ConfigReport> Grid::load(const Cell& cell) const {
  return load(cell, document(cell));
}

std::vector<std::string> Grid::stage_keys(const CheckedPipeline& pipeline) const {
  return identifier_->stage_keys(pipeline, pipeline.config.seed);
}

std::string Grid::changed_input(const CheckedPipeline& pipeline) const {
  return identifier_->files().changed(input_paths(pipeline));
}

std::string Grid::value_of(const Cell& cell, const std::string& name) const {
  const PlannedData& data = plan_.data[cell.data];
  if (name == "data") return data.name;
  if (name == "sequence") return data.sequences[cell.sequence].name;
  if (name == "seed") return std::to_string(cell.seed);
  for (std::size_t axis = 0; axis < plan_.axes.size(); ++axis) {
    if (plan_.axes[axis].name == name) return plan_.axes[axis].values[cell.values[axis]].name;
  }
  return {};
}

std::pair<Grid, ConfigReport> load_grid(const std::string& file, const host::Registry& registry,
                                        std::vector<std::string> settings, const Helpers& helpers,
                                        std::vector<std::string> without, Isolating isolating) {
  PlanChanges changes = PlanChanges::from(settings, std::move(without));
  changes.isolating = isolating;
  auto [plan, report] = load_plan(file, registry, settings, helpers, changes);
  if (!report.ok()) return {Grid(), std::move(report)};
  return Grid::expand(std::move(plan), registry, std::move(settings));
}

}  // namespace weft::lab
