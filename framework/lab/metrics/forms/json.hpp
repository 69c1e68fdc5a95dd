// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <weft/core/result.hpp>

#include "lab/metrics/run_metrics.hpp"

namespace weft::lab {

/// Metrics as an object, its members in the order of their declaration.
nlohmann::ordered_json json_of(const RunMetrics& metrics);

/// The inverse. Members that a file lacks, such as those of older programs, stay without a value;
/// Errc::invalid_data if a member has another type.
Result<RunMetrics> metrics_of(const nlohmann::json& object);

}  // namespace weft::lab
