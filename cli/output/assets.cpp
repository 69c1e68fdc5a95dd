// SPDX-License-Identifier: Apache-2.0
#include "cli/output/assets.hpp"

#include <filesystem>

namespace weft::cli {

std::string asset(const std::string& name) {
  namespace fs = std::filesystem;
  std::error_code code;
  const fs::path program = fs::read_symlink("/proc/self/exe", code);
  return (program.parent_path().parent_path() / "share" / "weft" / name).string();
}

}  // namespace weft::cli
