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

/// A text that can be an argument of a template.
template <std::size_t Size>
struct FixedText {
  constexpr FixedText(const char (&text)[Size]) { std::copy_n(text, Size, bytes); }
  constexpr std::string_view view() const { return {bytes, Size - 1}; }

  char bytes[Size]{};
};

// By value: with -fsanitize=undefined GCC takes no address of an argument of a template for
// constant.
template <std::size_t Size>
constexpr bool is_id(FixedText<Size> text) {
  return is_component_id(text.view());
}
template <std::size_t Size>
constexpr bool begins_with(FixedText<Size> id, std::string_view role) {
  return id.view().substr(0, id.view().find('/')) == role;
}

/// Roles have one of their own: only a private one is not seen.
template <class T>
concept SaysAbout = requires {
  requires std::same_as<std::remove_cvref_t<decltype(T::kAbout)>, About>;
};

#define WEFT_IS_ABOUT(name) \
  requires { requires std::same_as<std::remove_cvref_t<decltype(T::name)>, About>; }
/// Has an About under a name that is nearly the right one: other capitals, two letters exchanged.
template <class T>
concept MisspellsAbout = WEFT_IS_ABOUT(kabout) || WEFT_IS_ABOUT(KAbout) || WEFT_IS_ABOUT(k_about) ||
    WEFT_IS_ABOUT(about) || WEFT_IS_ABOUT(About) || WEFT_IS_ABOUT(kAbuot) ||
    WEFT_IS_ABOUT(kAobut) || WEFT_IS_ABOUT(kAbotu) || WEFT_IS_ABOUT(kAbouts);
#undef WEFT_IS_ABOUT

/// Does not compile, with a sentence that says why, where class and id do not make a component.
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
  static_assert(!MisspellsAbout<T>,
                "a component calls its weft::About kAbout; this one has another name, which nobody "
                "reads");
}

}  // namespace weft::detail
