// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/warning_log.hpp"

#include <algorithm>

#include "pipeline/execution/frame_result.hpp"

namespace weft {
namespace {

constexpr std::size_t kMost = 100;  ///< texts of a frame, and of all frames

}  // namespace

void WarningLog::note(const std::string& component, int level, const std::string& text,
                      std::uint64_t frame) {
  constexpr int kWarning = 2;
  if (level < kWarning) return;
  const std::lock_guard lock(mutex_);
  FrameWarnings& logged = logged_[frame];
  const std::pair what{component, text};
  const bool is_known =
      std::find(logged.texts.begin(), logged.texts.end(), what) != logged.texts.end();
  if (!is_known && logged.texts.size() < kMost) logged.texts.push_back(what);
  if (!is_known && logged.texts.back() != what) ++logged.more[component];
  if (frame == host::kOfflineFrame) file_logged(frame, 0);
}

void WarningLog::file(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  file_logged(frame, 1);
}

void WarningLog::forget(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  logged_.erase(frame);
}

std::vector<RunWarning> WarningLog::take() {
  const std::lock_guard lock(mutex_);
  for (const auto& [component, more] : std::exchange(more_, {})) {
    warnings_.push_back({component,
                         "and " + std::to_string(more.warnings) + " more warnings: the first " +
                             std::to_string(kMost) +
                             " different ones of a frame and of a run are listed",
                         more.frames});
  }
  return std::exchange(warnings_, {});
}

void WarningLog::file_logged(std::uint64_t frame, std::int64_t frames) {
  FrameWarnings logged = std::exchange(logged_[frame], {});
  for (const auto& [component, text] : logged.texts) {
    const auto same = [&, &by = component, &said = text](const RunWarning& warning) {
      return warning.component == by && warning.text == said;
    };
    auto known = std::find_if(warnings_.begin(), warnings_.end(), same);
    if (known == warnings_.end()) {
      if (warnings_.size() == kMost) {
        ++logged.more[component];
        continue;
      }
      known = warnings_.insert(known, {component, text, 0});
    }
    known->frames += frames;
  }
  for (const auto& [component, warnings] : logged.more) {
    more_[component].warnings += warnings;
    more_[component].frames += frames;
  }
  logged_.erase(frame);
}

}  // namespace weft
