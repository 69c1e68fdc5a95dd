// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <weft/core/result.hpp>
#include <weft/evaluation/results.hpp>

namespace weft::evaluation {

/// A number of an object, or NaN where there is null or nothing.
double number_of(const nlohmann::json& object, const char* key);

/// Reads manifest.json and plan.json; everything but the records.
Result<Results> read_results_plan(const std::string& folder);

}  // namespace weft::evaluation
