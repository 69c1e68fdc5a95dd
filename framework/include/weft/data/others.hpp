// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>
#include <weft/core/name.hpp>
#include <weft/data/array.hpp>

namespace weft {

/// An array of any type of elements.
using AnyArray = std::variant<Array<double>, Array<float>, Array<std::uint8_t>, Array<std::int8_t>,
                              Array<std::uint16_t>, Array<std::int16_t>, Array<std::int32_t>,
                              Array<std::int64_t>>;

/// An array beyond the catalogue: `diag.*` evidence, `model.*` of a warp, or one of others.
struct NamedArray {
  Name name;
  AnyArray values;

  /// Null where the elements are of another type.
  template <class T = double>
  const Array<T>* as() const {
    return std::get_if<Array<T>>(&values);
  }
};

/// Whether a name is that of an array of a third party: `x.vendor.name`, neither part empty.
inline bool is_vendor_name(std::string_view name) {
  if (!name.starts_with("x.")) return false;
  const std::size_t dot = name.find('.', 2);
  return dot != std::string_view::npos && dot > 2 && dot + 1 < name.size();
}

/// What a record has besides the members of its struct: arrays that the catalogue of this SDK does
/// not name, made by a newer one or by a third party, and where the struct was read from. Those
/// that were read are borrowed, as all members are, and valid as long: until the call returns. They
/// go on when the struct is given to a nested component or returned, also with other members, as
/// long as the record's lengths are those that were read. The revision goes on only with the
/// members that were read, and is 0 otherwise.
class Others {
 public:
  /// The array of this name and type of elements; null where there is none.
  template <class T>
  const Array<T>* find(std::string_view name) const {
    for (const auto* entries : {&own_, &read_}) {
      for (const NamedArray& entry : *entries) {
        if (entry.name == name) return entry.as<T>();
      }
    }
    return nullptr;
  }

  /// Adds or replaces an array of the component's own, "x.vendor.name", which goes with the record
  /// in any case. Throws std::invalid_argument for another name.
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

  /// Leaves behind what was read; for who gives the elements of a record another order.
  void drop() { read_.clear(); }

  /// That the record was made in, or WEFT_NO_FRAME.
  std::int64_t frame() const { return frame_; }

  // What follows is for readers and writers of records.

  const std::vector<NamedArray>& own() const { return own_; }
  const std::vector<NamedArray>& read() const { return read_; }
  std::vector<NamedArray>& own() { return own_; }
  std::vector<NamedArray>& read() { return read_; }
  /// Of the members when they were read; 0 of a struct that was not.
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
  }

 private:
  std::vector<NamedArray> read_, own_;
  std::uint64_t fingerprint_ = 0, revision_ = 0;
  std::int64_t frame_ = WEFT_NO_FRAME;
  std::int32_t view_ = 0, object_ = 0;
};

}  // namespace weft
