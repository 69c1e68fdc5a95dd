// SPDX-License-Identifier: Apache-2.0
#include "host/records/record.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <weft/core/index.hpp>

namespace weft::host {
namespace {

constexpr std::int64_t kLargestArray = std::int64_t{1} << 40;  // bytes

template <class T>
bool all_finite(const weft_array& array) {
  const auto is_number = [](T value) { return std::isfinite(static_cast<double>(value)); };
  if (array.ndim == 0) return is_number(*static_cast<const T*>(array.data));
  const Array<T> values = detail::borrow_array<T>(array);
  for (std::int64_t i = 0; i < values.rows(); ++i) {
    const T* row = values.row(i);
    for (std::int64_t j = 0; j < values.row_elements(); ++j) {
      if (!is_number(row[j])) return false;
    }
  }
  return true;
}

}  // namespace

bool is_legal_name(std::string_view name) {
  const auto legal = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  return !name.empty() && name.size() <= Name::kLongest &&
         std::all_of(name.begin(), name.end(), legal);
}

bool is_finite(const weft_array& array) {
  if (array.dtype == WEFT_F64) return all_finite<double>(array);
  if (array.dtype == WEFT_F16) return all_finite<Float16>(array);
  return array.dtype != WEFT_F32 || all_finite<float>(array);
}

weft_array array_at(const char* name, std::int32_t dtype, std::int32_t ndim,
                    const std::int64_t* shape, void* data, weft_memory kind) {
  weft_array array{};
  array.name = name;
  array.dtype = dtype;
  array.ndim = ndim;
  array.data = data;
  array.memory = kind;
  std::int64_t stride = dtype_size(dtype);
  for (int axis = ndim - 1; axis >= 0; --axis) {
    array.shape[axis] = shape[axis];
    array.stride[axis] = stride;
    stride *= shape[axis];
  }
  return array;
}

std::int64_t array_bytes(std::int32_t dtype, std::int32_t ndim, const std::int64_t* shape) {
  std::int64_t bytes = dtype_size(dtype);
  if (bytes == 0 || ndim < 0 || ndim > WEFT_MAX_DIMENSIONS) return -1;
  if (ndim > 0 && shape == nullptr) return -1;
  bool empty = false;
  for (int axis = 0; axis < ndim; ++axis) {
    // An axis of length 0 does not excuse the others: strides must not overflow either.
    const std::int64_t length = std::max<std::int64_t>(shape[axis], 1);
    if (shape[axis] < 0 || bytes > kLargestArray / length) return -1;
    bytes *= length;
    empty = empty || shape[axis] == 0;
  }
  return empty ? 0 : bytes;
}

Record::Record(std::string_view type, std::shared_ptr<SharedArena> arena,
               std::shared_ptr<MemoryPool> pool)
    : schema_(catalogue_schema(type)),
      pool_(std::move(pool)),
      arena_(std::move(arena)),
      entries_(pool_),
      arrays_(pool_),
      replaced_(pool_) {
  if (schema_ == nullptr) own_type_ = type;
}

std::size_t Record::slot_of(std::string_view name) {
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    if (entries_[i].name == name) return i;
  }
  if (entries_.size() == entries_.capacity()) {
    constexpr std::size_t kUsual = 16;
    entries_.reserve(std::max(kUsual, 2 * entries_.size()));
    arrays_.reserve(entries_.capacity());
    for (std::size_t i = 0; i < arrays_.size(); ++i) arrays_[i].name = entries_[i].name.c_str();
  }
  entries_.push_back({name, nullptr});
  arrays_.emplace_back();
  return arrays_.size() - 1;
}

void* Record::allocate(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                       const std::int64_t* shape) {
  const std::int64_t bytes = array_bytes(dtype, ndim, shape);
  if (bytes < 0 || !is_legal_name(name)) return nullptr;
  std::shared_ptr<void> memory = arena_ != nullptr ? arena_->allocate(to_index(bytes) + 64)
                                                   : own_memory(to_index(bytes), pool_);
  if (memory == nullptr) return nullptr;
  void* data = memory.get();
  place(name, dtype, ndim, shape, std::move(memory), arena_ != nullptr ? WEFT_SHARED : WEFT_HOST);
  return data;
}

bool Record::adopt(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                   const std::int64_t* shape, std::shared_ptr<void> contents) {
  if (array_bytes(dtype, ndim, shape) < 0 || !is_legal_name(name)) return false;
  place(name, dtype, ndim, shape, std::move(contents), WEFT_SHARED);
  return true;
}

