// SPDX-License-Identifier: Apache-2.0
#include "frame_files.hpp"

#include <fnmatch.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

namespace weft::images {
namespace {

namespace fs = std::filesystem;

bool has_wildcard(const std::string& text) { return text.find_first_of("*?[") != text.npos; }

/// Adds the files below `base` that match the parts of the path that remain.
void expand(const fs::path& base, fs::path::iterator part, fs::path::iterator end,
            std::vector<std::string>& found) {
  if (part == end) {
    if (fs::is_regular_file(base)) found.push_back(base.string());
    return;
  }
  const std::string name = part->string();
  if (!has_wildcard(name) || fs::exists(base / name)) {
    expand(base / name, std::next(part), end, found);
  } else if (fs::is_directory(base)) {
    for (const fs::directory_entry& entry : fs::directory_iterator(base)) {
      if (fnmatch(name.c_str(), entry.path().filename().c_str(), FNM_PERIOD) == 0) {
        expand(entry.path(), std::next(part), end, found);
      }
    }
  }
}

/// Why nothing matches, and what to change.
std::string explanation(const fs::path& pattern) {
  if (fs::is_directory(pattern)) return "it is a folder: name its files, for example with /*.png";
  fs::path folder;
  for (const fs::path& part : pattern.parent_path()) {
    if (has_wildcard(part.string())) break;
    folder /= part;
    if (!fs::exists(folder)) return "the folder " + folder.string() + " does not exist";
  }
  return "there are folders but no such file: check the pattern and its letters' case";
}

}  // namespace

Result<std::vector<std::string>> matching_files(const std::string& pattern) {
  const fs::path path(pattern);
  std::vector<std::string> found;
  try {
    expand({}, path.begin(), path.end(), found);
    if (found.empty()) {
      return Error{Errc::not_found, "no file matches '" + pattern + "': " + explanation(path), {}};
    }
  } catch (const fs::filesystem_error& failure) {
    return Error{Errc::io, "cannot look for '" + pattern + "': " + failure.what(), {}};
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string stem_of(const std::string& path) { return fs::path(path).stem().string(); }

}  // namespace weft::images
