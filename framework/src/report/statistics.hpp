// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "results/results.hpp"
#include "statistics/comparison.hpp"

namespace weft::evaluation {

/// The name of a metric in a sentence.
std::string measure_of(const std::string& metric);
/// Whether a metric had better be low or high.
Better better_of(const std::string& metric);

/// What the cells say of the values of the comparison's axis. The 3D error enters frame by frame,
/// every other metric cell by cell. Cells that differ on other axes are paired with each other and
/// count as further seeds of their sequence. A cell that has not been run says nothing.
std::vector<Observation> observations_of(const Results& results, const PlanComparison& plan);

/// Compares the values of the axis; fails where the plan has no such axis or reference.
Result<ComparisonTable> compare(const Results& results, const PlanComparison& plan);

}  // namespace weft::evaluation
