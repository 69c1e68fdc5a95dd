// SPDX-License-Identifier: Apache-2.0
#include "growing_folder.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>
#include <weft/core/file_order.hpp>
#include <weft/core/stop_check.hpp>

#include "common/frame_files.hpp"

namespace weft::images {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAskEvery{3};

bool has_wildcard(const std::string& text) { return text.find_first_of("*?[") != text.npos; }

bool is_folder(const fs::path& path) {
  std::error_code code;
  return fs::is_directory(path, code);
}

/// Until then, unless the call is cancelled.
void pause(Clock::time_point end, const Call& call) {
  for (auto now = Clock::now(); now < end && !call.cancelled(); now = Clock::now()) {
    std::this_thread::sleep_for(std::min<Clock::duration>(kAskEvery, end - now));
  }
}

}  // namespace

Result<GrowingFolder> GrowingFolder::open(const std::string& pattern, double wait_s) {
  const fs::path path(pattern);
  const std::string folder = path.parent_path().string(), name = path.filename().string();
  const auto refuse = [&](Errc code, const std::string& sentence) {
    return Error{code, pattern + ": " + sentence};
  };
  if (is_folder(path)) {
    return refuse(Errc::invalid_value, "is a folder: name its files, for example with /*.png");
  }
  if (!has_wildcard(name)) {
    if (const std::string hint = numbering_hint(name); !hint.empty()) {
      return refuse(Errc::invalid_value, hint);
    }
    return refuse(Errc::invalid_value,
                  "names one file: with 'wait_s' give a pattern of those that will come, for "
                  "example with /*.png");
  }
  if (is_folder(folder)) return GrowingFolder(folder, name, wait_s);
  if (has_wildcard(folder)) {
    return refuse(Errc::invalid_value,
                  "with 'wait_s', * ? and [ ] may occur in the file name only: one folder grows");
  }
  return refuse(Errc::not_found,
                "the folder " + folder + " does not exist: make it before the run, or correct it");
}

Result<std::string> GrowingFolder::next(const Call& call) {
  // A look into a large folder takes long: four times as long is paused.
  constexpr int kPauses = 4;
  Clock::time_point quiet_since = Clock::now();
  for (;;) {
    if (call.cancelled()) return Error{Errc::cancelled, "cancelled"};
    const Clock::time_point start = Clock::now();
    if (auto listed = list(call); !listed) return listed.error();
    if (has_complete()) return take();
    const Clock::time_point now = Clock::now();
    if (!waiting_.empty()) quiet_since = now;
    if (std::chrono::duration<double>(now - quiet_since).count() >= wait_s_) return ending();
    pause(now + std::max<Clock::duration>(kAskEvery, kPauses * (now - start)), call);
  }
}

/// Finds what is waiting.
Result<void> GrowingFolder::list(const Call& call) {
  constexpr std::int64_t kPassesAnEntry = 30;
  waiting_.clear();
  std::error_code code;
  for (fs::directory_iterator entry(folder_, code), end; !code && entry != end;
       entry.increment(code)) {
    worked(kPassesAnEntry);
    std::string name = entry->path().filename().string();
    if (settled_.count(name) > 0 || !sources::matches_name(name_, name)) continue;
    if (natural_less(last_, name)) {
      waiting_.push_back(std::move(name));
      continue;
    }
    call.log_warning(path_of(name) + ": sorts before " + last_ +
                     ", which was read already: it is skipped; give files names in the order in "
                     "which they arrive");
    settled_.insert(std::move(name));
    ++late_;
  }
  std::sort(waiting_.begin(), waiting_.end(), natural_less);
  if (!code) return {};
  return Error{Errc::io, folder_ + ": the folder can no longer be listed: " + code.message()};
}

/// True if the first waiting file can be returned.
bool GrowingFolder::has_complete() {
  constexpr double kStill_s = 1.0;
  if (waiting_.empty()) return false;
  const std::string path = path_of(waiting_.front());
  if (!first_ || first_->path() != path) first_.emplace(path);
  return first_->is_complete(waiting_.size() > 1, std::min(kStill_s, wait_s_));
}

std::string GrowingFolder::take() {
  last_ = waiting_.front();
  settled_.insert(last_);
  late_ = 0;
  first_.reset();
  return path_of(last_);
}

/// Why there is no next file.
Error GrowingFolder::ending() const {
  const std::string files = path_of(name_);
  if (late_ > 0) {
    return {Errc::invalid_data,
            files + ": no new file for 'wait_s' but " + std::to_string(late_) +
                " that sort before " + last_ +
                ", which was read already: give files names in the order in which they arrive",
            {}};
  }
  if (!last_.empty()) return no_more_frames(files + ": no new file for 'wait_s'");
  return {Errc::not_found,
          files +
              ": no file came for 'wait_s': check the pattern and its letters' case, or wait "
              "longer",
          {}};
}

}  // namespace weft::images
