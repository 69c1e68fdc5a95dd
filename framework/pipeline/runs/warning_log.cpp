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
  Told& told = told_[frame];
  const std::pair what{component, text};
  const bool is_known = std::find(told.texts.begin(), told.texts.end(), what) != told.texts.end();
  if (!is_known && told.texts.size() < kMost) told.texts.push_back(what);
  if (!is_known && told.texts.back() != what) ++told.more[component];
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
  for (const auto& [component, more] : std::exchange(more_, {})) {
    warnings_.push_back({component,
                         "and " + std::to_string(more.warnings) + " more warnings: the first " +
                             std::to_string(kMost) +
                             " different ones of a frame and of a run are listed",
                         more.frames});
  }
  return std::exchange(warnings_, {});
}

void WarningLog::file_told(std::uint64_t frame, std::int64_t frames) {
  Told told = std::exchange(told_[frame], {});
  for (const auto& [component, text] : told.texts) {
    const auto same = [&, &by = component, &said = text](const RunWarning& warning) {
      return warning.component == by && warning.text == said;
    };
    auto known = std::find_if(warnings_.begin(), warnings_.end(), same);
    if (known == warnings_.end()) {
      if (warnings_.size() == kMost) {
        ++told.more[component];
        continue;
      }
      known = warnings_.insert(known, {component, text, 0});
    }
    known->frames += frames;
  }
  for (const auto& [component, warnings] : told.more) {
    more_[component].warnings += warnings;
    more_[component].frames += frames;
  }
  told_.erase(frame);
}

}  // namespace weft
