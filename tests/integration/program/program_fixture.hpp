// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "support/child.hpp"
#include "support/pipeline_fixture.hpp"

namespace weft::testing {

/// The program as a user starts it, in a separate folder, with the scripted components.
class Program : public PipelineTest {
 protected:
  std::vector<std::string> command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> words{"/usr/bin/env",   "-C", folder_, WEFT_PROGRAM, "--plugin-path",
                                   WEFT_TEST_PLUGINS};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
  }

  Ended weft(const std::vector<std::string>& arguments) const {
    return Child(command(arguments), path("printed")).wait();
  }

  Ended run(const std::string& text, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"run", write(text), "--out", path("run")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return weft(arguments);
  }

  /// False when it takes too long.
  static bool comes_true(const std::function<bool()>& condition) {
    for (int i = 0; i < 24'000; ++i) {
      if (condition()) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  /// Waits until the run has written this number of frames; false when it takes too long.
  bool wait_for_frames(std::size_t count) const {
    return comes_true([&] { return read_lines(path("run/frames.jsonl")).size() >= count; });
  }
};

}  // namespace weft::testing
