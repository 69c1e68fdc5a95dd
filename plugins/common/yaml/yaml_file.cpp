// SPDX-License-Identifier: Apache-2.0
#include "common/yaml/yaml_file.hpp"

#include <weft/core/text_file.hpp>

namespace weft::yaml_files {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;

/// "path:line:column: "; both are counted from 0.
std::string place_of(const std::string& path, int line, int column) {
  return path + ":" + std::to_string(line + 1) + ":" + std::to_string(column + 1) + ": ";
}

}  // namespace

void fail_at(const std::string& path, const YAML::Node& node, const std::string& message) {
  const YAML::Mark mark = node.Mark();
  // The value of an empty text has no place of its own.
  throw FileMistake(mark.is_null() ? path + ":1:1: " + message
                                   : place_of(path, mark.line, mark.column) + message);
}

Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter) {
  auto text = weft::read_text_file(path, kMostBytes);
  if (text) return text;
  return Error{text.error().code, path + ": cannot be read: " + text.error().message +
                                      ": correct '" + parameter + "' or its file"};
}

Error syntax_error(const std::string& path, const YAML::Mark& mark) {
  const std::string place = mark.is_null() ? path + ": " : place_of(path, mark.line, mark.column);
  return {Errc::syntax,
          place +
              "cannot be understood from here on: look for a bracket or quote that is not "
              "closed, a missing colon or comma, and wrong indentation",
          {}};
}

Result<void> check_characters(const std::string& path, const std::string& text) {
  int line = 0, column = 0;
  for (const char byte : text) {
    const auto value = static_cast<unsigned char>(byte);
    const bool blank = byte == '\n' || byte == '\t' || byte == '\r';
    if ((value < 0x20 && !blank) || value == 0x7F) {
      return Error{Errc::syntax, place_of(path, line, column) +
                                     "a control character: remove it, or save the file anew"};
    }
    if ((value & 0xC0U) != 0x80U) ++column;  // not the later bytes of a character
    if (byte == '\n') {
      ++line;
      column = 0;
    }
  }
  return {};
}

}  // namespace weft::yaml_files
