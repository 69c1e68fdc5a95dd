// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/execution/run_warning.hpp"

namespace weft {

/// Counts warnings of components, each text once a frame. Frames may warn in any order: they are
/// counted when they are filed. The first 100 different texts of a frame and of all frames are
/// kept; of the others each component's number. From any thread.
class WarningLog {
 public:
  void note(const std::string& component, int level, const std::string& text, std::uint64_t frame);

  /// The frame is one of those that are counted.
  void file(std::uint64_t frame);

  /// The frame is none of them.
  void forget(std::uint64_t frame);

  std::vector<RunWarning> take();

 private:
  struct FrameWarnings {
    std::vector<std::pair<std::string, std::string>> texts;  ///< component, text
    std::map<std::string, std::int64_t> more;                ///< beyond those, by component
  };
  struct More {
    std::int64_t warnings = 0, frames = 0;  ///< [] numbers of further ones
  };

  void file_logged(std::uint64_t frame, std::int64_t frames);

  std::mutex mutex_;
  std::map<std::uint64_t, FrameWarnings> logged_;  ///< by frame, not yet filed
  std::vector<RunWarning> warnings_;
  std::map<std::string, More> more_;  ///< that are not among them, by component
};

}  // namespace weft
