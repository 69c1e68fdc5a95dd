// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace weft {

/// Whether a folder may be made at `path` without touching what is there: nothing, or a folder with
/// nothing in it. What cannot be looked into counts as taken.
inline bool is_free_for_folder(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  return !fs::exists(path, code) || (fs::is_directory(path, code) && fs::is_empty(path, code));
}

}  // namespace weft
