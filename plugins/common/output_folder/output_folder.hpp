// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <system_error>
#include <weft/core/result.hpp>
#include <weft/core/whole_file.hpp>

/// The folder of a sink that writes a file for each frame. Messages name its parameter 'path'.
namespace weft::output_folder {

inline Result<void> make(const std::string& path) {
  std::error_code status;
  std::filesystem::create_directories(path, status);
  if (!status) return {};
  return Error{Errc::io, "the folder " + path + " cannot be made (" + status.message() +
                             "): choose another 'path'"};
}

/// Waits until what was written into it is on disk.
inline Result<void> sync(const std::string& path) {
  const std::error_code code = sync_file_system(path);
  if (!code) return {};
  return Error{Errc::io, "the folder " + path + " cannot be written to disk (" +
                             why_not_written(code) + "): free space, or choose another 'path'"};
}

/// PATH/000040.png
inline std::filesystem::path file_of(const std::string& path, std::uint64_t frame,
                                     const char* extension) {
  char name[40];
  std::snprintf(name, sizeof name, "%06llu.%s", static_cast<unsigned long long>(frame), extension);
  return std::filesystem::path(path) / name;
}

}  // namespace weft::output_folder
