// SPDX-License-Identifier: Apache-2.0
#include "files_by_stem.hpp"

#include <set>

#include "common/frame_files.hpp"

namespace weft::images {

Result<std::map<std::string, std::string>> files_by_stem(const std::string& parameter,
                                                         const std::string& pattern,
                                                         const std::vector<std::string>& stems) {
  std::map<std::string, std::string> files;
  if (pattern.empty()) return files;
  std::set<std::string> frames;
  for (const std::string& stem : stems) {
    if (frames.insert(stem).second) continue;
    return Error{Errc::invalid_value, "two frames have the stem '" + stem + "', so that '" +
                                          parameter +
                                          "' is ambiguous: narrow 'path' or rename one"};
  }
  const auto paths = sources::matching_files(pattern);
  if (!paths) return Error{paths.error().code, parameter + ": " + paths.error().message};
  for (const std::string& path : *paths) {
    const std::string stem = sources::stem_of(path);
    if (frames.count(stem) == 0) {
      return Error{Errc::invalid_data,
                   path + ": belongs to no frame: no image has the stem '" + stem + "'"};
    }
    const auto [twin, is_new] = files.emplace(stem, path);
    if (is_new) continue;
    return Error{Errc::invalid_data, path + ": belongs to the frame '" + stem +
                                         "', which already has " + twin->second + ": remove one"};
  }
  return files;
}

}  // namespace weft::images
