// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

/// The 3D error, which comparisons pair frame by frame.
inline constexpr const char* kErrorMetric = "all.error_solved.mean_mm";

/// The number at a path such as "all.error_solved.mean_mm" in the JSON of a RunMetrics; NaN if it
/// is null. In a list, the path names an entry by its stage, kind or part, which a list with one
/// entry does not need. The Error names the missing part.
Result<double> metric_at(const nlohmann::json& metrics, const std::string& path);

/// Why no run with these filter stages can have such a figure, or nothing.
std::string why_no_metric(const std::string& path, const std::vector<std::string>& filters);

}  // namespace weft::lab
