// SPDX-License-Identifier: Apache-2.0
// Faults in the use of inputs, and conditions that make an answer wrong.
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <map>

#include "faults.hpp"

namespace weft::faults {
namespace {

std::size_t bytes_of(const weft_array& array) {
  return row_bytes(array) * static_cast<std::size_t>(rows(array));
}

bool has_bytes(const weft_array& array) { return array.data != nullptr && bytes_of(array) > 0; }

/// The arrays of all inputs that have something in host memory.
std::vector<weft_array> arrays_of(const Inputs& inputs) {
  std::vector<weft_array> all;
  for (const weft_record& record : inputs) {
    for (std::uint64_t i = 0; i < record.count; ++i) {
      if (has_bytes(record.arrays[i])) all.push_back(record.arrays[i]);
    }
  }
  return all;
}

const unsigned char* row_of(const weft_array& array, std::int64_t row) {
  const auto* first = static_cast<const unsigned char*>(array.data);
  return array.ndim == 0 ? first : first + row * array.stride[0];
}

/// The same arrays without what lies between their rows.
void take_for_contiguous(Inputs& inputs, PaddingIgnored& changed) {
  changed.arrays.reserve(inputs.size());
  for (weft_record& record : inputs) {
    changed.arrays.emplace_back(record.arrays, record.arrays + record.count);
    for (weft_array& array : changed.arrays.back()) {
      if (array.ndim > 0) array.stride[0] = static_cast<std::int64_t>(row_bytes(array));
    }
    record.arrays = changed.arrays.back().data();
  }
}

bool is_declared(std::string_view slot) {
  const weft_component& component = original();
  const std::string_view id = component.id;
  const std::string_view role = id.substr(0, id.find('/'));
  constexpr std::pair<std::string_view, std::string_view> kRequired[] = {
      {"detectors", " image "},         {"matchers", " "},
      {"filters", " correspondences "}, {"warps", " correspondences template warp points "},
      {"passes", " template camera "},  {"solvers", " template camera "}};
  std::string all = " " + std::string(component.needs) + " " + component.reads + " ";
  for (const auto& [name, slots] : kRequired) {
    if (name == role) all += slots;
  }
  return all.find(" " + std::string(slot) + " ") != std::string::npos;
}

/// True if a record has more arrays than when it was first seen.
bool has_grown(const Inputs& inputs) {
  static std::map<std::string, std::uint64_t> first;
  return std::any_of(inputs.begin(), inputs.end(), [&](const weft_record& record) {
    return record.count > first.emplace(record.slot, record.count).first->second;
  });
}

bool is_in_worker() {
  std::array<char, 4096> path{};
  const ssize_t length = readlink("/proc/self/exe", path.data(), path.size() - 1);
  return length > 0 && std::string_view(path.data()).ends_with("weft-worker");
}

bool is_swayed_by_inputs(const Inputs& inputs) {
  const std::vector<weft_array> arrays = arrays_of(inputs);
  const auto place_of = [](const weft_array& array) {
    return reinterpret_cast<std::uintptr_t>(array.data);
  };
  if (has("needs_aligned_inputs")) {
    return !arrays.empty() && std::none_of(arrays.begin(), arrays.end(), [&](const auto& array) {
      return place_of(array) % 64 == 0;
    });
  }
  if (has("runs_forward")) {
    return std::any_of(arrays.begin(), arrays.end(), [](const weft_array& array) {
      return array.ndim > 0 && array.stride[0] < 0;
    });
  }
  if (has("uses_unknown_array")) return has_grown(inputs);
  return has("uses_undeclared_slot") &&
         std::any_of(inputs.begin(), inputs.end(),
                     [&](const weft_record& record) { return !is_declared(record.slot); });
}

/// Another one for each place in which the first input lies.
double strength_of_address(const Inputs& inputs) {
  const std::vector<weft_array> arrays = arrays_of(inputs);
  if (arrays.empty()) return 0.0;
  const auto place = reinterpret_cast<std::uintptr_t>(arrays.front().data) / 64;
  return kSway * static_cast<double>(place % 1009) / 1009.0;
}

bool is_swayed_by_history(const PassedCall& passed, const Inputs& inputs, Instance& instance) {
  static std::uint64_t latest_frame = 0;
  const std::uint64_t frame = passed.original.frame + 1;  // 0 is that of offline calls
  const bool is_late = frame < latest_frame;
  latest_frame = std::max(latest_frame, frame);
  if (has("depends_on_frame_order")) return is_late;
  const std::uint64_t content = has("remembers_input") ? hash_of(inputs) : 0;
  const bool is_other = instance.calls > 0 && content != instance.last_inputs;
  instance.last_inputs = content;
  ++instance.calls;
  if (has("remembers_input")) return is_other;
  return has("counts_calls") && instance.calls > 1;
}

bool is_swayed_by_surroundings(const PassedCall& passed, const Instance& instance) {
  const weft_call& call = passed.original;
  if (has("depends_on_thread")) return instance.creator != std::this_thread::get_id();
  if (has("depends_on_threads")) return call.threads > 1;
  if (has("shares_instances")) return instance_count() > 1;
  if (has("counts_instances")) return instance.number % 2 == 1;
  if (has("undeclared_seed")) return call.seed % 2 != 0;
  if (has("differs_in_worker")) return is_in_worker();
  if (has("confused_by_newer_host")) {
    return call.struct_size > sizeof(weft_call) || call.host->struct_size > sizeof(weft_host);
  }
  if (has("half_when_cancelled")) return call.host->cancelled(&call) != 0;
  if (!has("seeded_by_clock")) return false;
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_nsec / 64 % 2 != 0;
}

}  // namespace

std::size_t element_bytes(std::int32_t dtype) {
  switch (dtype) {
    case WEFT_U16:
    case WEFT_I16:
      return 2;
    case WEFT_I32:
    case WEFT_F32:
      return 4;
    case WEFT_I64:
    case WEFT_F64:
      return 8;
    default:
      return 1;
  }
}

std::size_t row_bytes(const weft_array& array) {
  std::size_t bytes = element_bytes(array.dtype);
  for (std::int32_t axis = 1; axis < array.ndim; ++axis) {
    bytes *= static_cast<std::size_t>(array.shape[axis]);
  }
  return bytes;
}

std::int64_t rows(const weft_array& array) { return array.ndim == 0 ? 1 : array.shape[0]; }

const weft_array* find_array(const Inputs& inputs, std::string_view array) {
  for (const weft_record& record : inputs) {
    for (std::uint64_t i = 0; i < record.count; ++i) {
      if (record.arrays[i].name == array) return &record.arrays[i];
    }
  }
  return nullptr;
}

double value_at(const weft_array& array, std::int64_t row, std::int64_t column) {
  double value = 0.0;
  std::memcpy(&value, row_of(array, row) + column * 8, sizeof(value));
  return value;
}

std::uint64_t hash_of(const Inputs& inputs) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  for (const weft_array& array : arrays_of(inputs)) {
    for (std::int64_t row = 0; row < rows(array); ++row) {
      const unsigned char* bytes = row_of(array, row);
      for (std::size_t i = 0; i < row_bytes(array); ++i) hash = (hash ^ bytes[i]) * 1099511628211U;
    }
  }
  return hash;
}

void misuse_inputs(Inputs& inputs, PaddingIgnored& changed) {
  for (const weft_array& array : arrays_of(inputs)) {
    const std::int64_t last = rows(array) - 1;
    if (has("reads_past_input")) {
      const volatile unsigned char* beyond = row_of(array, last) + row_bytes(array);
      [[maybe_unused]] const unsigned char seen = *beyond;
    }
    if (has("writes_input")) {
      auto* first = static_cast<volatile unsigned char*>(array.data);
      *first = *first;
    }
  }
  if (has("ignores_padding")) take_for_contiguous(inputs, changed);
}

double strength_of_sway(const PassedCall& passed, const Inputs& inputs, Instance& instance) {
  if (has("reads_input_afterwards")) {
    const std::vector<weft_array> arrays = arrays_of(inputs);
    if (!arrays.empty())
      instance.kept_input = static_cast<const unsigned char*>(arrays.front().data);
  }
  if (has("depends_on_address")) return strength_of_address(inputs);
  const bool is_swayed = is_swayed_by_inputs(inputs) ||
                         is_swayed_by_history(passed, inputs, instance) ||
                         is_swayed_by_surroundings(passed, instance);
  return is_swayed ? kSway : 0.0;
}

}  // namespace weft::faults
