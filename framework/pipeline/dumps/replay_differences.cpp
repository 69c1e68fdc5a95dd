// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <sstream>
#include <weft/core/index.hpp>
#include <weft/data/array.hpp>

#include "pipeline/dumps/replay.hpp"

namespace weft {
namespace {

using host::RecordPtr;

std::string shape_of(const weft_array& array) {
  std::string text = "[";
  for (int axis = 0; axis < array.ndim; ++axis) {
    text += (axis > 0 ? ", " : "") + std::to_string(array.shape[axis]);
  }
  return text + "]";
}

double number_at(const weft_array& array, std::int64_t index) {
  const auto read = [&]<class T>(T) {
    return static_cast<double>(static_cast<const T*>(array.data)[index]);
  };
  switch (array.dtype) {
    case WEFT_U8:
      return read(std::uint8_t{});
    case WEFT_I8:
      return read(std::int8_t{});
    case WEFT_U16:
      return read(std::uint16_t{});
    case WEFT_I16:
      return read(std::int16_t{});
    case WEFT_I32:
      return read(std::int32_t{});
    case WEFT_I64:
      return read(std::int64_t{});
    case WEFT_F32:
      return read(float{});
    default:
      return read(double{});
  }
}

/// Differences between two arrays of host records, which are contiguous; empty when there are none.
std::string difference(const weft_array& before, const weft_array& after) {
  if (before.dtype != after.dtype) return "has another type";
  if (before.ndim != after.ndim ||
      !std::equal(before.shape, before.shape + before.ndim, after.shape)) {
    return "has the shape " + shape_of(after) + " instead of " + shape_of(before);
  }
  const std::int64_t size = dtype_size(before.dtype);
  if (size == 0) return "has an unknown type";
  const std::int64_t count = host::array_bytes(before.dtype, before.ndim, before.shape) / size;
  std::int64_t different = 0;
  double largest = 0.0;
  for (std::int64_t i = 0; i < count; ++i) {
    const auto* a = static_cast<const char*>(before.data) + i * size;
    const auto* b = static_cast<const char*>(after.data) + i * size;
    if (std::memcmp(a, b, to_index(size)) == 0) continue;
    ++different;
    const double by = std::abs(number_at(after, i) - number_at(before, i));
    largest = std::isnan(by) || std::isnan(largest) ? NAN : std::max(largest, by);
  }
  if (different == 0) return {};
  std::ostringstream text;
  text.precision(3);
  text << different << " of " << count << (count == 1 ? " value differs" : " values differ");
  if (std::isnan(largest)) {
    text << ", some between a number and none";
  } else {
    text << ", by at most " << largest;
  }
  return text.str();
}

void compare(const std::string& slot, const RecordPtr& before, const RecordPtr& after,
             std::vector<std::string>& found) {
  const std::string name = "out." + slot;
  if (after == nullptr) return found.push_back(name + ": is missing");
  if (before == nullptr) return found.push_back(name + ": is new");
  const weft_record old_view = before->view(""), new_view = after->view("");
  for (std::uint64_t i = 0; i < old_view.count; ++i) {
    const std::string array = old_view.arrays[i].name;
    const weft_array* now = find_array(new_view, array.c_str());
    const std::string what = now == nullptr ? "is missing" : difference(old_view.arrays[i], *now);
    if (!what.empty()) found.push_back(name + "/" + array + ": " + what);
  }
  for (std::uint64_t i = 0; i < new_view.count; ++i) {
    const char* array = new_view.arrays[i].name;
    if (find_array(old_view, array) == nullptr) found.push_back(name + "/" + array + ": is new");
  }
}

std::string status_text(const host::Outcome& outcome) {
  constexpr const char* kNames[] = {"ok", "degenerate", "no_result", "error", "cancelled", "end"};
  const std::string name = kNames[static_cast<int>(outcome.status)];
  return outcome.status == WEFT_OK ? name : name + " (" + outcome.error.message + ")";
}

}  // namespace

std::vector<std::string> differences(const host::Outcome& before, const host::Outcome& after) {
  std::vector<std::string> found;
  if (status_text(before) != status_text(after)) {
    found.push_back("status: " + status_text(after) + " instead of " + status_text(before));
  }
  std::set<std::string> slots;
  for (const host::Outcome* outcome : {&before, &after}) {
    for (const auto& [slot, record] : outcome->outputs) slots.insert(slot);
  }
  for (const std::string& slot : slots) compare(slot, before.find(slot), after.find(slot), found);
  return found;
}

}  // namespace weft
