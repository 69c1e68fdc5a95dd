// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

namespace weft::host {

/// The process in which an isolated stage runs.
struct Isolation {
  std::string program;                    ///< weft-worker; empty: beside the running program
  std::chrono::milliseconds deadline{0};  ///< [ms] for one call, 0 for none
  /// Frames do not wait: where a start takes long, a second process stands ready for the first
  /// one's death.
  bool keeps_spare = false;
  bool starts_again = true;  ///< after a death; what it has written is not written over otherwise
};

}  // namespace weft::host
