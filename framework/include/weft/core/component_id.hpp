// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string_view>

namespace weft {

/// Returns whether a word is a valid part of a component id: [a-z][a-z0-9_]*.
constexpr bool is_part_of_id(std::string_view word) {
  const auto lower = [](char c) { return c >= 'a' && c <= 'z'; };
  return !word.empty() && lower(word.front()) && std::all_of(word.begin(), word.end(), [&](char c) {
    return lower(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Returns whether a text is a component id: role/name or role/vendor.name.
constexpr bool is_component_id(std::string_view id) {
  const std::size_t slash = id.find('/');
  if (slash == std::string_view::npos || !is_part_of_id(id.substr(0, slash))) return false;
  const std::string_view name = id.substr(slash + 1);
  const std::size_t dot = name.find('.');
  if (dot == std::string_view::npos) return is_part_of_id(name);
  return is_part_of_id(name.substr(0, dot)) && is_part_of_id(name.substr(dot + 1));
}

/// Returns whether a record type belongs to a vendor: "acme.depth/1".
constexpr bool is_vendor_record(std::string_view type) {
  const std::size_t slash = type.find('/'), dot = type.find('.');
  if (slash == std::string_view::npos || dot == std::string_view::npos || dot > slash) return false;
  const std::string_view version = type.substr(slash + 1);
  return is_part_of_id(type.substr(0, dot)) &&
         is_part_of_id(type.substr(dot + 1, slash - dot - 1)) && !version.empty() &&
         version.front() != '0' &&
         std::all_of(version.begin(), version.end(), [](char c) { return c >= '0' && c <= '9'; });
}

}  // namespace weft
