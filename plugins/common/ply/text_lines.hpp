// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::ply {

/// Reads a text line by line, ended by LF or CR LF.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : text_(text) {}

  /// The next line without its end; nothing behind the last one.
  std::optional<std::string_view> next() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++number_;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  /// Number of the last line that was returned, from 1.
  std::int64_t number() const { return number_; }
  /// The text behind that line.
  std::string_view rest() const { return text_.substr(std::min(at_, text_.size())); }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  std::int64_t number_ = 0;
};

inline std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kSpace = " \t\v\f";
  std::vector<std::string_view> words;
  for (std::size_t begin = line.find_first_not_of(kSpace); begin != line.npos;) {
    const std::size_t end = std::min(line.find_first_of(kSpace, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    begin = line.find_first_not_of(kSpace, end);
  }
  return words;
}

/// A number in decimal notation whatever the locale; nothing unless the whole word is one.
template <class Number>
std::optional<Number> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number value{};
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (code != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

/// "path:line: sentence"
inline Error mistake_at(const std::string& path, std::int64_t line, const std::string& sentence) {
  return {Errc::invalid_data, path + ":" + std::to_string(line) + ": " + sentence, {}};
}

}  // namespace weft::ply
