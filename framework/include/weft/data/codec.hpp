// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <weft/core/index.hpp>
#include <weft/data/catalogue.hpp>
#include <weft/data/field_reader.hpp>
#include <weft/data/origin.hpp>
#include <weft/data/record_view.hpp>

namespace weft {

namespace detail {

/// Copies the members of a record struct into arrays of `alloc`. Arrays on a device go to its
/// adopt(), if it has one.
template <class Alloc>
class FieldWriter {
 public:
  explicit FieldWriter(Alloc& alloc) : alloc_(alloc) {}

  template <class T>
  void operator()(const Array<T>& member, const Field& field) {
    if (member.present()) write(field.name, member);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const T& member, const Field& field) {
    copy(field.name, dtype_of<T>(), 0, nullptr, &member, sizeof(T));
  }
  void operator()(const std::string& member, const Field& field) {
    const auto length = static_cast<std::int64_t>(member.size());
    copy(field.name, WEFT_U8, 1, &length, member.data(), member.size());
  }
  void operator()(const NamedArrays& member, const Field&) { write_all(member.entries); }
  void operator()(const Diagnostics& member, const Field&) { write_all(member.entries()); }
  void operator()(const NamedArray& entry) {
    std::visit([&](const auto& array) { this->write(entry.name.c_str(), array); }, entry.values);
  }

  /// Name of the first refused array; empty if there is none.
  const std::string& refused() const { return refused_; }

 private:
  void* allocate(const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape) {
    void* target = alloc_(name, dtype, ndim, shape);
    if (target == nullptr && refused_.empty()) refused_ = name;
    return target;
  }
  template <class T>
  void write(const char* name, const Array<T>& array) {
    if (array.is_on_device()) return hand_over(name, array);
    void* target = allocate(name, dtype_of<T>(), array.ndim(), array.shape().data());
    if (target == nullptr) return;
    const auto row_bytes = to_index(array.row_elements()) * sizeof(T);
    if (array.ndim() == 0 || array.contiguous()) {
      std::memcpy(target, array.data(), to_index(array.dim(0)) * row_bytes);
      return;
    }
    for (std::int64_t i = 0; i < array.rows(); ++i) {
      std::memcpy(static_cast<char*>(target) + to_index(i) * row_bytes, array.row(i), row_bytes);
    }
  }
  template <class T>
  void hand_over(const char* name, const Array<T>& array) {
    bool accepted = false;
    if constexpr (requires { alloc_.adopt(name, 0, 0, array.shape().data(), array.handle()); }) {
      accepted =
          alloc_.adopt(name, dtype_of<T>(), array.ndim(), array.shape().data(), array.handle());
    }
    if (!accepted && refused_.empty()) refused_ = name;
  }
  void write_all(const std::vector<NamedArray>& entries) {
    for (const NamedArray& entry : entries) (*this)(entry);
  }
  void copy(const char* name, std::int32_t dtype, int ndim, const std::int64_t* shape,
            const void* data, std::size_t bytes) {
    void* target = allocate(name, dtype, ndim, shape);
    if (target != nullptr && bytes > 0) std::memcpy(target, data, bytes);
  }

  Alloc& alloc_;
  std::string refused_;
};

}  // namespace detail

/// Makes a record struct that borrows the arrays of `record` and keeps arrays unknown to the
/// catalogue, see Others. Fails with invalid_data if the record has another type, or if an array is
/// missing or has a wrong type or shape.
template <class RecordType>
Result<RecordType> read_record(const weft_record& record, detail::Read read = detail::Read::all) {
  if (std::string_view(record.type) != RecordType::kType) {
    return Error{Errc::invalid_data,
                 std::string("expected a record ") + RecordType::kType + ", got " + record.type};
  }
  RecordType typed;
  detail::FieldReader reader(record, read);
  RecordType::fields(typed, reader);
  if (!reader.error().empty()) return Error{Errc::invalid_data, reader.error()};
  if constexpr (requires { typed.producer_handle; }) typed.producer_handle = record.producer;
  if constexpr (requires { typed.revision; }) typed.revision = record.revision;
  if (read == detail::Read::arrays) return typed;
  reader.collect_others<RecordType>(typed.others);
  typed.others.place(record);
  typed.others.seal(detail::fingerprint_of(typed), record.revision);
  return typed;
}

/// Reads the struct without its texts and without arrays unknown to the catalogue. Does not
/// allocate.
template <class RecordType>
Result<RecordType> read_arrays(const weft_record& record) {
  return read_record<RecordType>(record, detail::Read::arrays);
}

/// Copies a record struct through alloc(name, dtype, ndim, shape) -> void*, which returns null to
/// refuse.
template <class RecordType, class Alloc>
Result<void> write_record(const RecordType& typed, Alloc&& alloc) {
  detail::FieldWriter<std::remove_reference_t<Alloc>> writer(alloc);
  RecordType::fields(typed, writer);
  detail::for_each_other(typed, writer);
  if (writer.refused().empty()) return {};
  return Error{Errc::plugin_failure, "the array '" + writer.refused() + "' of " +
                                         RecordType::kType + " cannot be an output"};
}

}  // namespace weft
