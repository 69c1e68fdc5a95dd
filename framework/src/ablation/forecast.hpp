// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ablation/ablation.hpp"

namespace weft::evaluation {

/// How far one value of an axis, or one data, is.
struct ValueProgress {
  std::string name;
  std::size_t cells = 0, finished = 0;  ///< done or failed
};

/// What a results folder has cost so far.
struct FolderCosts {
  double seconds = 0.0;  ///< [s] of processes, by the times at which files of lines begin and end;
                         ///< 0 where the file system does not tell, or the folder is a copy
  double bytes = 0.0;    ///< [bytes]
};
FolderCosts costs_of(const std::string& folder);

/// What the cells that have no result will take, if they are like those that have one: a mean over
/// keys, since cells share stages as they come.
struct Forecast {
  std::vector<std::pair<std::string, std::vector<ValueProgress>>> axes;  ///< and "data", last
  std::size_t missing = 0;         ///< keys without a result, damaged ones counted
  std::size_t finished = 0;        ///< keys with one, of other plans in the folder too
  double seconds_left = kUnknown;  ///< [s] of `jobs` processes; NaN where no time is known
  double bytes_left = kUnknown;    ///< [bytes] more; NaN where nothing is there
};

Forecast forecast(const AblationState& state, const FolderCosts& costs, int jobs);

}  // namespace weft::evaluation
