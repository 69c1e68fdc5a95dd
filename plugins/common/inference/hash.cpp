// SPDX-License-Identifier: Apache-2.0
#include "common/inference/hash.hpp"

#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <weft/core/index.hpp>

namespace weft::inference {
namespace {

std::string hexadecimal(std::uint64_t value) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  for (std::size_t i = 16; i-- > 0; value >>= 4U) text[i] = kDigits[value & 15U];
  return text;
}

}  // namespace

std::string hash_of(std::string_view bytes) {
  return hexadecimal(XXH3_64bits(bytes.data(), bytes.size()));
}

std::string texture_hash(const Array<std::uint8_t>& texture) {
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       &XXH3_freeState);
  XXH3_64bits_reset(state.get());
  for (std::int64_t row = 0; row < texture.rows(); ++row) {
    XXH3_64bits_update(state.get(), texture.row(row), to_index(texture.row_elements()));
  }
  return hexadecimal(XXH3_64bits_digest(state.get()));
}

bool is_hash(std::string_view text) {
  return text.size() == 16 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
         });
}

}  // namespace weft::inference
