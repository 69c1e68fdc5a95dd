// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

/// The 3D error, which comparisons pair frame by frame.
inline constexpr const char* kErrorMetric = "all.error_solved.mean_mm";

/// The figure that a path such as "all.error_solved.mean_mm" names in the JSON of a RunMetrics; NaN
/// where it is null. In a list the path names an entry by its stage, kind or part, or leaves it out
/// where there is one entry only. The Error says what is missing.
Result<double> metric_at(const nlohmann::json& metrics, const std::string& path);

/// Why no run with these filter stages can have such a figure, or nothing.
std::string why_no_metric(const std::string& path, const std::vector<std::string>& filters);

}  // namespace weft::lab
