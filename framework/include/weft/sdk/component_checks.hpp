// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <string_view>
#include <type_traits>
#include <weft/core/component_id.hpp>
#include <weft/sdk/role.hpp>

namespace weft::detail {

/// A text that can be a template argument.
template <std::size_t Size>
struct FixedText {
  constexpr FixedText(const char (&text)[Size]) { std::copy_n(text, Size, bytes); }
  constexpr std::string_view view() const { return {bytes, Size - 1}; }

  char bytes[Size]{};
};

// Passed by value: GCC with -fsanitize=undefined does not accept the address of a template argument
// as constant.
template <std::size_t Size>
constexpr bool is_id(FixedText<Size> text) {
  return is_component_id(text.view());
}
template <std::size_t Size>
constexpr bool begins_with(FixedText<Size> id, std::string_view role) {
  return id.view().substr(0, id.view().find('/')) == role;
}

/// Every role declares its own kAbout; only a private one is not visible.
template <class T>
concept SaysAbout = requires {
  requires std::same_as<std::remove_cvref_t<decltype(T::kAbout)>, About>;
};

#define WEFT_IS_ABOUT(name) \
  requires { requires std::same_as<std::remove_cvref_t<decltype(T::name)>, About>; }
/// Detects an About with a misspelled name: different capitals or two exchanged letters.
template <class T>
concept MisspellsAbout = WEFT_IS_ABOUT(kabout) || WEFT_IS_ABOUT(KAbout) || WEFT_IS_ABOUT(k_about) ||
    WEFT_IS_ABOUT(about) || WEFT_IS_ABOUT(About) || WEFT_IS_ABOUT(kAbuot) ||
    WEFT_IS_ABOUT(kAobut) || WEFT_IS_ABOUT(kAbotu) || WEFT_IS_ABOUT(kAbouts);
#undef WEFT_IS_ABOUT

/// Stops the compilation with an explanation if class and id do not make a component.
template <class T, FixedText kId>
constexpr void check_component() {
  static_assert(
      requires { T::kRole; },
      "the class of a component derives from that of its role, such as weft::Filter");
  static_assert(!std::is_abstract_v<T>,
                "the class of a component overrides each method that its role leaves open");
  static_assert(
      std::is_abstract_v<T> || std::is_constructible_v<T, Params&>,
      "the class of a component has the public constructor `explicit Mine(weft::Params&)`");
  static_assert(is_id(kId),
                "an id reads \"role/name\" or \"role/vendor.name\", of lower case letters, digits "
                "and underscores");
  if constexpr (requires { T::kRole; }) {
    static_assert(begins_with(kId, T::kRole),
                  "the id of a component begins with the role of its class: \"filters/mine\" for a "
                  "weft::Filter, \"solvers/mine\" for a weft::Solver");
  }
  static_assert(SaysAbout<T>,
                "kAbout of a component is public and a weft::About: write `static constexpr "
                "weft::About kAbout{...};` below `public:`");
  static_assert(
      !MisspellsAbout<T>,
      "a component calls its weft::About kAbout; this one has another name, which is never read");
}

}  // namespace weft::detail
