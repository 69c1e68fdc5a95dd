// SPDX-License-Identifier: Apache-2.0
#include "report/statistics.hpp"

#include <algorithm>
#include <map>
#include <weft/core/index.hpp>

#include "metrics/forms/catalogue.hpp"
#include "metrics/forms/metric_path.hpp"
#include "report/tables.hpp"

namespace weft::evaluation {
namespace {

/// A number for each combination of a seed and values of the other axes.
class Repeats {
 public:
  std::uint64_t number_of(const PlanCell& cell, std::size_t axis) {
    std::vector<std::string> others = cell.values;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(axis));
    return numbers_.try_emplace({cell.seed, others}, numbers_.size() + 1).first->second;
  }

 private:
  std::map<std::pair<std::uint64_t, std::vector<std::string>>, std::uint64_t> numbers_;
};

std::size_t axis_index(const Results& results, const std::string& name) {
  const auto axis = std::find_if(results.plan.axes.begin(), results.plan.axes.end(),
                                 [&](const PlanAxis& one) { return one.name == name; });
  return to_index(axis - results.plan.axes.begin());
}

}  // namespace

std::string measure_of(const std::string& metric) {
  return metric == kErrorMetric ? "mean 3D error" : metric;
}

Better better_of(const std::string& metric) {
  const MetricField* field = field_of(metric);
  return field != nullptr ? field->better.value_or(Better::lower) : Better::lower;
}

std::vector<Observation> observations_of(const Results& results, const PlanComparison& plan) {
  const std::size_t axis = axis_index(results, plan.axis);
  Repeats repeats;
  std::vector<Observation> observations;
  for (const PlanCell& cell : results.plan.cells) {
    const CellRecord& record = results.record(cell);
    if (record.outcome == CellOutcome::missing) continue;
    Observation one{cell.sequence, 0, repeats.number_of(cell, axis), cell.values[axis]};
    if (plan.metric != kErrorMetric) {
      one.value = record.figure(plan.metric);
      observations.push_back(one);
      continue;
    }
    for (const FrameError& error : record.errors) {
      one.frame = error.frame;
      one.value = error.mean_mm;
      observations.push_back(one);
    }
    if (record.errors.empty()) {
      one.frame = kEveryFrame;
      observations.push_back(one);
    }
  }
  return observations;
}

Result<ComparisonTable> compare(const Results& results, const PlanComparison& plan) {
  if (axis_index(results, plan.axis) == results.plan.axes.size()) {
    return Error{Errc::not_found,
                 "a comparison names the axis '" + plan.axis + "', which the plan does not have",
                 results.folder + "/plan.json"};
  }
  const std::vector<Observation> observations = observations_of(results, plan);
  if (observations.empty()) return ComparisonTable{};
  ComparisonOptions options;
  options.measure = measure_of(plan.metric);
  options.unit = unit_of(plan.metric);
  options.better = better_of(plan.metric);
  options.reference = plan.reference;
  return compare(observations, options);
}

}  // namespace weft::evaluation
