// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <weft/data/array.hpp>

namespace weft::inference {

/// XXH3-64 of bytes, as 16 hexadecimal digits in lower case.
std::string hash_of(std::string_view bytes);

/// XXH3-64 of a texture's bytes, [H,W] grey or [H,W,3] BGR, row by row.
std::string texture_hash(const Array<std::uint8_t>& texture);

/// Returns whether a text is such a hash.
bool is_hash(std::string_view text);

}  // namespace weft::inference
