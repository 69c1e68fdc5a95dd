// SPDX-License-Identifier: Apache-2.0
#include "common/yaml_file.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace weft::sources {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;

}  // namespace

void fail_at(const std::string& path, const YAML::Node& node, const std::string& message) {
  const YAML::Mark mark = node.Mark();
  std::string place = path;
  if (!mark.is_null()) {
    place += ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
  }
  throw FileMistake(place + ": " + message);
}

Result<std::string> read_text_file(const std::string& path, const std::string& parameter) {
  std::error_code status;
  if (!std::filesystem::is_regular_file(path, status)) {
    return Error{
        Errc::not_found, path + ": there is no such file: correct '" + parameter + "'", {}};
  }
  if (std::filesystem::file_size(path, status) > kMostBytes) {
    return Error{Errc::invalid_data, path + ": is too large for '" + parameter + "'", {}};
  }
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (!stream) return Error{Errc::io, path + ": cannot be read: check its permissions", {}};
  return text;
}

}  // namespace weft::sources
