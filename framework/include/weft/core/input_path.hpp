// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <weft/core/result.hpp>

namespace weft {

/// What a path that somebody named is to lead to.
enum class InputKind { file, folder, any };

/// Fails where there is nothing at a path, or a folder in place of a file, or the reverse: the one
/// wording of these errors. `remedy` says what to do, such as "give the folder of a run".
inline Result<void> check_input(const std::string& path, InputKind kind,
                                const std::string& remedy = "correct its name") {
  std::error_code code;
  const auto status = std::filesystem::status(path, code);
  const auto fail = [&](const std::string& what, const std::string& what_to_do) {
    return Error{Errc::not_found, what + "; " + what_to_do, path};
  };
  if (!std::filesystem::exists(status)) {
    const bool hidden =
        code && code != std::errc::no_such_file_or_directory && code != std::errc::not_a_directory;
    if (hidden) return fail("cannot be read: " + code.message(), remedy);
    return fail(kind == InputKind::file     ? "there is no such file"
                : kind == InputKind::folder ? "there is no such folder"
                                            : "there is no such file or folder",
                remedy);
  }
  const bool is_folder = std::filesystem::is_directory(status);
  if (kind == InputKind::file && is_folder) return fail("is a folder, no file", remedy);
  if (kind == InputKind::folder && !is_folder) return fail("is a file, no folder", remedy);
  return {};
}

/// The same of a file whose text could not be read: `error` is one of read_text_file.
inline std::string unreadable_text(const Error& error) {
  if (auto found = check_input(error.where, InputKind::file); !found) return found.error().message;
  return "cannot be read: " + error.message;
}

}  // namespace weft
