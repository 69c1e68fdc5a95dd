// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
#include <weft/core/name.hpp>
#include <weft/core/result.hpp>
#include <weft/data/array.hpp>
#include <weft/data/others.hpp>

namespace weft {

/// What the catalogue says of one array of a record. `shape` is "" for a scalar, else lengths or
/// letters separated by commas ("N,2"); a letter has one value in a record. "*" takes any length,
/// "H,W,?" an optional last axis.
struct Field {
  const char* name;
  const char* shape;
  const char* unit;  ///< unit and frame, "" where there is none
  const char* meaning;
  bool optional = false;
  bool may_be_nan = false;        ///< NaN marks a missing value
  bool may_be_on_device = false;  ///< readers ask is_on_device() before they read elements
};

/// Evidence that a component gives with its result: scalars go to frames.jsonl, arrays to dumps.
class Diagnostics {
 public:
  void set(std::string_view name, double value) { set(name, make_scalar(value)); }
  template <class T>
  void set(std::string_view name, Array<T> values) {
    constexpr std::size_t kUsual = 12;
    if (entries_.empty()) entries_.reserve(kUsual);
    entries_.push_back({Name("diag.", name), std::move(values)});
  }
  const std::vector<NamedArray>& entries() const { return entries_; }
  std::vector<NamedArray>& entries() { return entries_; }

  /// The scalar of this name, of whatever type, or `fallback`.
  double value(std::string_view name, double fallback) const {
    for (const NamedArray& entry : entries_) {
      if (std::string_view(entry.name).substr(5) != name) continue;
      const auto number = [&](const auto& array) {
        return array.ndim() == 0 ? static_cast<double>(*array.data()) : fallback;
      };
      return std::visit(number, entry.values);
    }
    return fallback;
  }
  /// The array of this name and type of elements; null where there is none.
  template <class T = double>
  const Array<T>* find(std::string_view name) const {
    for (const NamedArray& entry : entries_) {
      if (std::string_view(entry.name).substr(5) == name) return entry.as<T>();
    }
    return nullptr;
  }

 private:
  std::vector<NamedArray> entries_;
};

/// All arrays of a record whose names begin with a prefix, passed through untouched.
struct NamedArrays {
  const char* prefix;
  std::vector<NamedArray> entries;

  /// The array of this name and type of elements; null where there is none.
  template <class T = double>
  const Array<T>* find(std::string_view name) const {
    for (const NamedArray& entry : entries) {
      if (entry.name == name) return entry.as<T>();
    }
    return nullptr;
  }
};

// The struct of a record type has
//   static constexpr const char* kType = "name/version";
//   template <class Self, class Visit> static void fields(Self& self, Visit&& visit);
// whose visit(member, Field) calls are the catalogue: readers, writers, validation and the
// documentation are made from them. Members are Array<T>, double, std::int64_t, std::int32_t,
// std::string, NamedArrays or Diagnostics. What else a record has is in a member `others` of type
// Others, which is not visited.

}  // namespace weft
