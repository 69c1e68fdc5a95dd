// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <string>

namespace weft {

/// Returns why the size of a surface is doubtful: larger than 5 m or smaller than 5 mm, as from a
/// length in a wrong unit. The text refers to the parameter that scales the surface, "" if there is
/// none. Empty if the size is plausible.
inline std::string size_doubt(double largest_side_m, const std::string& parameter) {
  constexpr double kLeast_m = 0.005, kMost_m = 5.0;
  if (!(largest_side_m > kMost_m) && !(largest_side_m < kLeast_m)) return {};
  char size[64];
  const bool is_large = largest_side_m > kMost_m;
  std::snprintf(size, sizeof size, is_large ? "%.3g m" : "%.3g mm",
                is_large ? largest_side_m : 1000.0 * largest_side_m);
  std::string text = std::string("the surface is ") + size + (is_large ? " large" : " small");
  if (parameter.empty()) return text + ": are its units right?";
  text += ": is '" + parameter + "' right, which is in metres?";
  return parameter == "unit_m"
             ? text + " It is 0.001 for a file in millimetres, 0.01 for centimetres"
             : text;
}

}  // namespace weft
