// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"

#include <csignal>

namespace weft::cli {
namespace {

// A signal handler can reach nothing but an object with static storage.
std::atomic<bool> interrupted{false};

}  // namespace

const std::atomic<bool>& watch_for_interruption() {
  std::signal(SIGINT, [](int) { interrupted = true; });
  std::signal(SIGTERM, [](int) { interrupted = true; });
  return interrupted;
}

}  // namespace weft::cli
