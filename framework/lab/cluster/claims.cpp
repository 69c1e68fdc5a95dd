// SPDX-License-Identifier: Apache-2.0
#include "lab/cluster/claims.hpp"

#include <filesystem>

#include "lab/cluster/submission.hpp"

namespace weft::cluster {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> entries_of(const fs::path& folder) {
  std::error_code code;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, code)) entries.push_back(entry.path());
  return entries;
}

}  // namespace

Result<Claims> Claims::open(const std::string& results) {
  const Claims claims(cluster_folder(results));
  for (const char* inner : {"claims", "work"}) {
    std::error_code code;
    fs::create_directories(claims.folder_ + "/" + inner, code);
    if (code) return Error{Errc::io, "cannot be written (" + code.message() + ")", claims.folder_};
  }
  return claims;
}

Result<std::string> Claims::take(const std::string& key, const std::string& task) const {
  const fs::path claim = fs::path(folder_) / "claims" / key;
  constexpr int kTries = 100;  // an owner may let go of it in between
  std::error_code code;
  for (int i = 0; i < kTries; ++i) {
    fs::create_symlink(task, claim, code);
    if (!code) return task;
    if (code != std::errc::file_exists) break;
    const fs::path owner = fs::read_symlink(claim, code);
    if (!code) return owner.string();
  }
  return Error{Errc::io, "cannot be claimed (" + code.message() + ")", claim.string()};
}

void Claims::release(const std::string& key, const std::string& task) const {
  const fs::path claim = fs::path(folder_) / "claims" / key;
  std::error_code code;
  if (fs::read_symlink(claim, code) == task) fs::remove(claim, code);
}

std::string Claims::work_of(const std::string& task) const { return folder_ + "/work/" + task; }

void Claims::clear(const std::set<std::string>& tasks) const {
  std::error_code code;
  for (const fs::path& claim : entries_of(folder_ + "/claims")) {
    const std::string owner = fs::read_symlink(claim, code).string();
    if (!code && tasks.count(owner) == 0) fs::remove(claim, code);
  }
  for (const fs::path& work : entries_of(folder_ + "/work")) {
    if (tasks.count(work.filename().string()) == 0) fs::remove_all(work, code);
  }
}

}  // namespace weft::cluster
