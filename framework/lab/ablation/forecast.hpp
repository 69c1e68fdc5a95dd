// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "lab/ablation/ablation.hpp"

namespace weft::lab {

/// How far one value of an axis, or one data, is.
struct ValueProgress {
  std::string name;
  std::size_t cells = 0, finished = 0;  ///< done or failed
};

/// Size of a results folder, in bytes.
double bytes_in(const std::string& folder);

/// Forecast for the cells without a result, if they are like those that have one: a mean over keys,
/// since cells share stages as they come.
struct Forecast {
  std::vector<std::pair<std::string, std::vector<ValueProgress>>> axes;  ///< and "data", last
  std::size_t missing = 0;         ///< keys without a result, damaged ones counted
  std::size_t finished = 0;        ///< keys with one, of other plans in the folder too
  double seconds_left = kUnknown;  ///< [s] of `jobs` processes; NaN where no time is known
  double bytes_left = kUnknown;    ///< [bytes] more; NaN where nothing is there
};

Forecast forecast(const AblationState& state, double bytes, int jobs);

}  // namespace weft::lab
