// SPDX-License-Identifier: Apache-2.0
#include "yaml/text.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>
#include <weft/core/quote.hpp>

namespace weft::yaml::detail {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kBlanks = " \t\r\n";

// yaml-cpp reads ahead to the end of an open bracket, so brackets are counted before it sees them.
// The count ignores quotes and comments; only the exact limit of depth is meant to be met in life.
constexpr std::size_t kMaxOpenBrackets = 10'000;

bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0u) == 0x80u; }

std::string bad_character(char32_t value) {
  char name[16];
  std::snprintf(name, sizeof name, "U+%04X", static_cast<unsigned>(value));
  return std::string("the character ") + name +
         " is not allowed; remove it, or write it as an escape in double quotes";
}

}  // namespace

bool is_printable(char32_t value) {
  if (value < 0x20) return value == '\t' || value == '\n' || value == '\r';
  if (value >= 0x7F && value < 0xA0) return value == 0x85;
  return value != 0xFEFF && value != 0xFFFE && value != 0xFFFF;
}

Text::Text(std::string_view bytes) : bytes_(bytes) {
  if (bytes_.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    bytes_.remove_prefix(kByteOrderMark.size());
  }
  line_starts_.push_back(0);
  for (std::size_t i = 0; i < bytes_.size(); ++i) {
    if (bytes_[i] == '\n') line_starts_.push_back(i + 1);
  }
  end_ = bytes_.find_last_not_of(kBlanks) + 1;  // npos + 1 is 0
}

std::size_t Text::line_start(std::size_t offset) const {
  return *(std::upper_bound(line_starts_.begin(), line_starts_.end(), offset) - 1);
}

Position Text::position(std::size_t offset) const {
  offset = std::min(offset, end_);
  const auto next = std::upper_bound(line_starts_.begin(), line_starts_.end(), offset);
  const int line = static_cast<int>(next - line_starts_.begin());
  Position result{line, 1};
  std::size_t from = *(next - 1);
  if (known_.line == line && known_offset_ <= offset && known_offset_ >= from) {
    result = known_;  // long lines are walked once
    from = known_offset_;
  }
  for (std::size_t i = from; i < offset; ++i) {
    if (!is_continuation(bytes_[i])) ++result.column;
  }
  known_offset_ = offset;
  known_ = result;
  return result;
}

bool Text::has_start_mark(std::size_t offset) const {
  return line_start(offset) == offset && starts_at(offset, "---") &&
         (offset + 3 == bytes_.size() || kBlanks.find(at(offset + 3)) != std::string_view::npos);
}

bool Text::is_indented_by_tab(std::size_t offset) const {
  offset = std::min(offset, bytes_.size());
  bool tab = false;
  for (; offset > 0 && bytes_[offset - 1] != '\n'; --offset) {
    if (bytes_[offset - 1] != ' ' && bytes_[offset - 1] != '\t') return false;
    tab = tab || bytes_[offset - 1] == '\t';
  }
  return tab;
}

std::optional<Fault> Text::check() const {
  if (bytes_.size() > kMaxBytes) {
    return Fault{0, "the text has more than " + std::to_string(kMaxBytes >> 20u) + " MiB"};
  }
  if (auto fault = check_characters()) return fault;
  return check_percent_lines();
}

std::optional<Fault> Text::check_characters() const {
  const std::string_view start = bytes_.substr(0, 2);
  if (start == "\xFE\xFF" || start == "\xFF\xFE") {
    return Fault{0, "the text is UTF-16; save it as UTF-8"};
  }
  std::size_t open = 0;
  for (std::size_t i = 0; i < bytes_.size();) {
    const CodePoint point = decode(bytes_, i);
    if (point.bytes == 0) return Fault{i, "invalid UTF-8; save the text as UTF-8"};
    if (!is_printable(point.value)) return Fault{i, bad_character(point.value)};
    if (point.value == '\r' && at(i + 1) != '\n') {
      return Fault{i, "a carriage return without a line feed; end lines with a line feed"};
    }
    if (point.value == '[' || point.value == '{') ++open;
    if ((point.value == ']' || point.value == '}') && open > 0) --open;
    if (open > kMaxOpenBrackets) return Fault{i, "too many open brackets"};
    i += point.bytes;
  }
  return std::nullopt;
}

std::size_t Text::header_end() const {
  std::size_t start = 0;
  while (true) {
    const std::size_t first = bytes_.find_first_not_of(kBlanks, start);
    if (first == std::string_view::npos) return bytes_.size();
    const std::size_t line = line_start(first);
    if (bytes_[first] != '#' && bytes_[line] != '%') return line;
    start = std::min(bytes_.find('\n', first), bytes_.size());
  }
}

std::optional<Fault> Text::check_percent_lines() const {
  // yaml-cpp takes such a line for a directive and drops it without a word.
  const std::size_t header = header_end();
  for (const std::size_t start : line_starts_) {
    if (start >= header && at(start) == '%') {
      return Fault{start, "a line cannot start with '%' here; indent or quote it"};
    }
  }
  return std::nullopt;
}

std::vector<Problem> Text::directive_problems() const {
  std::vector<Problem> problems;
  const std::size_t header = header_end();
  bool found = false;
  for (const std::size_t start : line_starts_) {
    if (start >= header || at(start) != '%') continue;
    found = true;
    std::string_view line = bytes_.substr(start, bytes_.find('\n', start) - start);
    line = line.substr(0, line.find(" #"));
    line = line.substr(0, line.find_last_not_of(kBlanks) + 1);
    if (line == "%YAML 1.2") continue;
    problems.push_back(
        {position(start), "directive " + quote(line) + " is not supported; only '%YAML 1.2' is"});
  }
  if (found && !has_start_mark(header)) {
    problems.push_back({position(header), "expected '---' between the directives and the value"});
  }
  return problems;
}

}  // namespace weft::yaml::detail
