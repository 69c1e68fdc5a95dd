// SPDX-License-Identifier: Apache-2.0
#include "lab/report/tables/statistics.hpp"

#include <algorithm>
#include <map>
#include <weft/core/index.hpp>

#include "lab/metrics/forms/catalogue.hpp"
#include "lab/metrics/forms/metric_path.hpp"

namespace weft::lab {
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

constexpr const char* kData = "data";  ///< as `where` of a plan names it

/// The axes by which a comparison is split; data with too few sequences are no values.
std::vector<PlanAxis> other_few_valued_axes(const PlanRecord& plan, const std::string& axis) {
  constexpr std::size_t kMostValues = 8;
  std::vector<PlanAxis> axes;
  for (const PlanAxis& each : plan.axes) {
    if (each.name != axis && each.swept.empty()) axes.push_back(each);
  }
  PlanAxis data{kData, {}, "", {}, {}};
  for (const PlanData& each : plan.data) {
    if (std::ssize(each.sequences) >= kLeastSequences) data.values.push_back(each.name);
  }
  if (plan.data.size() > 1) axes.push_back(data);
  std::erase_if(axes, [](const PlanAxis& each) {
    return each.values.empty() || (each.values.size() < 2 && each.name != kData) ||
           each.values.size() > kMostValues;
  });
  return axes;
}

}  // namespace

Better better_of(const std::string& metric) {
  const MetricField* field = field_of(metric);
  return field != nullptr ? field->better.value_or(Better::lower) : Better::lower;
}

std::vector<Observation> observations_of(const Results& results, const PlanComparison& plan,
                                         const Selection& where) {
  const std::size_t axis = axis_index(results, plan.axis);
  Repeats repeats;
  std::vector<Observation> observations;
  for (const PlanCell& cell : results.plan.cells) {
    if (!results.plan.selects(where, cell)) continue;
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

ComparisonOptions options_of(const PlanComparison& plan) {
  ComparisonOptions options;
  options.measure = metric_name(plan.metric);
  options.unit = unit_of(plan.metric);
  options.better = better_of(plan.metric);
  options.reference = plan.reference;
  return options;
}

Result<ComparisonTable> compare(const Results& results, const PlanComparison& plan) {
  if (axis_index(results, plan.axis) == results.plan.axes.size()) {
    return Error{Errc::not_found,
                 "a comparison names the axis '" + plan.axis + "', which the plan does not have",
                 results.folder + "/plan.json"};
  }
  const std::vector<Observation> observations = observations_of(results, plan);
  if (observations.empty()) return ComparisonTable{};
  return compare(observations, options_of(plan));
}

Result<std::vector<SeparateComparison>> compare_separately(const Results& results,
                                                           const PlanComparison& plan) {
  std::vector<SeparateComparison> separate;
  for (const PlanAxis& axis : other_few_valued_axes(results.plan, plan.axis)) {
    std::vector<ObservationGroup> groups;
    for (const std::string& value : axis.values) {
      const std::string where =
          axis.name == kData ? "On " + value : "With " + axis.name + " " + value;
      groups.push_back({where, observations_of(results, plan, {{axis.name, value}})});
    }
    auto tables = compare_separately(groups, options_of(plan));
    if (!tables) return tables.error();
    separate.push_back({axis.name, axis.values, *std::move(tables)});
  }
  return separate;
}

}  // namespace weft::lab
