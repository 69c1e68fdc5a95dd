// SPDX-License-Identifier: Apache-2.0
#include "cli/output/new_file.hpp"

#include <filesystem>
#include <weft/core/output_folder.hpp>

namespace weft::cli {

namespace fs = std::filesystem;

void add_overwrite(CLI::App& command, bool& overwrite) {
  command.add_flag("--overwrite", overwrite, "Replace a file that is there already");
}

Result<void> check_new_file(const std::string& file, bool overwrite) {
  std::error_code code;
  const bool is_there = fs::exists(fs::symlink_status(file, code));
  const bool replaceable = fs::is_regular_file(file, code) || fs::is_symlink(file, code);
  if (!is_there || is_device(file)) return {};
  if (overwrite && replaceable) return {};
  return Error{Errc::io,
               replaceable ? "is there already; choose another name, or give --overwrite"
                           : "is a folder; give the name of a file",
               file};
}

Result<void> make_new_folder(const std::string& folder) {
  if (!is_free_for_folder(folder)) {
    return Error{Errc::io, "exists and is not an empty folder; choose another with --out", folder};
  }
  const std::error_code code = make_folders(folder);
  if (code) return Error{Errc::io, "cannot be created: " + code.message(), folder};
  return {};
}

}  // namespace weft::cli
