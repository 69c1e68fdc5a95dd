// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include <weft/evaluation/ablation.hpp>

namespace weft::evaluation {

/// Figures of the cells of an ablation; the metrics of each key are parsed once.
class CellFigures {
 public:
  explicit CellFigures(const AblationState& state) : state_(state) {}

  /// Null where the cell is not finished.
  const StoredCell* find(const Cell& cell) const;

  Result<double> at(const StoredCell& cell, const std::string& metric);

 private:
  const AblationState& state_;
  std::map<std::string, nlohmann::json> parsed_;
};

/// The metrics that the plan wants to see, or those that most plans want.
std::vector<std::string> shown_metrics(const Plan& plan);

}  // namespace weft::evaluation
