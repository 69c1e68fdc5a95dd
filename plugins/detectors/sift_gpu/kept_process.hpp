// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <signal.h>

#include <array>
#include <string>
#include <vector>

namespace weft::sift_gpu {

/// Drivers install handlers of signals and set environment variables when they are used first.
/// Both belong to the program: when this ends, handlers are as they were, and variables that have
/// come are gone.
class KeptProcess {
 public:
  KeptProcess();
  ~KeptProcess();
  KeptProcess(const KeptProcess&) = delete;
  KeptProcess& operator=(const KeptProcess&) = delete;

 private:
  std::array<struct sigaction, NSIG> actions_{};
  std::vector<std::string> variables_;  ///< their names, sorted
};

}  // namespace weft::sift_gpu
