// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

namespace weft::cli {

/// The folder that holds `bin` with this program: of an installation or of a build.
inline std::filesystem::path program_root() {
  std::error_code code;
  return std::filesystem::read_symlink("/proc/self/exe", code).parent_path().parent_path();
}

}  // namespace weft::cli
