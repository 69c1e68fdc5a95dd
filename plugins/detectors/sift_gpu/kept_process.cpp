// SPDX-License-Identifier: Apache-2.0
#include "kept_process.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>

namespace weft::sift_gpu {
namespace {

std::vector<std::string> variables() {
  std::vector<std::string> names;
  for (char** entry = environ; entry != nullptr && *entry != nullptr; ++entry) {
    const std::string text = *entry;
    names.push_back(text.substr(0, text.find('=')));
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// sa_handler and sa_sigaction lie in one place.
bool is_same(const struct sigaction& a, const struct sigaction& b) {
  return a.sa_handler == b.sa_handler && a.sa_flags == b.sa_flags;
}

}  // namespace

KeptProcess::KeptProcess() : variables_(variables()) {
  for (int signal = 1; signal < NSIG; ++signal) {
    sigaction(signal, nullptr, &actions_.at(static_cast<std::size_t>(signal)));
  }
}

KeptProcess::~KeptProcess() {
  for (int signal = 1; signal < NSIG; ++signal) {
    const struct sigaction& before = actions_.at(static_cast<std::size_t>(signal));
    struct sigaction now {};
    if (sigaction(signal, nullptr, &now) != 0 || is_same(now, before)) continue;
    sigaction(signal, &before, nullptr);
  }
  for (const std::string& name : variables()) {
    const bool was_there = std::binary_search(variables_.begin(), variables_.end(), name);
    if (!was_there) unsetenv(name.c_str());
  }
}

}  // namespace weft::sift_gpu
