// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <weft/core/index.hpp>

#include "host/records/record.hpp"
#include "kit/conformance/probes/passages.hpp"

namespace weft::conformance {
namespace {

constexpr int kBetween = 0xAB;        ///< value of the padding between rows
constexpr std::int64_t kPadding = 3;  ///< [elements] between rows
constexpr std::size_t kAlignment = 64;

/// Inputs laid out anew, alive as long as this.
class Copies {
 public:
  Copies(std::span<const weft_record> inputs, Lie lie) : records_(inputs.begin(), inputs.end()) {
    for (weft_record& record : records_) {
      auto& arrays = arrays_.emplace_back(record.arrays, record.arrays + record.count);
      for (weft_array& array : arrays) {
        if (array.memory != WEFT_DEVICE) lay(array, lie);
      }
      record.arrays = arrays.data();
    }
  }
  std::span<const weft_record> records() const { return records_; }

 private:
  void lay(weft_array& array, Lie lie) {
    const std::int64_t bytes = host::array_bytes(array.dtype, array.ndim, array.shape);
    const std::int64_t rows = array.ndim > 0 ? array.shape[0] : 1;
    if (bytes <= 0 || rows <= 0) return;
    std::int64_t elements = 1;
    for (int i = 0; i < array.ndim; ++i) elements *= array.shape[i];
    const std::int64_t element = bytes / elements, row = bytes / rows;
    const bool strides = array.ndim > 1 && lie != Lie::aligned;
    const std::int64_t step = row + (strides && lie == Lie::padded ? kPadding * element : 0);
    auto& memory = memory_.emplace_back(to_index(rows * step) + 2 * kAlignment);
    std::memset(memory.data(), kBetween, memory.size());
    const auto start = reinterpret_cast<std::uintptr_t>(memory.data());
    const std::size_t to_line = (kAlignment - start % kAlignment) % kAlignment;
    std::byte* const first = memory.data() + to_line + element;  // aligned to its element, no more
    const auto* from = static_cast<const std::byte*>(array.data);
    for (std::int64_t i = 0; i < rows; ++i) {
      const std::int64_t place = strides && lie == Lie::backwards ? rows - 1 - i : i;
      const std::int64_t source = array.ndim > 0 ? i * array.stride[0] : 0;
      std::memcpy(first + place * step, from + source, to_index(row));
    }
    array.data = first;
    if (!strides) {
      if (array.ndim > 0) array.stride[0] = row;
      return;
    }
    array.stride[0] = lie == Lie::backwards ? -step : step;
    if (lie == Lie::backwards) array.data = first + (rows - 1) * step;
  }

  std::vector<weft_record> records_;
  std::vector<std::vector<weft_array>> arrays_;
  std::deque<std::vector<std::byte>> memory_;
};

weft_array unknown_array(double* numbers) {
  const std::int64_t shape[] = {3};
  return host::array_at("x.later.numbers", WEFT_F64, 1, shape, numbers, WEFT_HOST);
}

}  // namespace

std::int32_t LaidOut::prepare(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  const Copies copies(inputs, lie_);
  return Passage::prepare(component, self, call, copies.records(), error);
}

std::int32_t LaidOut::process(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  const Copies copies(inputs, lie_);
  return Passage::process(component, self, call, copies.records(), error);
}

std::int32_t Unknown::process(const weft_component& component, void* self, const weft_call& call,
                              std::span<const weft_record> inputs, weft_error* error) {
  double numbers[] = {1.0, -2.0, 1e300};
  std::vector<weft_record> records(inputs.begin(), inputs.end());
  std::deque<std::vector<weft_array>> arrays;
  if (what_ == What::arrays) {
    for (weft_record& record : records) {
      auto& more = arrays.emplace_back(record.arrays, record.arrays + record.count);
      more.insert(more.begin(), unknown_array(numbers));
      record.arrays = more.data();
      record.count = more.size();
    }
  } else {
    const auto& more = arrays.emplace_back(1, unknown_array(numbers));
    weft_record record{};
    record.slot = "x.later.slot";
    record.type = "x.later.record/1";
    record.count = 1;
    record.arrays = more.data();
    record.frame = WEFT_NO_FRAME;
    records.insert(records.begin(), record);
  }
  return Passage::process(component, self, call, records, error);
}

}  // namespace weft::conformance
