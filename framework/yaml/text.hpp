// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/utf8.hpp>

#include "yaml/yaml.hpp"

namespace weft::yaml::detail {

using utf8::CodePoint;
using utf8::decode;

/// True if YAML allows the character unescaped in a text; false for a byte order mark.
bool is_printable(char32_t value);

/// Why a text cannot be parsed, and the byte where.
struct Fault {
  std::size_t offset = 0;  ///< [bytes] from the beginning of the text
  std::string message;
};

/// The bytes of a document with a map from byte offsets to positions.
class Text {
 public:
  /// `bytes` must outlive this; a byte order mark at the start is dropped.
  explicit Text(std::string_view bytes);

  std::string_view bytes() const { return bytes_; }

  /// The byte at `offset`, or 0 behind the end.
  char at(std::size_t offset) const { return offset < bytes_.size() ? bytes_[offset] : '\0'; }

  bool starts_at(std::size_t offset, std::string_view what) const {
    return offset <= bytes_.size() && bytes_.substr(offset, what.size()) == what;
  }

  /// True if a line with `---` begins at `offset`.
  bool has_start_mark(std::size_t offset) const;

  /// Behind the last character that is not blank for offsets behind that.
  Position position(std::size_t offset) const;

  /// The first byte of the line of `offset`.
  std::size_t line_start(std::size_t offset) const;

  /// True if `offset` is preceded in its line only by blanks, one of them a tab.
  bool is_indented_by_tab(std::size_t offset) const;

  /// Finds text that the parser would misread or process too slowly.
  std::optional<Fault> check() const;

  /// Directives other than `%YAML 1.2`, or without the `---` behind them.
  std::vector<Problem> directive_problems() const;

 private:
  std::optional<Fault> check_characters() const;
  std::optional<Fault> check_percent_lines() const;
  std::size_t header_end() const;

  std::string_view bytes_;
  std::vector<std::size_t> line_starts_;
  std::size_t end_ = 0;  ///< behind the last character that is not blank
  mutable std::size_t known_offset_ = 0;
  mutable Position known_;
};

}  // namespace weft::yaml::detail
