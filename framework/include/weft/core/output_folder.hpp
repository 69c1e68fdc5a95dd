// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>
#include <weft/core/whole_file.hpp>

namespace weft {

/// Whether a folder may be made at `path` without touching what is there: nothing, or a folder with
/// nothing in it. What cannot be looked into counts as taken.
inline bool is_free_for_folder(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  return !fs::exists(path, code) || (fs::is_directory(path, code) && fs::is_empty(path, code));
}

/// Makes a folder, with those above it that are missing. They survive a power cut from then on,
/// also where a process that was killed has made them.
inline std::error_code make_folders(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (path.empty() || path == path.root_path()) return {};
  if (!path.has_filename()) return make_folders(path.parent_path());  // of "runs/"
  if (!fs::is_directory(path, code)) {
    if (code = make_folders(path.parent_path()); code) return code;
    fs::create_directory(path, code);
    if (code) return code;
  }
  return sync_path(folder_of(path));
}

}  // namespace weft