bool Record::adopt(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                   const std::int64_t* shape, const weft_device_memory& library,
                   std::uint64_t handle, const std::string& maker) {
  if (array_bytes(dtype, ndim, shape) < 0 || !is_legal_name(name) || handle == 0) return false;
  const Name text(name);
  weft_array array = array_at(text.c_str(), dtype, ndim, shape, nullptr, WEFT_DEVICE);
  array.handle = handle;
  auto kept = std::allocate_shared<DeviceArray>(PoolAllocator<DeviceArray>(pool_), maker, array,
                                                library, arena_, pool_);
  place(name, dtype, ndim, shape, std::move(kept), WEFT_DEVICE).handle = handle;
  return true;
}

weft_array& Record::place(std::string_view name, std::int32_t dtype, std::int32_t ndim,
                          const std::int64_t* shape, std::shared_ptr<void> contents,
                          weft_memory kind) {
  const std::size_t index = slot_of(name);
  if (entries_[index].memory != nullptr) {
    const weft_array& old = arrays_[index];
    if (old.memory != WEFT_DEVICE) replaced_bytes_ += array_bytes(old.dtype, old.ndim, old.shape);
    replaced_.push_back(std::move(entries_[index].memory));
  }
  arrays_[index] = array_at(entries_[index].name.c_str(), dtype, ndim, shape, contents.get(), kind);
  if (kind == WEFT_DEVICE) std::swap(arrays_[index].data, arrays_[index].owner);
  entries_[index].memory = std::move(contents);
  return arrays_[index];
}

weft_record Record::view(const char* slot) const {
  weft_record record{};
  record.slot = slot;
  record.type = type().data();
  record.revision = revision_;
  record.producer = producer_;
  record.count = arrays_.size();
  record.arrays = arrays_.data();
  record.frame = frame_;
  return record;
}

void Record::share(const Record& other, std::string_view name) {
  for (std::size_t i = 0; i < other.arrays_.size(); ++i) {
    if (other.entries_[i].name != name) continue;
    const std::size_t index = slot_of(name);
    entries_[index].memory = other.entries_[i].memory;
    arrays_[index] = other.arrays_[i];
    arrays_[index].name = entries_[index].name.c_str();
  }
}

std::shared_ptr<const Record> Record::alias() const {
  auto same = make(type(), pool_);
  for (const Entry& entry : entries_) same->share(*this, entry.name);
  same->revision_ = revision_;
  same->producer_ = producer_;
  same->frame_ = frame_;
  return same;
}

Result<RecordPtr> Record::in_host_memory() const {
  auto here = make(type(), pool_);
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    here->share(*this, entries_[i].name);
    const weft_array& array = arrays_[i];
    if (array.memory != WEFT_DEVICE) continue;
    auto copy = DeviceArray::of(array)->copy();
    if (!copy) return copy.error();
    here->place(array.name, array.dtype, array.ndim, array.shape, std::move(copy->memory),
                static_cast<weft_memory>(copy->array.memory));
  }
  here->forget_replaced();
  here->revision_ = revision_;
  here->producer_ = producer_;
  here->frame_ = frame_;
  return RecordPtr(std::move(here));
}

Result<void> check_lengths(const weft_record& output, std::span<const weft_record> inputs) {
  struct Rule {
    const char *type, *array, *slot, *input_array;
  };
  static constexpr Rule kRules[] = {
      {InlierMask::kType, "kept", "correspondences", "kept"},
      {WarpSamples::kType, "xy_px", "points", "xy_px"},
      {Shape::kType, "vertices_m", "template", "vertices_m"},
      {Visibility::kType, "visible", "template", "vertices_m"},
  };
  for (const Rule& rule : kRules) {
    if (std::string_view(output.type) != rule.type) continue;
    const weft_array* made = find_array(output, rule.array);
    for (const weft_record& input : inputs) {
      if (std::string_view(input.slot) != rule.slot) continue;
      const weft_array* given = find_array(input, rule.input_array);
      if (made == nullptr || given == nullptr || made->shape[0] == given->shape[0]) continue;
      return Error{Errc::invalid_data, std::string(output.type) + " has " +
                                           std::to_string(made->shape[0]) + " entries for " +
                                           std::to_string(given->shape[0]) + " of the input '" +
                                           rule.slot + "'"};
    }
  }
  return {};
}

}  // namespace weft::host
