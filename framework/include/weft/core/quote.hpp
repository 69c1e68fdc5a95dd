// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <weft/core/utf8.hpp>

namespace weft {
namespace detail {

/// Returns whether a character could move, hide or colour the text around it. These are control
/// characters, line separators, direction marks and overrides, and characters without width.
inline bool disturbs(char32_t value) {
  struct Span {
    char32_t first, last;
  };
  constexpr Span kSpans[] = {{0x00, 0x1F},     {0x7F, 0x9F},     {0xAD, 0xAD},
                             {0x61C, 0x61C},   {0x200B, 0x200F}, {0x2028, 0x202E},
                             {0x2060, 0x206F}, {0xFEFF, 0xFEFF}, {0xFFF9, 0xFFFB}};
  return std::any_of(std::begin(kSpans), std::end(kSpans),
                     [&](const Span& span) { return value >= span.first && value <= span.last; });
}

inline std::string escape_of(char32_t value, bool is_byte) {
  if (!is_byte && value == '\n') return "\\n";
  if (!is_byte && value == '\r') return "\\r";
  if (!is_byte && value == '\t') return "\\t";
  char escape[16];
  std::snprintf(escape, sizeof escape, is_byte || value < 0x80 ? "\\x%02X" : "\\u%04X",
                static_cast<unsigned>(value));
  return escape;
}

}  // namespace detail

/// Escapes external text for a message. Characters that would disturb a terminal or the sentence,
/// and bytes that are not UTF-8, become escapes (\n, \x1B, \u202E). Text beyond `most` characters
/// is cut, marked by three dots.
inline std::string escaped(std::string_view text,
                           std::size_t most = std::numeric_limits<std::size_t>::max()) {
  std::string shown;
  std::size_t count = 0;
  for (std::size_t i = 0; i < text.size(); ++count) {
    if (count == most) return shown + "...";
    const utf8::CodePoint point = utf8::decode(text, i);
    const auto byte = static_cast<unsigned char>(text[i]);
    if (point.bytes == 0 || detail::disturbs(point.value)) {
      shown += detail::escape_of(point.bytes == 0 ? byte : point.value, point.bytes == 0);
    } else {
      shown += text.substr(i, point.bytes);
    }
    i += std::max<std::size_t>(point.bytes, 1);
  }
  return shown;
}

/// Escapes a text and puts it in single quotes, with at most 80 characters. Messages quote values,
/// keys and names in this form.
inline std::string quote(std::string_view text) {
  constexpr std::size_t kMostShown = 80;
  return "'" + escaped(text, kMostShown) + "'";
}

/// Replaces NUL characters by escapes, because texts of the contract end at the first NUL.
inline std::string without_nul(std::string_view text) {
  std::string shown(text);
  for (std::size_t at = shown.find('\0'); at != shown.npos; at = shown.find('\0', at)) {
    shown.replace(at, 1, detail::escape_of(0, true));
  }
  return shown;
}

}  // namespace weft
