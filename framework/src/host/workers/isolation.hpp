// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace weft::host {

/// That a stage runs in a process of its own, and how.
struct Isolation {
  std::string program;                    ///< weft-worker; empty: beside the running program
  std::chrono::milliseconds deadline{0};  ///< [ms] for one call, 0 for none
};

}  // namespace weft::host
