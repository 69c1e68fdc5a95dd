// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include "lab/ablation/plan/plan.hpp"
#include "pipeline/runs/run.hpp"
#include "yaml/key_table.hpp"

namespace weft::lab {

/// Reads values of a plan strictly; every error goes to one list.
class PlanValues {
 public:
  explicit PlanValues(std::vector<yaml::Problem>& problems)
      : problems_(problems), of_text_(problems) {}

  /// Where the text itself was refused, what else is wrong there only follows.
  void problem(yaml::Position at, std::string message) {
    const auto here = [&](const yaml::Problem& other) { return other.at == at; };
    if (std::any_of(of_text_.begin(), of_text_.end(), here)) return;
    problems_.push_back({at, std::move(message)});
  }

  /// Number of errors so far.
  std::size_t count() const { return problems_.size(); }

  /// True if the use of the data is known, so that their seeds can be checked.
  bool data_use_known = true;

  /// True if the node is a map of no keys but these; `what` names it in messages.
  bool is_map(const yaml::Node& node, const std::string& what, const yaml::KeyTable& table);

  /// The same for a value that must be a map; the content of a misspelt key moves to the intended
  /// key.
  void correct_keys(yaml::Node& map, const std::string& what, const yaml::KeyTable& table);

  /// A text that is not empty, or "" after an error.
  std::string text(const yaml::Node& node, const std::string& what);

  /// The texts of a list.
  std::vector<std::pair<std::string, yaml::Position>> texts(const yaml::Node& node,
                                                            const std::string& what);

  std::optional<double> number(const yaml::Node& node, const std::string& what);
  std::optional<bool> flag(const yaml::Node& node, const std::string& what);

  /// A seed, a range "101-120", or a list of these; each only once.
  std::vector<std::uint64_t> seeds(const yaml::Node& node, const std::string& what);

  /// Letters, digits and . _ - + / only, so that tables and file names can contain the name.
  bool is_name(const std::string& name, yaml::Position at, const std::string& what);

  /// True if a name can be that of a folder, and stays inside the folder where it is made.
  bool is_folder_name(const std::string& name, yaml::Position at);

  /// Reads the value of `key` of the map; an error if it is missing and required.
  bool has(const yaml::Node& map, const char* key, const std::string& what);

  /// "no axis 'x'; did you mean 'y'?"
  void unknown(yaml::Position at, const std::string& what, const std::string& word,
               const std::vector<std::string>& known);

 private:
  void add_seeds(const yaml::Node& node, const std::string& what,
                 std::vector<std::uint64_t>& seeds);

  std::vector<yaml::Problem>& problems_;
  std::vector<yaml::Problem> of_text_;  ///< errors of YAML
};

/// Checks the pipeline of a cell: as weft::check_pipeline does, and whether another run of it takes
/// the same frames.
std::pair<CheckedPipeline, ConfigReport> check_cell(const std::string& file,
                                                    PipelineDocument document,
                                                    const host::Registry& registry,
                                                    const std::string& output_folder,
                                                    host::ComponentChecks* checks);

/// All metrics that a plan names.
std::vector<std::pair<std::string, yaml::Position>> metrics_of(const Plan& plan);

/// Reads `axes`; the names of those with errors go to `broken`.
std::vector<Axis> read_axes(const yaml::Node& node, const host::Registry& registry,
                            PlanValues& values, std::set<std::string>& broken);

/// The values of an axis of components. There is one for each that `use` names without those in
/// `except`. With `sweep: threshold`, there is one for each value of the parameter that the
/// component declares as its threshold. Each includes the parameters that `set` gives to a
/// component.
std::vector<NamedPatch> component_values(const yaml::Node& axis, const host::Registry& registry,
                                         PlanValues& values);

/// Reads `data`: names with the parts that they merge into the pipeline.
std::vector<PlannedData> read_data(const yaml::Node& node, const Plan& plan, PlanValues& values);

/// Reads `cluster`.
PlannedCluster read_cluster(const yaml::Node& node, PlanValues& values);

/// The patch in a map: its keys that belong to patches. Reports errors of its `set`.
yaml::Node patch_in(const yaml::Node& map, PlanValues& values);

/// A patch that makes one setting.
yaml::Node setting_patch(const std::string& path, yaml::Position at, const yaml::Node& value);

/// The entries of one patch, followed by those of another.
yaml::Node with_setting(yaml::Node patch, const std::string& path, yaml::Position at,
                        const yaml::Node& value);

}  // namespace weft::lab
