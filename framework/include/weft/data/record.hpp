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

/// Catalogue entry of one array of a record. `shape` is "" for a scalar, else lengths or letters
/// separated by commas ("N,2"). A letter has one value per record. "*" is any length; "H,W,?" has
/// an optional last axis.
struct Field {
  const char* name;
  const char* shape;
  const char* unit;  ///< unit and frame; "" if there is none
  const char* meaning;
  bool optional = false;
  bool may_be_nan = false;  ///< true if NaN marks a missing value
  bool may_be_on_device =
      false;  ///< true if readers must check is_on_device() before they read elements
};

/// Diagnostics that a component returns with its result. Scalars go to frames.jsonl, arrays to
/// dumps.
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

  /// The scalar of this name, converted from any type, or `fallback`.
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
  /// The array of this name and element type; null if there is none.
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

/// All arrays of a record whose names begin with a prefix, passed on unchanged.
struct NamedArrays {
  const char* prefix;               ///< prefix of the names, such as "model."
  std::vector<NamedArray> entries;  ///< [.] arrays with that prefix

  /// The array of this name and element type; null if there is none.
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
// Its visit(member, Field) calls are the catalogue, from which readers, writers, validation and
// documentation are generated. Members are Array<T>, double, std::int64_t, std::int32_t,
// std::string, NamedArrays or Diagnostics. The member `others` of type Others contains everything
// else in a record and is not visited.

}  // namespace weft
