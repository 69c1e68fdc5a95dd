// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
#include <weft/core/name.hpp>
#include <weft/data/array.hpp>

namespace weft {

/// An array with any element type.
using AnyArray =
    std::variant<Array<double>, Array<float>, Array<std::uint8_t>, Array<std::int8_t>,
                 Array<std::uint16_t>, Array<std::int16_t>, Array<std::int32_t>,
                 Array<std::int64_t>, Array<Float16>, Array<std::uint32_t>, Array<std::uint64_t>>;

/// An array outside the catalogue: `diag.*` diagnostics, `model.*` of a warp, or an unknown array.
struct NamedArray {
  Name name;
  AnyArray values;

  /// Returns the array; null for another element type.
  template <class T = double>
  const Array<T>* as() const {
    return std::get_if<Array<T>>(&values);
  }
};

/// Returns whether a name is a third-party array name, `x.vendor.name` with non-empty parts.
inline bool is_vendor_name(std::string_view name) {
  if (!name.starts_with("x.")) return false;
  const std::size_t dot = name.find('.', 2);
  return dot != std::string_view::npos && dot > 2 && dot + 1 < name.size();
}

/// Everything in a record beyond the members of its struct: its origin, its reserved words and the
/// arrays unknown to the catalogue of this SDK. Such arrays come from a newer SDK or a third party.
/// Arrays that were read are borrowed and valid until the call returns, like all members. They are
/// passed on when the struct goes to a nested component or is returned, also with changed members.
/// The condition is that the record's lengths are unchanged. The revision is passed on only with
/// unchanged members and is 0 otherwise.
class Others {
 public:
  /// The array of this name and element type; null if there is none.
  template <class T>
  const Array<T>* find(std::string_view name) const {
    for (const auto* entries : {&own_, &read_}) {
      for (const NamedArray& entry : *entries) {
        if (entry.name == name) return entry.as<T>();
      }
    }
    return nullptr;
  }

  /// Adds or replaces an array of the component, "x.vendor.name", which is always passed on with
  /// the record. Throws std::invalid_argument for another name.
  template <class T>
  void set(std::string_view name, Array<T> values) {
    if (!is_vendor_name(name)) {
      throw std::invalid_argument("the array '" + std::string(name) +
                                  "' must be called x.vendor.name");
    }
    const auto has_name = [&](const NamedArray& entry) { return entry.name == name; };
    std::erase_if(own_, has_name);
    own_.push_back({name, std::move(values)});
  }

  /// Discards the arrays that were read; required when the elements of a record are reordered.
  void drop() {
    read_.clear();
    unreadable_.clear();
  }

  /// Index of the frame in which the record was made, or WEFT_NO_FRAME.
  std::int64_t frame() const { return frame_; }

  // The following members serve readers and writers of records.

  const std::vector<NamedArray>& own() const { return own_; }
  const std::vector<NamedArray>& read() const { return read_; }
  std::vector<NamedArray>& own() { return own_; }
  std::vector<NamedArray>& read() { return read_; }
  /// Arrays with elements of a type that this SDK does not know, for nested components that do.
  const std::vector<weft_array>& unreadable() const { return unreadable_; }
  std::vector<weft_array>& unreadable() { return unreadable_; }
  const std::array<std::uint64_t, 3>& reserved() const { return reserved_; }
  /// Fingerprint of the members at the time of the read; 0 for a struct that was not read.
  std::uint64_t fingerprint() const { return fingerprint_; }
  std::uint64_t revision() const { return revision_; }
  std::int32_t view() const { return view_; }
  std::int32_t object() const { return object_; }
  void seal(std::uint64_t fingerprint, std::uint64_t revision) {
    fingerprint_ = fingerprint;
    revision_ = revision;
  }
  void place(const weft_record& record) {
    frame_ = record.frame;
    view_ = record.view;
    object_ = record.object;
    std::copy(std::begin(record.reserved), std::end(record.reserved), reserved_.begin());
  }

 private:
  std::vector<NamedArray> read_, own_;
  std::uint64_t fingerprint_ = 0, revision_ = 0;
  std::int64_t frame_ = WEFT_NO_FRAME;
  std::int32_t view_ = 0, object_ = 0;
  std::vector<weft_array> unreadable_;
  std::array<std::uint64_t, 3> reserved_{};
};

}  // namespace weft
