// SPDX-License-Identifier: Apache-2.0
#include "common/yaml/yaml_file.hpp"

#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/text_file.hpp>
#include <weft/core/utf8.hpp>

namespace weft::yaml_files {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;

/// "path:line:column: "; both are counted from 0.
std::string place_of(const std::string& path, int line, int column) {
  return path + ":" + std::to_string(line + 1) + ":" + std::to_string(column + 1) + ": ";
}

/// The same of a place of yaml-cpp, which counts bytes.
std::string place_of(const std::string& path, const std::string& text, const YAML::Mark& mark) {
  std::string_view line = text;
  if (line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
  for (int i = 0; i < mark.line && line.find('\n') != line.npos; ++i) {
    line.remove_prefix(line.find('\n') + 1);
  }
  line = line.substr(0, to_index(mark.column));
  const auto later = std::count_if(line.begin(), line.end(), [](char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
  });
  return place_of(path, mark.line, mark.column - static_cast<int>(later));
}

/// Behind its first document yaml-cpp begins another one wherever it stopped, and for ever at what
/// begins none, such as a bracket that closes nothing.
class OneDocument final : public YAML::EventHandler {
 public:
  explicit OneDocument(std::string_view text) : text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF")) text_.remove_prefix(3);
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (!std::exchange(started_, true)) return;
    const std::size_t offset = std::min(to_index(mark.pos), text_.size());
    std::string_view before = text_.substr(0, offset);
    before = before.substr(0, before.find_last_not_of(" \t\r\n") + 1);  // npos + 1 is 0
    if (text_.substr(offset).starts_with("---") || before.ends_with("\n...")) {
      throw FileMistake(mark, "more than one document: put it into a separate file");
    }
    throw YAML::ParserException(mark, "belongs to no document");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}

 private:
  std::string_view text_;
  bool started_ = false;
};

}  // namespace

void require_one_document(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  OneDocument document(text);
  while (parser.HandleNextDocument(document)) {
  }
}

void fail_at(const YAML::Node& node, const std::string& message) {
  throw FileMistake(node.Mark(), message);
}

Error error_of(const std::string& path, const std::string& text, const FileMistake& mistake) {
  // The value of an empty text has no place.
  const std::string place =
      mistake.mark.is_null() ? path + ":1:1: " : place_of(path, text, mistake.mark);
  return {Errc::invalid_data, place + mistake.what(), {}};
}

Result<std::string> read_yaml_text(const std::string& path, const std::string& parameter) {
  auto text = weft::read_text_file(path, kMostBytes);
  if (text) return text;
  return Error{text.error().code, path + ": cannot be read: " + text.error().message +
                                      ": correct '" + parameter + "' or its file"};
}

Error syntax_error(const std::string& path, const std::string& text, const YAML::Mark& mark) {
  const std::string place = mark.is_null() ? path + ": " : place_of(path, text, mark);
  return {Errc::syntax,
          place +
              "cannot be understood from here on: look for a bracket or quote that is not "
              "closed, a missing colon or comma, and wrong indentation",
          {}};
}

std::optional<Error> slip_in(const std::string& path, const std::string& text, const Error& error) {
  const auto has = [&](const std::string& part) {
    return error.message.find(part) != std::string::npos;
  };
  const bool is_syntax = error.code == Errc::syntax;
  const bool lacks_keys = is_syntax || has("must hold keys") || has("has no '");
  std::istringstream lines(text.starts_with("\xEF\xBB\xBF") ? text.substr(3) : text);
  int number = 0;
  for (std::string line; std::getline(lines, line); ++number) {
    const std::string place = path + ":" + std::to_string(number + 1) + ":";
    const std::size_t first = std::min(line.find_first_not_of(" \t"), line.size());
    const std::size_t tab = line.find('\t');
    if (is_syntax && tab < first && error.message.starts_with(place)) {
      return Error{Errc::syntax, place_of(path, number, static_cast<int>(tab)) +
                                     "a tab indents this line: indent by blanks"};
    }
    const std::size_t start = std::min(line.find_first_not_of(" \t-{,"), line.size());
    const std::size_t colon = line.find(':', start);
    if (colon == line.npos || colon + 1 >= line.size()) continue;
    const std::string key = line.substr(start, colon - start);
    const bool is_key = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
             c == '_' || c == '.';
    });
    const char next = line[colon + 1];
    if (!is_key || std::string_view(" \t\r/\\:").find(next) != std::string_view::npos) continue;
    if (!lacks_keys && !has("'" + key + ":")) continue;
    return Error{Errc::syntax, place_of(path, number, static_cast<int>(colon) + 1) +
                                   "a blank is missing after the colon: write '" + key + ": ...'"};
  }
  return std::nullopt;
}

Result<void> check_characters(const std::string& path, const std::string& text) {
  const bool zeros = text.size() > 1 && (text[0] == '\0') != (text[1] == '\0');
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || zeros) {
    return Error{Errc::syntax,
                 place_of(path, 0, 0) + "UTF-16 or no text: save the file as text in UTF-8"};
  }
  int line = 0, column = 0;
  for (std::size_t i = 0; i < text.size(); ++column) {
    const utf8::CodePoint point = utf8::decode(text, i);
    const bool blank = text[i] == '\n' || text[i] == '\t' || text[i] == '\r';
    if (point.bytes == 0 || (point.value < 0x20 && !blank) || point.value == 0x7F) {
      return Error{
          Errc::syntax,
          place_of(path, line, column) +
              (point.bytes == 0 ? "no UTF-8: save the file as UTF-8"
                                : "a control character: remove it, or save the file anew")};
    }
    if (text[i] == '\n') {
      ++line;
      column = -1;
    }
    i += point.bytes;
  }
  return {};
}

}  // namespace weft::yaml_files
