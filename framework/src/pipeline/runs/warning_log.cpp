// SPDX-License-Identifier: Apache-2.0
#include "pipeline/runs/warning_log.hpp"

#include <algorithm>

#include "pipeline/execution/frame_result.hpp"

namespace weft {

void WarningLog::note(const std::string& component, int level, const std::string& text,
                      std::uint64_t frame) {
  constexpr int kWarning = 2;
  if (level < kWarning) return;
  const std::lock_guard lock(mutex_);
  Told& told = told_[frame];
  const std::pair what{component, text};
  if (std::find(told.begin(), told.end(), what) == told.end()) told.push_back(what);
  if (frame == host::kOfflineFrame) file_told(frame, 0);
}

void WarningLog::file(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  file_told(frame, 1);
}

void WarningLog::forget(std::uint64_t frame) {
  const std::lock_guard lock(mutex_);
  told_.erase(frame);
}

std::vector<RunWarning> WarningLog::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(warnings_, {});
}

void WarningLog::file_told(std::uint64_t frame, std::int64_t frames) {
  constexpr std::size_t kMost = 100;
  for (const auto& [component, text] : std::exchange(told_[frame], {})) {
    const auto same = [&, &by = component, &said = text](const RunWarning& warning) {
      return warning.component == by && warning.text == said;
    };
    auto known = std::find_if(warnings_.begin(), warnings_.end(), same);
    if (known == warnings_.end()) {
      if (warnings_.size() == kMost) continue;
      known = warnings_.insert(known, {component, text, 0});
    }
    known->frames += frames;
  }
  told_.erase(frame);
}

}  // namespace weft
