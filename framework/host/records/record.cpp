// SPDX-License-Identifier: Apache-2.0
#include "host/records/record.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <weft/core/index.hpp>

namespace weft::host {
namespace {

constexpr std::int64_t kLargestArray = std::int64_t{1} << 40;  // bytes

/// True if a name is legal in files and reports.
bool is_legal_name(std::string_view name) {
  const auto legal = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  return !name.empty() && name.size() <= Name::kLongest &&
         std::all_of(name.begin(), name.end(), legal);
}

/// The catalogue's own text for a type; null where it has no such type.
const char* catalogue_type(std::string_view type) {
  const char* found = nullptr;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    if (type == RecordType::kType) found = RecordType::kType;
  });
  return found;
}

/// The error of third-party arrays, in words, or an empty text. Their content is arbitrary, but
/// they must be readable and have a name that the catalogue will never use.
std::string illegal_vendor_array(const weft_record& record) {
  for (const weft_array* array = record.arrays; array != record.arrays + record.count; ++array) {
    if (!std::string_view(array->name).starts_with("x.")) continue;
    const std::string layout = ShapePattern::check_layout(*array);
    if (is_vendor_name(array->name) && layout.empty()) continue;
    return std::string(record.type) + ": array '" + array->name + "' " +
           (layout.empty() ? "must be called x.vendor.name" : layout);
  }
  return {};
}

/// Visits the fields of a record struct and finds numbers that are not finite, and arrays that are
/// in device memory and no fields.
class ContentCheck {
 public:
  explicit ContentCheck(const weft_record& record) : record_(record) {}

  template <class Member>
  void operator()(const Member&, const Field& field) {
    const weft_array* array = find_array(record_, field.name);
    if (array == nullptr || !problem_.empty()) return;
    if (array->memory == WEFT_DEVICE) {
      ++on_device_;  // their numbers are looked at when they are fetched
      return;
    }
    if (field.may_be_nan) return;
    if (!is_finite(*array)) {
      problem_ = std::string(record_.type) + ": array '" + field.name + "' holds NaN or infinity";
    }
  }
  /// Once all fields have been visited.
  std::string problem() const {
    const auto is_remote = [](const weft_array& array) { return array.memory == WEFT_DEVICE; };
    const auto* end = record_.arrays + record_.count;
    if (problem_.empty() && std::count_if(record_.arrays, end, is_remote) != on_device_) {
      return std::string(record_.type) +
             ": an array that is not in the catalogue lies in device "
             "memory";
    }
    return problem_;
  }

 private:
  const weft_record& record_;
  std::string problem_;
  std::int64_t on_device_ = 0;
};

template <class T>
bool all_finite(const weft_array& array) {
  if (array.ndim == 0) return std::isfinite(*static_cast<const T*>(array.data));
  const Array<T> values = detail::borrow_array<T>(array);
  for (std::int64_t i = 0; i < values.rows(); ++i) {
    const T* row = values.row(i);
    for (std::int64_t j = 0; j < values.row_elements(); ++j) {
      if (!std::isfinite(row[j])) return false;
    }
  }
  return true;
}

}  // namespace

bool is_finite(const weft_array& array) {
  if (array.dtype == WEFT_F64) return all_finite<double>(array);
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
    : type_(catalogue_type(type)),
      pool_(std::move(pool)),
      arena_(std::move(arena)),
      entries_(pool_),
      arrays_(pool_) {
  if (type_ != nullptr) return;
  own_type_ = type;
  type_ = own_type_.c_str();
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
  arrays_[index] = array_at(entries_[index].name.c_str(), dtype, ndim, shape, contents.get(), kind);
  if (kind == WEFT_DEVICE) std::swap(arrays_[index].data, arrays_[index].owner);
  entries_[index].memory = std::move(contents);
  return arrays_[index];
}

weft_record Record::view(const char* slot) const {
  return {slot, type_, revision_, producer_, arrays_.size(), arrays_.data(), frame_, 0, 0, {}};
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
  auto same = make(type_, pool_);
  for (const Entry& entry : entries_) same->share(*this, entry.name);
  same->revision_ = revision_;
  same->producer_ = producer_;
  same->frame_ = frame_;
  return same;
}

Result<RecordPtr> Record::in_host_memory() const {
  auto here = make(type_, pool_);
  for (std::size_t i = 0; i < arrays_.size(); ++i) {
    here->share(*this, entries_[i].name);
    const weft_array& array = arrays_[i];
    if (array.memory != WEFT_DEVICE) continue;
    auto copy = DeviceArray::of(array)->copy();
    if (!copy) return copy.error();
    here->place(array.name, array.dtype, array.ndim, array.shape, std::move(copy->memory),
                static_cast<weft_memory>(copy->array.memory));
  }
  here->revision_ = revision_;
  here->producer_ = producer_;
  here->frame_ = frame_;
  return RecordPtr(std::move(here));
}

Result<void> validate(const weft_record& record) {
  Result<void> status;
  bool is_known = false;
  for_each_record_type([&]<class RecordType>(std::type_identity<RecordType>) {
    if (std::string_view(record.type) != RecordType::kType) return;
    is_known = true;
    const RecordType fields{};
    detail::FieldCheck layout(record);
    RecordType::fields(fields, layout);
    if (!layout.error().empty()) {
      status = Error{Errc::invalid_data, layout.error()};
      return;
    }
    ContentCheck content(record);
    RecordType::fields(fields, content);
    std::string problem = content.problem();
    if (problem.empty()) problem = illegal_vendor_array(record);
    if (!problem.empty()) status = Error{Errc::invalid_data, problem};
  });
  if (is_known) return status;
  return Error{Errc::invalid_data, std::string("unknown record type ") + record.type};
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
