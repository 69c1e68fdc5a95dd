// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/results/results.hpp"
#include "lab/statistics/comparison.hpp"

namespace weft::lab {

/// The better direction of a metric.
Better better_of(const std::string& metric);

/// The observations on the values of the comparison's axis, from the cells that `where` selects.
/// The 3D error enters frame by frame, every other metric cell by cell. Cells that differ on other
/// axes are paired with each other and count as further seeds of their sequence. A cell that has
/// not been run gives no observation.
std::vector<Observation> observations_of(const Results& results, const PlanComparison& plan,
                                         const Selection& where = {});

/// How a comparison is named, and which way is better.
ComparisonOptions options_of(const PlanComparison& plan);

/// Compares the values of the axis; fails where the plan has no such axis or reference.
Result<ComparisonTable> compare(const Results& results, const PlanComparison& plan);

/// The same comparison with one value of another axis at a time.
struct SeparateComparison {
  std::string axis;                     ///< axis of the plan, or "data"
  std::vector<std::string> values;      ///< values of that axis
  std::vector<ComparisonTable> tables;  ///< one a value; they are one family
};

/// One entry for each other axis of a few values that sweeps no number, and for the data where a
/// kind of them has enough sequences to decide anything.
Result<std::vector<SeparateComparison>> compare_separately(const Results& results,
                                                           const PlanComparison& plan);

}  // namespace weft::lab
