// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace weft::mutants {

/// What a component must have for an operator to change anything about it.
enum class Having {
  anything,
  numbers,    ///< a parameter that is one number and has a default
  ranges,     ///< such a number with a finite end
  extension,  ///< an extension that is read when the library is described
  no_random,  ///< it does not draw from the seed
};

/// One way in which a plugin can be wrong.
struct Operator {
  std::string_view name;   ///< "wrong_magic"
  std::string_view group;  ///< of checks, the one that should tell: "load"
  std::string_view roles;  ///< to which it applies, separated by spaces; empty: to all
  Having having;
  std::string_view deed;  ///< what a plugin does then: "its table begins with another word"
};

/// What stands in the library that misbehaves where the path of its order is written, which goes
/// with it wherever it is copied to; behind it are zeros.
inline constexpr std::string_view kOrderMark = "WEFT_MUTANT_ORDER=";
inline constexpr std::size_t kOrderRoom = 1024;  ///< [bytes] mark and path, with a NUL

/// The fixed list, ordered by group.
std::span<const Operator> operators();

/// Null where there is none.
const Operator* find_operator(std::string_view name);

}  // namespace weft::mutants
