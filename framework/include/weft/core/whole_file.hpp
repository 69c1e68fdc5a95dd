// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <system_error>
#include <weft/core/result.hpp>

namespace weft {

/// Why a file could not be written, in words.
inline std::string why_not_written(std::error_code code) {
  if (code == std::errc::file_too_large) return "it is beyond the file size limit, see ulimit -f";
  return code.message();
}

/// Whether what is written there goes elsewhere: a terminal, a pipe, /dev/stdout, which may lead to
/// a file that is open already.
inline bool is_device(const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  const std::string name = file.lexically_normal().string();
  if (name == "/dev/stdout" || name == "/dev/stderr") return true;
  if (name.starts_with("/dev/fd/") || name.starts_with("/proc/")) return true;
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

/// Writes a file that appears whole or not at all: it is renamed from `file`.part. A device is
/// written directly.
inline Result<void> write_whole(std::string_view bytes, const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code code;
  const bool replaceable = !is_device(file);
  fs::path target = file;
  if (replaceable) target += ".part";
  errno = 0;
  std::ofstream stream(target, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  code = stream ? std::error_code() : std::error_code(errno, std::generic_category());
  if (stream && replaceable) fs::rename(target, file, code);
  if (stream && !code) return {};
  const std::string reason = code ? " (" + why_not_written(code) + ")" : "";
  if (replaceable) fs::remove(target, code);
  return Error{Errc::io,
               "cannot be written" + reason + "; is its folder writable and the disk not full?",
               file.string()};
}

}  // namespace weft
