// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <string>
#include <utility>
#include <weft/core/result.hpp>

namespace weft::cli {

/// A folder in TMPDIR, for this user only, that is removed with its content.
class ScratchFolder {
 public:
  static Result<ScratchFolder> make(const std::string& name) {
    std::error_code code;
    std::string pattern =
        (std::filesystem::temp_directory_path(code) / (name + "-XXXXXX")).string();
    if (code || mkdtemp(pattern.data()) == nullptr) {
      return Error{Errc::io, "no temporary folder can be made there; set TMPDIR", pattern};
    }
    return ScratchFolder(std::move(pattern));
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;

  const std::string& path() const { return path_; }

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
};

}  // namespace weft::cli
