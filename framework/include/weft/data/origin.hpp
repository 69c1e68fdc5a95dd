// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <weft/core/index.hpp>
#include <weft/data/record.hpp>

namespace weft {
namespace detail {

/// Visits the members of a record struct to detect changes: arrays by address and layout, numbers
/// and texts by value. The lower half of the value depends only on the record's lengths that have a
/// letter in the catalogue.
class Fingerprint {
 public:
  template <class T>
  void operator()(const Array<T>& member, const Field& field) {
    add(member);
    if (!member.present()) return;
    int axis = 0;
    for (const char* symbol = field.shape; *symbol != '\0'; ++symbol) {
      if (*symbol == ',') ++axis;
      if (*symbol < 'A' || *symbol > 'Z') continue;
      const std::uint32_t letter = 1U << static_cast<unsigned>(*symbol - 'A');
      if ((letters_ & letter) != 0) continue;
      letters_ |= letter;
      lengths_ = mixed(lengths_ + letter, static_cast<std::uint64_t>(member.dim(axis)));
    }
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T& member, const Field& /*field*/) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &member, sizeof(T));
    mix(bits);
  }
  void operator()(const std::string& member, const Field& /*field*/) {
    mix(std::hash<std::string_view>()(member));
  }
  void operator()(const NamedArrays& member, const Field& /*field*/) { add_all(member.entries); }
  void operator()(const Diagnostics& member, const Field& /*field*/) { add_all(member.entries()); }

  /// The fingerprint; never 0.
  std::uint64_t value() const {
    return ((sum_ | (kLengths + 1U)) & ~kLengths) | (lengths_ & kLengths);
  }

  static constexpr std::uint64_t kLengths = 0xFFFFFFFFU;  ///< the bits that depend on lengths

 private:
  template <class T>
  void add(const Array<T>& array) {
    mix(reinterpret_cast<std::uintptr_t>(array.data()));
    mix(array.handle());
    mix(static_cast<std::uint64_t>(array.ndim()));
    for (int axis = 0; axis < array.ndim(); ++axis) {
      mix(static_cast<std::uint64_t>(array.dim(axis)));
    }
    mix(static_cast<std::uint64_t>(array.row_stride()));
  }
  void add_all(const std::vector<NamedArray>& entries) {
    mix(entries.size());
    for (const NamedArray& entry : entries) {
      mix(std::hash<std::string_view>()(entry.name));
      std::visit([this](const auto& array) { this->add(array); }, entry.values);
    }
  }
  // Mixes a number into a sum with the finisher of SplitMix64.
  static std::uint64_t mixed(std::uint64_t sum, std::uint64_t number) {
    sum = (sum ^ number) + 0x9E3779B97F4A7C15U;
    sum = (sum ^ (sum >> 30U)) * 0xBF58476D1CE4E5B9U;
    sum = (sum ^ (sum >> 27U)) * 0x94D049BB133111EBU;
    return sum ^ (sum >> 31U);
  }
  void mix(std::uint64_t number) { sum_ = mixed(sum_, number); }

  std::uint64_t sum_ = 0;
  std::uint64_t lengths_ = 0;  ///< mixed lengths of all letters so far
  std::uint32_t letters_ = 0;  ///< those that were seen
};

template <class RecordType>
std::uint64_t fingerprint_of(const RecordType& typed) {
  Fingerprint fingerprint;
  RecordType::fields(typed, fingerprint);
  return fingerprint.value();
}

/// Returns whether a record struct still has the members with which it was read. Elements that were
/// overwritten in place are not detected; inputs are read-only.
template <class RecordType>
bool is_as_read(const RecordType& typed) {
  const std::uint64_t read = typed.others.fingerprint();
  return read != 0 && read == fingerprint_of(typed);
}

/// Returns whether a record struct still has the lengths with which it was read.
template <class RecordType>
bool is_as_long(const RecordType& typed) {
  const std::uint64_t changed = typed.others.fingerprint() ^ fingerprint_of(typed);
  return (changed & Fingerprint::kLengths) == 0;
}

/// Calls visit(NamedArray) for the further arrays that are passed on with a record struct.
template <class RecordType, class Visit>
void for_each_other(const RecordType& typed, Visit&& visit) {
  for (const NamedArray& entry : typed.others.own()) visit(entry);
  if (typed.others.read().empty() || !is_as_long(typed)) return;
  for (const NamedArray& entry : typed.others.read()) {
    const auto& own = typed.others.own();
    const bool replaced = std::any_of(own.begin(), own.end(), [&](const NamedArray& each) {
      return each.name == std::string_view(entry.name);
    });
    if (!replaced) visit(entry);
  }
}

/// The arrays with elements of an unknown type that are passed on with a record struct.
template <class RecordType>
std::span<const weft_array> unreadable_of(const RecordType& typed) {
  const std::vector<weft_array>& arrays = typed.others.unreadable();
  if (arrays.empty() || !is_as_long(typed)) return {};
  return arrays;
}

/// The revision of a record struct that is passed on; 0 if the struct has changed. A component that
/// creates a record is responsible for the revision that it sets.
template <class RecordType>
std::uint64_t revision_of(const RecordType& typed) {
  const bool made = typed.others.fingerprint() == 0;
  if (!made && (!typed.others.own().empty() || !is_as_read(typed))) return 0;
  if constexpr (requires { typed.revision; }) return typed.revision;
  return typed.others.revision();
}

}  // namespace detail
}  // namespace weft
