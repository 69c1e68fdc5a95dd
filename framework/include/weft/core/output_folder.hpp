// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>
#include <weft/core/whole_file.hpp>

namespace weft {

/// Returns whether a folder can be created at `path` without a change of existing data. The path
/// must be free or an empty folder. A path that cannot be read counts as occupied.
inline bool is_free_for_folder(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  return !fs::exists(path, code) || (fs::is_directory(path, code) && fs::is_empty(path, code));
}

/// Creates a folder with its missing parents and syncs them to the disk, so that they survive a
/// power cut. Folders that another, killed process created are synced too.
inline std::error_code make_folders(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code code;
  if (path.empty() || path == path.root_path()) return {};
  if (!path.has_filename()) return make_folders(path.parent_path());  // a path such as "runs/"
  if (!fs::is_directory(path, code)) {
    if (code = make_folders(path.parent_path()); code) return code;
    fs::create_directory(path, code);
    if (code) return code;
  }
  return sync_path(folder_of(path));
}

}  // namespace weft
