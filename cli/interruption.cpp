// SPDX-License-Identifier: Apache-2.0
#include "interruption.hpp"

#include <csignal>

namespace weft::cli {
namespace {

// A signal handler can reach nothing but an object with static storage.
std::atomic<bool> signal_came{false};

}  // namespace

const std::atomic<bool>& watch_for_interruption() {
  std::signal(SIGINT, [](int) { signal_came = true; });
  std::signal(SIGTERM, [](int) { signal_came = true; });
  return signal_came;
}

}  // namespace weft::cli
