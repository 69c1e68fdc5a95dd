// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/codec.hpp>

namespace weft::testing_data {

/// Fills a record struct with random content that the catalogue allows: lengths from 0 to 6,
/// optional arrays now and then absent, NaN where it may stand.
class Filler {
 public:
  explicit Filler(Rng& rng) : rng_(rng) {}

  template <class T>
  void operator()(Array<T>& member, const Field& field) {
    if (field.optional && rng_.below(3) == 0) return;
    member = array<T>(shape_of(field.shape));
    if constexpr (std::is_floating_point_v<T>) {
      const bool with_nan = field.may_be_nan && member.size() > 0;
      if (with_nan) *member.data() = std::numeric_limits<T>::quiet_NaN();
    }
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& member, const Field&) { member = value<T>(); }
  void operator()(std::string& member, const Field&) {
    member.clear();
    for (std::uint32_t i = rng_.below(9); i > 0; --i) {
      member += static_cast<char>('a' + rng_.below(26));
    }
  }
  void operator()(NamedArrays& member, const Field&) {
    member.entries.push_back({std::string(member.prefix) + "grid", array<double>({3, 2, 4})});
    member.entries.push_back({std::string(member.prefix) + "empty", array<double>({0})});
    member.entries.push_back({std::string(member.prefix) + "words", array<std::uint16_t>({2, 3})});
  }
  void operator()(Diagnostics& member, const Field&) {
    member.set("number", value<double>());
    member.set("list", array<double>({5}));
    member.set("counts", array<std::int32_t>({4}));
    member.set("samples", array<float>({2, 2}));
  }

 private:
  template <class T>
  T value() {
    if constexpr (std::is_floating_point_v<T>) return static_cast<T>(rng_.uniform(-10.0, 10.0));
    return static_cast<T>(rng_.next_u32());
  }
  template <class T>
  Array<T> array(const std::vector<std::int64_t>& shape) {
    Array<T> result = shape.empty()       ? Array<T>(std::initializer_list<std::int64_t>{})
                      : shape.size() == 1 ? Array<T>({shape[0]})
                      : shape.size() == 2 ? Array<T>({shape[0], shape[1]})
                                          : Array<T>({shape[0], shape[1], shape[2]});
    for (std::int64_t i = 0; i < result.size(); ++i) result.data()[i] = value<T>();
    return result;
  }
  std::vector<std::int64_t> shape_of(const std::string& pattern) {
    std::vector<std::int64_t> shape;
    for (const char symbol : pattern) {
      if (symbol == ',') continue;
      if (symbol == '?') {
        if (rng_.below(2) == 0) shape.push_back(3);
      } else if (symbol >= '0' && symbol <= '9') {
        shape.push_back(symbol - '0');
      } else {
        shape.push_back(lengths_.try_emplace(symbol, rng_.below(7)).first->second);
      }
    }
    return shape;
  }

  Rng& rng_;
  std::map<char, std::int64_t> lengths_;
};

template <class RecordType>
RecordType random_record(Rng& rng) {
  RecordType typed;
  RecordType::fields(typed, Filler(rng));
  return typed;
}

/// The content of a record, for comparisons: name, type, shape and bytes of each array.
using Content =
    std::vector<std::tuple<std::string, std::int32_t, std::vector<std::int64_t>, std::string>>;

inline Content content_of(const weft_record& record) {
  Content content;
  for (std::uint64_t i = 0; i < record.count; ++i) {
    const weft_array& array = record.arrays[i];
    std::size_t row_bytes = to_index(dtype_size(array.dtype));
    for (int axis = 1; axis < array.ndim; ++axis) {
      row_bytes *= to_index(array.shape[axis]);
    }
    std::string bytes;
    const std::int64_t rows = array.ndim > 0 ? array.shape[0] : 1;
    for (std::int64_t row = 0; row < rows; ++row) {
      const std::int64_t offset = array.ndim > 0 ? row * array.stride[0] : 0;
      bytes.append(static_cast<const char*>(array.data) + offset, row_bytes);
    }
    content.emplace_back(array.name, array.dtype,
                         std::vector<std::int64_t>(array.shape, array.shape + array.ndim), bytes);
  }
  return content;
}

template <class RecordType>
Content content_of(const RecordType& typed) {
  return content_of(RecordView<RecordType>("", typed).raw());
}

/// A record whose arrays of two and more axes have gaps between their rows, filled with garbage,
/// and, if `reversed`, lie with the last row first.
class PaddedRecord {
 public:
  PaddedRecord(const weft_record& record, bool reversed) : record_(record) {
    for (std::uint64_t i = 0; i < record.count; ++i) {
      weft_array array = record.arrays[i];
      if (array.ndim >= 2 && array.shape[0] > 0) pad(array, reversed);
      arrays_.push_back(array);
    }
    record_.arrays = arrays_.data();
  }

  const weft_record& raw() const { return record_; }

 private:
  void pad(weft_array& array, bool reversed) {
    const std::int64_t element = dtype_size(array.dtype), rows = array.shape[0];
    std::int64_t row_bytes = element;
    for (int axis = 1; axis < array.ndim; ++axis) row_bytes *= array.shape[axis];
    const std::int64_t stride = row_bytes + 3 * element;
    auto& memory = memory_.emplace_back(to_index(rows * stride) / 8 + 1, 0xABABABABABABABABU);
    char* start = reinterpret_cast<char*>(memory.data());
    if (reversed) start += (rows - 1) * stride;
    const std::int64_t step = reversed ? -stride : stride;
    for (std::int64_t row = 0; row < rows; ++row) {
      std::memcpy(start + row * step, static_cast<const char*>(array.data) + row * array.stride[0],
                  to_index(row_bytes));
    }
    array.data = start;
    array.stride[0] = step;
  }

  weft_record record_;
  std::vector<weft_array> arrays_;
  std::vector<std::vector<std::uint64_t>> memory_;
};

}  // namespace weft::testing_data
