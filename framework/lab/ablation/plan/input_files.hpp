// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::lab {

/// The content of files that pipelines read. Each path is hashed once; later checks compare the
/// files with their earlier state.
class InputFiles {
 public:
  /// XXH128 of what `path` names, see host::hash_of_files.
  const Result<std::string>& hash_of(const std::string& path);

  /// The first of the paths whose files are not what hash_of() read, empty when there is none.
  /// Files whose size, time and number are the same are not read again.
  std::string changed(const std::vector<std::string>& paths) const;

 private:
  /// File attributes that show a change without reading the file.
  struct File {
    std::string path;
    std::uint64_t device = 0, number = 0, bytes = 0;  ///< device and inode; [bytes] size
    std::int64_t changed_ns = 0;                      ///< [ns] of its content

    bool operator==(const File&) const = default;
  };
  struct Known {
    std::vector<File> files;  ///< as they were before they were hashed
    Result<std::string> hash;
  };
  static std::vector<File> look_at(const std::string& path);

  std::map<std::string, Known> known_;  ///< by path
};

}  // namespace weft::lab
