// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "support/pipeline_fixture.hpp"

namespace weft {

/// A run that is cancelled before a call: give `cancel` to run_pipeline().
struct Canceller : testing::Ran {
  /// True for the call to cancel: "detectors detect", and the frame.
  using IsIt = std::function<bool(const std::string& call, std::uint64_t frame)>;

  explicit Canceller(IsIt is_it) : is_it_(std::move(is_it)) {}
  void calling(const std::string& stage, const std::string& /*component*/, const std::string& what,
               std::uint64_t frame) override {
    if (is_it_(stage + " " + what, frame)) cancel = true;
  }

  std::atomic<bool> cancel{false};

 private:
  IsIt is_it_;
};

}  // namespace weft
