// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <span>
#include <string>
#include <vector>
#include <weft/core/base64.hpp>

namespace weft::lab {

/// Base64 of numbers as they lie in memory, little-endian.
template <class T>
std::string base64_of(std::span<const T> numbers) {
  static_assert(std::endian::native == std::endian::little);
  return base64({reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()});
}

inline std::string packed(const std::vector<float>& values) {
  return base64_of(std::span<const float>(values));
}

}  // namespace weft::lab
