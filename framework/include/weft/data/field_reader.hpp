// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/layout.hpp>
#include <weft/data/record.hpp>

namespace weft {

inline const weft_array* find_array(const weft_record& record, std::string_view name) {
  for (std::uint64_t i = 0; i < record.count; ++i) {
    if (record.arrays[i].name == name) return &record.arrays[i];
  }
  return nullptr;
}

namespace detail {

template <class T>
Array<T> borrow_array(const weft_array& array) {
  typename Array<T>::Shape shape{};
  for (int axis = 0; axis < array.ndim; ++axis) {
    shape[to_index(axis)] = array.shape[axis];
  }
  const ArrayOrigin origin{array.owner, array.reserved_word, std::to_array(array.reserved)};
  if (array.memory == WEFT_DEVICE) {
    return Array<T>::on_device(array.handle, array.ndim, shape, nullptr, origin);
  }
  const std::int64_t row_stride =
      array.ndim > 0 ? array.stride[0] / static_cast<std::int64_t>(sizeof(T)) : 1;
  return Array<T>::borrow(static_cast<const T*>(array.data), array.ndim, shape, row_stride, origin);
}

/// Borrows an array with elements of a known type.
inline AnyArray borrow_any(const weft_array& array) {
  AnyArray borrowed;
  const auto borrow_if = [&]<class T>(Array<T>) {
    if (array.dtype == dtype_of<T>()) borrowed = borrow_array<T>(array);
  };
  const auto borrow_one_of = [&]<class... Arrays>(const std::variant<Arrays...>*) {
    (borrow_if(Arrays()), ...);
  };
  borrow_one_of(&borrowed);
  return borrowed;
}

/// Returns whether the catalogue of this SDK contains an array of a record type.
template <class RecordType>
bool is_named(std::string_view array) {
  bool found = false;
  const RecordType typed{};
  RecordType::fields(typed, [&](const auto&, const Field& field) {
    std::string_view name = field.name;
    const bool is_prefix = name.ends_with(".*");
    if (is_prefix) name.remove_suffix(1);
    found = found || (is_prefix ? array.starts_with(name) : array == name);
  });
  return found;
}

/// Returns whether an array can be kept under its name and read in place.
inline bool can_be_kept(const weft_array& array) {
  return std::string_view(array.name).size() <= Name::kLongest &&
         ShapePattern::check_layout(array).empty();
}

/// Compares the arrays of a record with the fields of its struct and keeps the first error.
class FieldCheck {
 public:
  explicit FieldCheck(const weft_record& record) : record_(record) {}

  template <class T>
  void operator()(const Array<T>&, const Field& field) {
    checked(field, dtype_of<T>());
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T&, const Field& field) { checked(field, dtype_of<T>()); }
  void operator()(const std::string&, const Field& field) { checked(field, WEFT_U8); }
  void operator()(const NamedArrays&, const Field&) {}
  void operator()(const Diagnostics&, const Field&) {}

  const std::string& error() const { return error_; }

 protected:
  /// Returns null if the array is absent or invalid.
  const weft_array* checked(const Field& field, std::int32_t dtype) {
    const weft_array* array = find_array(record_, field.name);
    std::string problem;
    if (array == nullptr) {
      if (!field.optional) problem = "is missing";
    } else if (array->dtype != dtype) {
      problem = std::string("has elements of type ") + dtype_name(array->dtype) + " where " +
                dtype_name(dtype) + " is expected";
    } else if (array->memory == WEFT_DEVICE && !field.may_be_on_device) {
      problem = "lies in device memory";
    } else {
      problem = lengths_.match(field.shape, *array);
    }
    if (array != nullptr) ++found_;
    if (problem.empty()) return array;
    if (error_.empty()) {
      error_ = std::string(record_.type) + ": array '" + field.name + "' " + problem;
    }
    return nullptr;
  }

  const weft_record& record() const { return record_; }

  std::uint64_t found_ = 0;  ///< number of arrays found in the catalogue

 private:
  const weft_record& record_;
  ShapePattern lengths_;
  std::string error_;
};

/// Extent of a read: everything, or only arrays and numbers without texts and unknown arrays.
enum class Read { all, arrays };

/// Fills the members of a record struct from the arrays of a record and keeps the first error.
class FieldReader : public FieldCheck {
 public:
  FieldReader(const weft_record& record, Read read) : FieldCheck(record), read_(read) {}

  template <class T>
  void operator()(Array<T>& member, const Field& field) {
    if (const weft_array* array = checked(field, dtype_of<T>())) member = borrow_array<T>(*array);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& member, const Field& field) {
    if (const weft_array* array = checked(field, dtype_of<T>())) {
      member = *static_cast<const T*>(array->data);
    }
  }
  void operator()(std::string& member, const Field& field) {
    const weft_array* array = checked(field, WEFT_U8);
    if (array == nullptr || read_ == Read::arrays) return;
    member.assign(static_cast<const char*>(array->data), to_index(array->shape[0]));
  }
  void operator()(NamedArrays& member, const Field&) { collect(member.prefix, member.entries); }
  void operator()(Diagnostics& member, const Field&) { collect("diag.", member.entries()); }

  /// Reads the arrays unknown to the catalogue, after a visit to all fields.
  template <class RecordType>
  void collect_others(Others& others) const {
    if (found_ == record().count) return;
    for (const weft_array* array = record().arrays; array != record().arrays + record().count;
         ++array) {
      if (dtype_size(array->dtype) == 0) {
        others.unreadable().push_back(*array);
      } else if (can_be_kept(*array) && !is_named<RecordType>(array->name)) {
        others.read().push_back({std::string_view(array->name), borrow_any(*array)});
      }
    }
  }

 private:
  static bool belongs(const weft_array& array, std::string_view prefix) {
    return array.memory != WEFT_DEVICE && std::string_view(array.name).starts_with(prefix) &&
           can_be_kept(array);
  }

  void collect(std::string_view prefix, std::vector<NamedArray>& entries) {
    if (read_ == Read::arrays) return;
    const weft_array *begin = record().arrays, *end = begin + record().count;
    entries.reserve(to_index(std::count_if(
        begin, end, [&](const weft_array& array) { return belongs(array, prefix); })));
    for (const weft_array* array = begin; array != end; ++array) {
      if (belongs(*array, prefix)) {
        entries.push_back({std::string_view(array->name), borrow_any(*array)});
        ++found_;
      }
    }
  }

  Read read_;
};

}  // namespace detail

}  // namespace weft
