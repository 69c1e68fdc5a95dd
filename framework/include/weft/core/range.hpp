// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace weft {

/// Legal range of a number, both ends included. `{}` is any number except NaN.
struct Range {
  double minimum = -std::numeric_limits<double>::infinity();  ///< unit of the parameter
  double maximum = std::numeric_limits<double>::infinity();   ///< unit of the parameter
};

namespace detail {

/// The integers of a range, both ends included.
struct IntegerRange {
  std::int64_t minimum, maximum;

  explicit IntegerRange(Range range)
      : minimum(rounded(std::ceil(range.minimum))), maximum(rounded(std::floor(range.maximum))) {}

  /// An integral number, or the nearest std::int64_t.
  static std::int64_t rounded(double number) {
    constexpr double kBeyond = 9223372036854775808.0;  // 2^63
    if (number >= kBeyond) return std::numeric_limits<std::int64_t>::max();
    if (number <= -kBeyond) return std::numeric_limits<std::int64_t>::min();
    return static_cast<std::int64_t>(number);
  }
};

inline bool is_within(Range range, double number) {
  return number >= range.minimum && number <= range.maximum;
}
inline bool is_within(Range range, std::int64_t number) {
  const IntegerRange integers(range);
  return number >= integers.minimum && number <= integers.maximum;
}

inline Range within_int(Range range) {
  using Limits = std::numeric_limits<int>;
  return {std::max<double>(range.minimum, Limits::min()),
          std::min<double>(range.maximum, Limits::max())};
}

}  // namespace detail
}  // namespace weft
