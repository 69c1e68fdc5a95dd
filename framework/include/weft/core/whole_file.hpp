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

/// Writes a file that appears whole or not at all: it is renamed from `file`.part. A device, such
/// as /dev/stdout, is written directly.
inline Result<void> write_whole(std::string_view bytes, const std::filesystem::path& file) {
  namespace fs = std::filesystem;
  std::error_code code;
  const bool replaceable = !fs::exists(file, code) || fs::is_regular_file(file, code);
  fs::path target = file;
  if (replaceable) target += ".part";
  errno = 0;
  std::ofstream stream(target, std::ios::binary | std::ios::trunc);
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  code = stream ? std::error_code() : std::error_code(errno, std::generic_category());
  if (stream && replaceable) fs::rename(target, file, code);
  if (stream && !code) return {};
  const std::string reason = code ? " (" + code.message() + ")" : "";
  if (replaceable) fs::remove(target, code);
  return Error{Errc::io,
               "cannot be written" + reason + "; is its folder writable and the disk not full?",
               file.string()};
}

}  // namespace weft
