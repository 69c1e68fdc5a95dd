// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <weft/core/params.hpp>
#include <weft/sdk/call.hpp>

namespace scripted {

/// Signals to a test that a call runs, and blocks the call until the test has seen it. While the
/// file `gate` exists, a call writes its process id into `gate.arrived` and waits until that file
/// is removed. A call ends when it is cancelled, unless there is a file `gate.deaf`.
class Gate {
 public:
  explicit Gate(weft::Params& p) {
    p.text("gate", path_, "file in the working directory that holds calls while it is there");
  }

  /// The error of a call that was cancelled while it waited.
  std::optional<weft::Error> pass(const weft::Call& call) {
    const std::string mine = std::to_string(getpid()) + " " + std::to_string(++calls_);
    bool arrived = false;
    while (!path_.empty() && there("")) {
      if (arrived && content() != mine) break;
      arrived = arrived || arrive(mine);
      if (call.cancelled() && !there(".deaf")) {
        return weft::Error{weft::Errc::cancelled, "cancelled at the gate", ""};
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return std::nullopt;
  }

 private:
  bool there(const char* suffix) const {
    std::error_code ignored;
    return std::filesystem::exists(path_ + suffix, ignored);
  }

  std::string content() const {
    std::ifstream stream(path_ + ".arrived");
    std::string line;
    std::getline(stream, line);
    return line;
  }

  /// False while another call is there: one at a time.
  bool arrive(const std::string& mine) const {
    const std::string made = path_ + "." + std::to_string(getpid());
    std::ofstream(made) << mine;
    const bool first = link(made.c_str(), (path_ + ".arrived").c_str()) == 0;
    unlink(made.c_str());
    return first;
  }

  std::string path_;
  std::int64_t calls_ = 0;
};

}  // namespace scripted
