// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <variant>
#include <weft/data/origin.hpp>

namespace weft {

/// Copies the array into its own memory, in C order. Not for arrays on a device.
template <class T>
Array<T> owned(const Array<T>& array) {
  if (!array.present()) return {};
  const auto length = [&](int axis) { return array.dim(axis); };
  Array<T> copy =
      array.ndim() == 0   ? Array<T>({}, T{})
      : array.ndim() == 1 ? Array<T>({length(0)})
      : array.ndim() == 2 ? Array<T>({length(0), length(1)})
      : array.ndim() == 3 ? Array<T>({length(0), length(1), length(2)})
      : array.ndim() == 4 ? Array<T>({length(0), length(1), length(2), length(3)})
      : array.ndim() == 5
          ? Array<T>({length(0), length(1), length(2), length(3), length(4)})
          : Array<T>({length(0), length(1), length(2), length(3), length(4), length(5)});
  for (std::int64_t i = 0; i < copy.dim(0); ++i) {
    std::copy_n(array.row(i), array.row_elements(), copy.row(i));
  }
  return copy;
}

namespace detail {

/// Copies borrowed members of a record struct into their own memory.
struct TakeOver {
  template <class T>
  void operator()(Array<T>& member, const Field& /*field*/) const {
    member = owned(member);
  }
  void operator()(NamedArrays& member, const Field& /*field*/) const { all(member.entries); }
  void operator()(Diagnostics& member, const Field& /*field*/) const { all(member.entries()); }
  void operator()(std::string& /*member*/, const Field& /*field*/) const {}
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& /*member*/, const Field& /*field*/) const {}

  static void all(std::vector<NamedArray>& entries) {
    for (NamedArray& entry : entries) {
      std::visit([](auto& array) { array = owned(array); }, entry.values);
    }
  }
};

}  // namespace detail

/// Copies all arrays of a record struct into their own memory, including the further ones. The copy
/// may be modified, so its revision is 0.
template <class RecordType>
RecordType owned_record(RecordType typed) {
  const bool made = typed.others.fingerprint() == 0;
  const bool as_long = detail::is_as_long(typed);
  RecordType::fields(typed, detail::TakeOver());
  std::erase_if(typed.others.read(), [&](const NamedArray& entry) {
    return !as_long ||
           std::visit([](const auto& array) { return array.is_on_device(); }, entry.values);
  });
  typed.others.unreadable().clear();  // their length in bytes is unknown
  detail::TakeOver::all(typed.others.read());
  detail::TakeOver::all(typed.others.own());
  if (!made) typed.others.seal(detail::fingerprint_of(typed), 0);
  if constexpr (requires { typed.revision; }) typed.revision = 0;
  return typed;
}

}  // namespace weft
