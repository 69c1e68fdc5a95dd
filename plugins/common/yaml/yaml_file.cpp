// SPDX-License-Identifier: Apache-2.0
#include "common/yaml/yaml_file.hpp"

#include <weft/core/text_file.hpp>

namespace weft::yaml_files {
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

Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter) {
  auto text = weft::read_text_file(path, kMostBytes);
  if (text) return text;
  return Error{text.error().code, path + ": cannot be read: " + text.error().message +
                                      ": correct '" + parameter + "' or its file"};
}

Error syntax_error(const std::string& path, const YAML::Mark& mark) {
  const std::string place =
      mark.is_null() ? ""
                     : ":" + std::to_string(mark.line + 1) + ":" + std::to_string(mark.column + 1);
  return {Errc::syntax,
          path + place +
              ": cannot be understood from here on: look for a bracket or quote that is not "
              "closed, a missing colon or comma, and wrong indentation",
          {}};
}

}  // namespace weft::yaml_files
