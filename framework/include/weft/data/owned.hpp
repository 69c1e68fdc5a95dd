// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <weft/data/record.hpp>

namespace weft {

/// The array in memory of its own, in C order: what it was borrowed from may go. Not for arrays on
/// a device.
template <class T>
Array<T> owned(const Array<T>& array) {
  if (!array.present()) return {};
  const auto length = [&](int axis) { return array.dim(axis); };
  Array<T> copy = array.ndim() == 0   ? Array<T>({}, T{})
                  : array.ndim() == 1 ? Array<T>({length(0)})
                  : array.ndim() == 2 ? Array<T>({length(0), length(1)})
                  : array.ndim() == 3 ? Array<T>({length(0), length(1), length(2)})
                                      : Array<T>({length(0), length(1), length(2), length(3)});
  for (std::int64_t i = 0; i < copy.dim(0); ++i) {
    std::copy_n(array.row(i), array.row_elements(), copy.row(i));
  }
  return copy;
}

namespace detail {

/// Lets each member of a record struct own what it borrows.
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

 private:
  static void all(std::vector<NamedArray>& entries) {
    for (NamedArray& entry : entries) entry.values = owned(entry.values);
  }
};

}  // namespace detail

/// The struct of a record with all arrays in memory of its own.
template <class RecordType>
RecordType owned_record(RecordType typed) {
  RecordType::fields(typed, detail::TakeOver());
  return typed;
}

}  // namespace weft
