// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace weft {

namespace detail {

inline bool is_digit(char letter) { return letter >= '0' && letter <= '9'; }

/// Returns the digits at the beginning of a text.
inline std::string_view leading_digits(std::string_view text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

inline std::string_view without_zeros(std::string_view digits) {
  return digits.substr(std::min(digits.find_first_not_of('0'), digits.size()));
}

/// Compares two texts of digits as numbers of any length. The result is below, equal to or above 0.
inline int compare_numbers(std::string_view a, std::string_view b) {
  a = without_zeros(a), b = without_zeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

}  // namespace detail

/// Natural order of file names: digits compare as numbers (img_2 before img_10), other characters
/// bytewise. Names that differ only in leading zeros compare bytewise.
inline bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (detail::is_digit(a[i]) && detail::is_digit(b[j])) {
      const std::string_view first = detail::leading_digits(a.substr(i));
      const std::string_view second = detail::leading_digits(b.substr(j));
      if (const int order = detail::compare_numbers(first, second); order != 0) return order < 0;
      i += first.size(), j += second.size();
    } else if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    } else {
      ++i, ++j;
    }
  }
  const std::size_t left = a.size() - i, right = b.size() - j;
  return left != right ? left < right : a < b;
}

/// Returns a hint for patterns that number files in another notation (img_%04d.png, img_####.png).
/// The hint is empty for any other pattern.
inline std::string numbering_hint(const std::string& pattern) {
  std::string wildcard;
  bool is_numbering = false;
  for (std::size_t i = 0; i < pattern.size();) {
    const std::string_view rest = std::string_view(pattern).substr(i);
    std::size_t length = 0;
    if (rest.front() == '%') {
      const std::size_t digits = detail::leading_digits(rest.substr(1)).size();
      const std::string_view letter = rest.substr(1 + digits, 1);
      if (letter == "d" || letter == "i" || letter == "u") length = digits + 2;
    } else if (rest.starts_with("##")) {
      length = std::min(rest.find_first_not_of('#'), rest.size());
    } else if (rest.starts_with("{:") || rest.starts_with("{}")) {
      length = rest.find('}') + 1;
    }
    is_numbering = is_numbering || length > 0;
    wildcard += length > 0 ? std::string("*") : std::string(1, rest.front());
    i += std::max<std::size_t>(length, 1);
  }
  return is_numbering ? "numbers are matched by *: write '" + wildcard + "'" : std::string();
}

}  // namespace weft
