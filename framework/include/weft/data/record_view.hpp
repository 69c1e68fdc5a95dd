// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>
#include <weft/core/inline_vector.hpp>
#include <weft/data/origin.hpp>

namespace weft {

/// A record struct as a weft_record, without a copy. The struct must outlive it. Further arrays and
/// the revision are passed on, see Others.
template <class RecordType>
class RecordView {
 public:
  RecordView(const char* slot, const RecordType& typed) {
    RecordType::fields(
        typed, [this](const auto& member, const Field& field) { this->add(member, field.name); });
    detail::for_each_other(typed, [this](const NamedArray& entry) { this->add(entry); });
    for (const weft_array& array : detail::unreadable_of(typed)) arrays_.push_back(array);
    const Others& others = typed.others;
    record_.slot = slot;
    record_.type = RecordType::kType;
    record_.revision = detail::revision_of(typed);
    record_.count = arrays_.size();
    record_.arrays = arrays_.data();
    record_.frame = others.frame();
    record_.view = others.view();
    record_.object = others.object();
    std::copy(others.reserved().begin(), others.reserved().end(), record_.reserved);
    if constexpr (requires { typed.producer_handle; }) record_.producer = typed.producer_handle;
  }
  RecordView(const RecordView&) = delete;
  RecordView& operator=(const RecordView&) = delete;

  const weft_record& raw() const { return record_; }

 private:
  template <class T>
  void add(const Array<T>& array, const char* name) {
    if (!array.present()) return;
    weft_array raw = empty(name, dtype_of<T>(), array.ndim(), array.data());
    if (array.is_on_device()) {
      raw.memory = WEFT_DEVICE;
      raw.handle = array.handle();
    }
    raw.owner = array.origin().owner;
    raw.reserved_word = array.origin().reserved_word;
    std::copy(array.origin().reserved.begin(), array.origin().reserved.end(), raw.reserved);
    std::int64_t stride = sizeof(T);
    for (int axis = array.ndim() - 1; axis >= 0; --axis) {
      raw.shape[axis] = array.dim(axis);
      raw.stride[axis] =
          axis == 0 ? array.row_stride() * static_cast<std::int64_t>(sizeof(T)) : stride;
      stride *= array.dim(axis);
    }
    arrays_.push_back(raw);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void add(const T& value, const char* name) {
    arrays_.push_back(empty(name, dtype_of<T>(), 0, &value));
  }
  void add(const std::string& text, const char* name) {
    weft_array raw = empty(name, WEFT_U8, 1, text.data());
    raw.shape[0] = static_cast<std::int64_t>(text.size());
    raw.stride[0] = 1;
    arrays_.push_back(raw);
  }
  void add(const NamedArrays& named, const char*) { add_all(named.entries); }
  void add(const Diagnostics& diag, const char*) { add_all(diag.entries()); }
  void add_all(const std::vector<NamedArray>& entries) {
    for (const NamedArray& entry : entries) add(entry);
  }
  void add(const NamedArray& entry) {
    std::visit([&](const auto& array) { this->add(array, entry.name.c_str()); }, entry.values);
  }
  static weft_array empty(const char* name, std::int32_t dtype, int ndim, const void* data) {
    weft_array raw{};
    raw.name = name;
    raw.dtype = dtype;
    raw.ndim = ndim;
    raw.data = const_cast<void*>(data);
    return raw;
  }

  InlineVector<weft_array, 24> arrays_;
  weft_record record_{};
};

}  // namespace weft
