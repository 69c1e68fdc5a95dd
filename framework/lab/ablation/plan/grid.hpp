// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "host/loading/registry.hpp"
#include "lab/ablation/plan/cell_identity.hpp"
#include "lab/ablation/plan/plan.hpp"
#include "pipeline/runs/run.hpp"

namespace weft::lab {

/// One value of each axis, one sequence and one run seed.
struct Cell {
  std::vector<std::size_t> values;  ///< value of each axis, as an index
  std::size_t data = 0;             ///< index into Plan::data
  std::size_t sequence = 0;         ///< index into its sequences
  std::uint64_t seed = 0;           ///< [] run seed
  std::vector<std::string> stages;  ///< names
  CellIdentity identity;            ///< without the keys of the stages, see Grid::stage_keys
};

/// All cells of a plan, each loaded, wired and checked once. If a cell is made of parts of other
/// cells without errors, only the parts are.
class Grid {
 public:
  /// Expands the plan over `settings` of the command line. The report has all errors of all cells,
  /// each once; use the grid only when it is ok.
  static std::pair<Grid, ConfigReport> expand(Plan plan, const host::Registry& registry,
                                              std::vector<std::string> settings);

  const Plan& plan() const { return plan_; }
  const std::vector<Cell>& cells() const { return cells_; }
  const host::Registry& registry() const { return *registry_; }
  const std::vector<std::string>& settings() const { return settings_; }

  /// The pipeline of a cell, with its run seed and without sinks. It was ok when the grid was made.
  std::pair<CheckedPipeline, ConfigReport> load(const Cell& cell) const;

  /// The keys of the stages of a cell's pipeline, which cells() omit.
  std::vector<std::string> stage_keys(const CheckedPipeline& pipeline) const;

  /// A path of the pipeline whose files are not what they were when the grid was made; empty when
  /// there is none.
  std::string changed_input(const CheckedPipeline& pipeline) const;

  /// "myneighbor" of the axis `filter`, "plain" of `data`, "plain_101" of `sequence`, "1" of
  /// `seed`.
  std::string value_of(const Cell& cell, const std::string& name) const;

  /// Takes the result of another key for this cell's.
  void adopt(std::size_t cell, const std::string& key) { cells_[cell].identity.key = key; }

  /// The record of the plan in a results folder. `command` repeats the ablation.
  PlanRecord record(const std::string& command) const;

 private:
  friend class GridBuilder;
  host::PathRules paths() const;
  PipelineDocument document(const Cell& cell) const;
  std::pair<CheckedPipeline, ConfigReport> load(const Cell& cell, PipelineDocument document) const;

  Plan plan_;
  const host::Registry* registry_ = nullptr;
  std::shared_ptr<host::ComponentChecks> checks_;  ///< checks of this expansion
  std::vector<std::string> settings_;
  std::vector<PipelineDocument> bases_;  ///< one for each of the plan's pipelines
  std::vector<Cell> cells_;
  std::shared_ptr<Identifier> identifier_ = std::make_shared<Identifier>();
};

/// Reads, checks and expands a plan; use the grid only when the report is ok. Settings whose path
/// begins with a key of a plan (`axes.bend.values`, `data_use`) change the plan, all others its
/// pipelines; `without` names axes, values and data to omit. `isolating` changes neither results
/// nor the keys of cells.
std::pair<Grid, ConfigReport> load_grid(const std::string& file, const host::Registry& registry,
                                        std::vector<std::string> settings,
                                        const Helpers& helpers = {},
                                        std::vector<std::string> without = {},
                                        Isolating isolating = Isolating::preferred);

}  // namespace weft::lab
