// SPDX-License-Identifier: Apache-2.0
#include "pipeline/configuration/extended_file.hpp"

#include <algorithm>
#include <filesystem>
#include <weft/core/quote.hpp>

namespace weft {

namespace fs = std::filesystem;

std::string canonical_path(const std::string& file) {
  std::error_code code;
  return fs::weakly_canonical(file, code).string();
}

Result<std::string> extended_file(const yaml::Node& extends, const std::string& folder,
                                  const std::vector<std::string>& chain,
                                  const host::PathRules& paths, const std::string& what) {
  if (extends.kind != yaml::Kind::scalar || extends.scalar.empty()) {
    return Error{Errc::invalid_value, "'extends' must be the path of " + what};
  }
  const auto expanded = host::expand_path(extends.scalar, paths);
  if (!expanded) return expanded.error();
  std::string file = (fs::path(folder) / *expanded).lexically_normal().string();
  if (const auto text = yaml::read_text(file); !text) {
    return Error{Errc::invalid_value,
                 text.error().code == Errc::not_found
                     ? "'extends': there is no file " + escaped(file)
                     : "'extends': " + escaped(file) + ": " + text.error().message};
  }
  if (std::find(chain.begin(), chain.end(), canonical_path(file)) != chain.end()) {
    return Error{Errc::invalid_value, "'extends': " + escaped(file) + " extends itself"};
  }
  return file;
}

}  // namespace weft
