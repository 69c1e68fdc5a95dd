// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

#include "lab/metrics/metrics.hpp"
#include "lab/results/plan_record.hpp"
#include "pipeline/configuration/config.hpp"

namespace weft::lab {

/// Data seeds up to this one are for tuning, those above for reporting.
inline constexpr std::uint64_t kLastTuningSeed = 100;

/// Something with a name that is merged into the base pipeline.
struct NamedPatch {
  std::string name;
  yaml::Node patch;  ///< see Patch; positions in Plan::sources
};

/// One thing that is varied.
struct Axis {
  std::string name;
  std::vector<NamedPatch> values;  ///< [.] in the order of the plan
};

/// A group of sequences under one name of the plan.
struct PlannedData {
  std::string name;
  std::vector<NamedPatch> sequences;  ///< [.] in the order of the plan
};

/// Expectations and comparisons of the plan, with the place that names the metric.
struct PlannedExpectation {
  PlanExpectation expectation;
  yaml::Position metric_at;
};
struct PlannedComparison {
  PlanComparison comparison;
  yaml::Position metric_at;
};

/// How cells are measured and what of it is kept.
struct Measurement {
  EvaluationOptions options;
  bool frames = true;       ///< keep the figures of each frame
  double deadline_s = 0.0;  ///< [] s of a cell's own work; 0: none. No part of a cell's identity
};

/// How cells are handed to a cluster, see docs/cluster.md; the command line may override it.
struct PlannedCluster {
  std::string partition;
  std::vector<std::string> sbatch;      ///< further options of sbatch
  std::optional<double> chunk_minutes;  ///< [min] that a task is to take
  std::optional<double> cell_seconds;   ///< [s] that a cell takes
};

/// Components that an ablation uses without a plan that names them; set by the program.
struct Helpers {
  std::string frames_source;  ///< reads `folders`: a source with the parameters path, camera, truth
  std::string picture_sink;   ///< {use, params} as YAML: writes stills into worst/ beside itself
};

/// An ablation plan; docs/ablations.md describes the file.
struct Plan {
  std::vector<ConfigSource> sources;  ///< the plan file, what it extends, the command line
  /// Ids and metrics; former names in a patch are found when it is merged into a pipeline.
  std::vector<host::FormerName> former_names;
  std::string name;
  std::vector<std::string> pipelines;  ///< files of the base; several: one a value of `pipeline`,
                                       ///< which is then the first axis
  bool reporting = false;
  std::vector<Axis> axes;            ///< [.] in the order of the plan
  std::vector<PlannedData> data;     ///< [.] in the order of the plan
  std::vector<std::uint64_t> seeds;  ///< run seeds; none: the pipeline's own
  Measurement measurement;
  PlannedCluster cluster;
  std::vector<std::pair<std::string, yaml::Position>> show;  ///< metrics of the table
  std::vector<PlannedComparison> comparisons;                ///< [.] in the order of the plan
  std::vector<PlannedExpectation> expect;                    ///< [.] in the order of the plan
  Helpers helpers;
  Isolating isolating = Isolating::preferred;  ///< components with their own process in the cells

  /// Index of the base that cells with these values of the axes have.
  std::size_t pipeline_of(const std::vector<std::size_t>& values) const {
    return pipelines.size() > 1 ? values.front() : 0;
  }

  const ConfigSource& file() const { return sources.front(); }
  /// The folder where relative paths at this position start.
  const std::string& folder_of(yaml::Position at) const {
    return sources.at(to_index(at.source)).folder;
  }
  /// The value of each axis and a sequence, as they are merged into the pipeline; no sinks.
  std::vector<Patch> patches(const NamedPatch* sequence,
                             const std::vector<std::size_t>& values) const;
};

/// Changes of a plan by the command line.
struct PlanChanges {
  std::vector<std::string> settings;  ///< PATH=VALUE; the path begins with a key of a plan
  std::vector<std::string> without;   ///< parts to omit, named as in the key `without`
  Isolating isolating = Isolating::preferred;

  /// Takes the settings out of the list that are a plan's and not its pipelines'.
  static PlanChanges from(std::vector<std::string>& settings, std::vector<std::string> without);
};

/// True if a file is a plan rather than a pipeline: it names a pipeline, axes or data. False if it
/// cannot be read.
bool is_plan(const std::string& file);
bool is_plan(const yaml::Node& root);

/// Reads a plan and checks all of it that needs no pipeline. Use the plan only when the report is
/// ok; otherwise it holds what is sound.
std::pair<Plan, ConfigReport> read_plan(const std::string& file, const host::Registry& registry,
                                        const Helpers& helpers = {},
                                        const PlanChanges& changes = {});

/// All former names that a plan file uses, and what is wrong with its grammar; positions are in the
/// file. Each value of an axis and each data is merged into the pipeline once.
std::pair<std::vector<host::FormerName>, ConfigReport> former_names_in_plan(
    const std::string& file, const host::Registry& registry, const Helpers& helpers);

/// Reads a plan and merges its valid parts into the pipeline: each value of an axis and each data
/// once, with the first of all others. It thus finds an error in a plan of a million cells without
/// expanding it. Errors of some combinations only are left to Grid::expand.
std::pair<Plan, ConfigReport> load_plan(const std::string& file, const host::Registry& registry,
                                        const std::vector<std::string>& settings,
                                        const Helpers& helpers = {},
                                        const PlanChanges& changes = {});

}  // namespace weft::lab
