// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <weft/core/utf8.hpp>

namespace weft::conformance {

/// True if all of a text can be decoded.
inline bool is_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = utf8::decode(text, at).bytes;
    if (bytes == 0) return false;
    at += bytes;
  }
  return true;
}

}  // namespace weft::conformance
