// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <sstream>
#include <string>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>

namespace weft {

/// Header of a NumPy array file.
struct NpyHeader {
  std::int32_t dtype = 0;           ///< weft_dtype of the elements
  std::vector<std::int64_t> shape;  ///< [ndim] length of each axis
  std::size_t data_offset = 0;      ///< offset of the elements, in bytes
};

namespace detail {

inline std::string npy_header(const weft_array& array) {
  std::string shape = "(";
  for (int axis = 0; axis < array.ndim; ++axis) {
    shape += std::to_string(array.shape[axis]) + (axis + 1 < array.ndim ? ", " : "");
  }
  shape += array.ndim == 1 ? ",)" : ")";
  std::string header = std::string("{'descr': '") + element_type(array.dtype).npy +
                       "', 'fortran_order': False, 'shape': " + shape + ", }";
  constexpr std::size_t kPreamble = 10;
  while ((kPreamble + header.size() + 1) % 64 != 0) header += ' ';
  header += '\n';
  std::string result("\x93NUMPY\x01\x00", 8);
  result += static_cast<char>(header.size() & 0xFFU);
  result += static_cast<char>(header.size() >> 8U);
  return result + header;
}

}  // namespace detail

/// Encodes an array in NumPy's format. Rows may be padded in memory; the file has no padding.
inline std::string to_npy(const weft_array& array) {
  std::string bytes = detail::npy_header(array);
  std::int64_t row_bytes = dtype_size(array.dtype);
  for (int axis = 1; axis < array.ndim; ++axis) row_bytes *= array.shape[axis];
  const std::int64_t rows = array.ndim > 0 ? array.shape[0] : 1;
  for (std::int64_t i = 0; i < rows; ++i) {
    const std::int64_t offset = array.ndim > 0 ? i * array.stride[0] : 0;
    bytes.append(static_cast<const char*>(array.data) + offset, to_index(row_bytes));
  }
  return bytes;
}

/// Parses a NumPy file. Fails unless it contains one complete array with a type and size that a
/// record may have.
inline Result<NpyHeader> parse_npy(const std::string& bytes) {
  const Error damaged{Errc::invalid_data, "is no array in NumPy's format 1.0", {}};
  if (bytes.size() < 10 || bytes.compare(0, 7, "\x93NUMPY\x01", 7) != 0) return damaged;
  const auto byte = [&](std::size_t i) { return to_index(static_cast<unsigned char>(bytes[i])); };
  NpyHeader header;
  header.data_offset = 10 + byte(8) + 256 * byte(9);
  // NumPy aligns the elements and readers rely on it.
  if (header.data_offset > bytes.size() || header.data_offset % 8 != 0) return damaged;
  const std::string text = bytes.substr(10, header.data_offset - 10);
  if (text.find("'fortran_order': False") == std::string::npos) return damaged;
  for (std::size_t i = 1; i < kElementTypes.size(); ++i) {
    if (text.find("'" + std::string(kElementTypes[i].npy) + "'") != std::string::npos) {
      header.dtype = static_cast<std::int32_t>(i);
    }
  }
  const std::size_t open = text.find('('), close = text.find(')');
  if (header.dtype == 0 || open == std::string::npos || close == std::string::npos) return damaged;
  std::istringstream list(text.substr(open + 1, close - open - 1));
  std::uint64_t expected = static_cast<std::uint64_t>(dtype_size(header.dtype));
  std::uint64_t extent = expected;  // with 1 for 0, to prevent overflow of the strides
  for (std::string word; std::getline(list, word, ',');) {
    if (word.find_first_of("0123456789") == std::string::npos) continue;
    std::int64_t length = 0;
    if (!(std::istringstream(word) >> length) || length < 0) return damaged;
    header.shape.push_back(length);
    if (length > 0 && expected > bytes.size() / static_cast<std::uint64_t>(length)) return damaged;
    expected *= static_cast<std::uint64_t>(length);
    constexpr std::uint64_t kMostExtent = 1ULL << 40U;
    if (static_cast<std::uint64_t>(length) > kMostExtent / extent) return damaged;
    extent *= static_cast<std::uint64_t>(std::max<std::int64_t>(length, 1));
  }
  if (header.shape.size() > WEFT_MAX_DIMENSIONS) return damaged;
  if (expected != bytes.size() - header.data_offset) return damaged;
  return header;
}

}  // namespace weft
