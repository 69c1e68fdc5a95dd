// SPDX-License-Identifier: Apache-2.0
#include "written_file.hpp"

#include <filesystem>
#include <system_error>
#include <weft/images/image_file.hpp>

namespace weft::images {

bool WrittenFile::is_complete(bool has_later, double still_s) {
  constexpr int kFewestLooks = 20;
  const auto now = std::chrono::steady_clock::now();
  if (const State state = look(); !state_ || !(*state_ == state)) {
    state_ = state;
    since_ = now;
    looks_ = 0;
    end_ = find_end();
  }
  ++looks_;
  if (end_ == End::there || (end_ == End::unmarked && has_later)) return true;
  return looks_ >= kFewestLooks && std::chrono::duration<double>(now - since_).count() >= still_s;
}

/// A path that is missing or is no regular file has a state as well, which does not change.
WrittenFile::State WrittenFile::look() const {
  std::error_code ignored;
  const std::uintmax_t bytes = std::filesystem::file_size(path_, ignored);
  const auto changed = std::filesystem::last_write_time(path_, ignored).time_since_epoch();
  return {bytes, static_cast<std::int64_t>(changed.count())};
}

WrittenFile::End WrittenFile::find_end() const {
  const auto file = read_image_bytes(path_);
  if (!file || file->header.width_px == 0) return End::missing;
  return file->header.complete ? End::there : End::unmarked;
}

}  // namespace weft::images
