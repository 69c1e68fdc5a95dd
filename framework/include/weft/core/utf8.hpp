// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

namespace weft::utf8 {

/// A Unicode code point and its number of bytes; 0 bytes if `text` is not valid UTF-8 at this
/// position.
struct CodePoint {
  char32_t value = 0;
  std::size_t bytes = 0;  ///< length of the encoding, 0 to 4
};

/// Decodes the character that begins at `offset` < text.size(). Rejects overlong forms, surrogates
/// and values above U+10FFFF.
inline CodePoint decode(std::string_view text, std::size_t offset) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(offset);
  if (first < 0x80) return {first, 1};
  const std::size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() - offset < bytes) return {};
  char32_t value = first & (0xFFU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(offset + i) & 0xC0U) != 0x80U) return {};
    value = (value << 6U) | (byte(offset + i) & 0x3FU);
  }
  constexpr char32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  if (value < kLeast[bytes] || value > 0x10FFFF || (value >= 0xD800 && value < 0xE000)) return {};
  return {value, bytes};
}

}  // namespace weft::utf8
