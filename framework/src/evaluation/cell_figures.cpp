// SPDX-License-Identifier: Apache-2.0
#include "cell_figures.hpp"

#include "metric_path.hpp"

namespace weft::evaluation {

const StoredCell* CellFigures::find(const Cell& cell) const {
  const auto found = state_.stored.find(cell.identity.key);
  return found != state_.stored.end() ? &found->second : nullptr;
}

Result<double> CellFigures::at(const StoredCell& cell, const std::string& metric) {
  auto known = parsed_.find(cell.key);
  if (known == parsed_.end()) {
    auto metrics = nlohmann::json::parse(cell.metrics, nullptr, false);
    known = parsed_.emplace(cell.key, std::move(metrics)).first;
  }
  return metric_at(known->second, metric);
}

std::vector<std::string> shown_metrics(const Plan& plan) {
  std::vector<std::string> metrics;
  for (const auto& [metric, at] : plan.show) metrics.push_back(metric);
  if (metrics.empty()) metrics = {"all.error_solved.mean_mm", "counts.solved_percent"};
  return metrics;
}

}  // namespace weft::evaluation
