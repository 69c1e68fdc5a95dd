// SPDX-License-Identifier: Apache-2.0
#include "lab/ablation/plan/input_files.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "host/records/content_hash.hpp"

namespace weft::lab {

std::vector<InputFiles::File> InputFiles::look_at(const std::string& path) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  std::vector<File> files;
  const auto found = host::files_of(path);
  if (!found) return files;
  for (const std::string& each : *found) {
    struct stat status {};
    File& file = files.emplace_back(File{each});
    if (stat(each.c_str(), &status) != 0) continue;
    file.device = status.st_dev;
    file.number = status.st_ino;
    file.bytes = static_cast<std::uint64_t>(status.st_size);
    file.changed_ns = status.st_mtim.tv_sec * kSecond_ns + status.st_mtim.tv_nsec;
  }
  return files;
}

const Result<std::string>& InputFiles::hash_of(const std::string& path) {
  const auto known = known_.find(path);
  if (known != known_.end()) return known->second.hash;
  std::vector<File> files = look_at(path);
  Known now{std::move(files), host::hash_of_files(path)};
  return known_.emplace(path, std::move(now)).first->second.hash;
}

std::string InputFiles::changed(const std::vector<std::string>& paths) const {
  const auto is_other = [&](const std::string& path) {
    const auto known = known_.find(path);
    if (known == known_.end() || look_at(path) == known->second.files) return false;
    const Result<std::string>& before = known->second.hash;
    const Result<std::string> now = host::hash_of_files(path);
    return !before || !now || *before != *now;
  };
  const auto found = std::find_if(paths.begin(), paths.end(), is_other);
  return found == paths.end() ? std::string() : *found;
}

}  // namespace weft::lab
