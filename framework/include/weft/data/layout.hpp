// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <weft/core/index.hpp>

namespace weft {

/// A number of IEEE 754 binary16. Components can pass on arrays of it and convert its elements.
struct Float16 {
  std::uint16_t bits = 0;

  explicit operator double() const {
    const int exponent = bits >> 10U & 0x1F, fraction = bits & 0x3FF;
    const double sign = (bits & 0x8000U) != 0 ? -1.0 : 1.0;
    if (exponent == 0) return sign * std::ldexp(fraction, -24);
    if (exponent < 0x1F) return sign * std::ldexp(0x400 + fraction, exponent - 25);
    return fraction == 0 ? sign * std::numeric_limits<double>::infinity()
                         : std::numeric_limits<double>::quiet_NaN();
  }
};

template <class T>
constexpr std::int32_t dtype_of() {
  if constexpr (std::is_same_v<T, std::uint8_t>) return WEFT_U8;
  if constexpr (std::is_same_v<T, std::int8_t>) return WEFT_I8;
  if constexpr (std::is_same_v<T, std::uint16_t>) return WEFT_U16;
  if constexpr (std::is_same_v<T, std::int16_t>) return WEFT_I16;
  if constexpr (std::is_same_v<T, std::int32_t>) return WEFT_I32;
  if constexpr (std::is_same_v<T, std::int64_t>) return WEFT_I64;
  if constexpr (std::is_same_v<T, float>) return WEFT_F32;
  if constexpr (std::is_same_v<T, double>) return WEFT_F64;
  if constexpr (std::is_same_v<T, Float16>) return WEFT_F16;
  if constexpr (std::is_same_v<T, std::uint32_t>) return WEFT_U32;
  if constexpr (std::is_same_v<T, std::uint64_t>) return WEFT_U64;
}

/// A type of elements: its name in manifests, its size and its descriptor in NumPy files.
struct ElementType {
  const char* name;
  std::int64_t bytes;
  const char* npy;
};

/// The types of elements by weft_dtype. The first entry stands for all unknown ones.
inline constexpr std::array<ElementType, 12> kElementTypes{{{"unknown", 0, ""},
                                                            {"u8", 1, "|u1"},
                                                            {"i8", 1, "|i1"},
                                                            {"u16", 2, "<u2"},
                                                            {"i16", 2, "<i2"},
                                                            {"i32", 4, "<i4"},
                                                            {"i64", 8, "<i8"},
                                                            {"f32", 4, "<f4"},
                                                            {"f64", 8, "<f8"},
                                                            {"f16", 2, "<f2"},
                                                            {"u32", 4, "<u4"},
                                                            {"u64", 8, "<u8"}}};

constexpr const ElementType& element_type(std::int32_t dtype) {
  const bool known = dtype >= 1 && dtype < static_cast<std::int32_t>(kElementTypes.size());
  return kElementTypes[known ? to_index(dtype) : 0];
}

/// Bytes per element; 0 for an unknown dtype.
constexpr std::int64_t dtype_size(std::int32_t dtype) { return element_type(dtype).bytes; }

constexpr const char* dtype_name(std::int32_t dtype) { return element_type(dtype).name; }

/// Compares shapes of arrays with the patterns of the catalogue. "" is a scalar, a number is a
/// length, a letter is one length per record, "*" is any length. A last "?" is an optional axis of
/// length three (colour).
class ShapePattern {
 public:
  /// Returns an empty text if the shape matches, else a description of the error.
  std::string match(std::string_view pattern, const weft_array& array) {
    const std::string_view whole = pattern;
    int axis = 0;
    bool optional_axis = false;
    while (!pattern.empty()) {
      const std::size_t comma = pattern.find(',');
      const std::string_view symbol = pattern.substr(0, comma);
      pattern = comma == std::string_view::npos ? std::string_view{} : pattern.substr(comma + 1);
      if (symbol == "?") {
        optional_axis = true;
        continue;
      }
      if (axis < array.ndim && array.shape[axis] < 0) return "has a negative length";
      if (axis < array.ndim && !fits(symbol, array.shape[axis])) {
        return "has length " + std::to_string(array.shape[axis]) + " on axis " +
               std::to_string(axis) + " where " + expected(symbol) + " is expected";
      }
      ++axis;
    }
    const bool colour = optional_axis && array.ndim == axis + 1 && array.shape[axis] == 3;
    if (array.ndim != axis && !colour) {
      return "has " + std::to_string(array.ndim) + (array.ndim == 1 ? " axis" : " axes") +
             " where " + (whole.empty() ? "a scalar" : "[" + std::string(whole) + "]") +
             " is expected";
    }
    return check_layout(array);
  }

  /// Returns an empty text if the array can be read in place, else a description of the error.
  static std::string check_layout(const weft_array& array) {
    if (array.ndim < 0 || array.ndim > WEFT_MAX_DIMENSIONS) return "has too many axes";
    const std::int64_t element = dtype_size(array.dtype);
    if (element == 0) return "has elements of an unknown type";
    if (array.memory == WEFT_DEVICE) return array.handle != 0 ? "" : "has no handle";
    if (array.data == nullptr) return "has no data";
    std::int64_t stride = element;
    for (int axis = array.ndim - 1; axis >= 0; --axis) {
      const bool may_be_padded = axis == 0 && array.ndim > 1;
      if (array.stride[axis] != stride && !(may_be_padded && array.stride[axis] % element == 0)) {
        return "is not laid out in C order";
      }
      stride *= array.shape[axis];
    }
    return {};
  }

 private:
  bool fits(std::string_view symbol, std::int64_t length) {
    const char first = symbol.front();
    if (first == '*') return true;
    if (first >= '0' && first <= '9') return std::to_string(length) == symbol;
    std::int64_t& known = lengths_[index_of(first)];
    if (known < 0) known = length;
    return known == length;
  }

  /// Returns "2", or "N = 5" once the value of N is known for the record.
  std::string expected(std::string_view symbol) const {
    const std::int64_t known = lengths_[index_of(symbol.front())];
    const bool letter = symbol.front() < '0' || symbol.front() > '9';
    return std::string(symbol) + (letter ? " = " + std::to_string(known) : "");
  }

  static std::size_t index_of(char letter) {
    return static_cast<unsigned char>(letter - 'A') % kLetters;
  }

  static constexpr std::size_t kLetters = 26;
  std::array<std::int64_t, kLetters> lengths_ = [] {
    std::array<std::int64_t, kLetters> unknown{};
    unknown.fill(-1);
    return unknown;
  }();
};

}  // namespace weft
