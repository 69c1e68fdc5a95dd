// SPDX-License-Identifier: Apache-2.0
// The functions of the component, in front of the original's.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "faults.hpp"

namespace weft::faults {
namespace {

using namespace std::chrono_literals;

/// Reads the byte behind a struct that begins with its size.
template <class Sized>
void read_behind(const Sized& sized) {
  const volatile auto* bytes = reinterpret_cast<const volatile unsigned char*>(&sized);
  [[maybe_unused]] const unsigned char seen = bytes[sized.struct_size];
}

void read_host(const weft_call& call) {
  if (has("reads_past_host")) read_behind(*call.host);
  if (has("reads_past_call")) read_behind(call);
  if (has("exits")) _exit(0);
}

bool is_large(const Inputs& inputs) {
  const weft_array* pixels = find_array(inputs, "pixels");
  if (pixels != nullptr && rows(*pixels) * static_cast<std::int64_t>(row_bytes(*pixels)) > 4000000)
    return true;
  for (const char* name : {"image_px", "xy_px", "pixel_px"}) {
    const weft_array* points = find_array(inputs, name);
    if (points != nullptr && rows(*points) > 50000) return true;
  }
  return false;
}

bool has_nothing(const Inputs& inputs) {
  const weft_array* points = find_array(inputs, "image_px");
  return points != nullptr && rows(*points) == 0;
}

std::int32_t call_and_spoil(void* self, const weft_call& call, Inputs& inputs, weft_error& error) {
  Instance& instance = instance_of(self);
  PassedCall passed(call);
  PaddingIgnored changed;
  misuse_inputs(inputs, changed);
  if (has("ok_with_nothing")) return WEFT_OK;
  const std::int32_t status =
      original().process(self, &passed.call, inputs.data(), inputs.size(), &error);
  if (has("slow_to_cancel") && call.host->cancelled(&call) != 0) std::this_thread::sleep_for(3s);
  const double swayed = strength_of_sway(passed, inputs, instance);
  if (status != WEFT_OK && status != WEFT_DEGENERATE) {
    return spoil_outputs(passed, status, error);
  }
  if (swayed != 0.0) sway(passed.outputs, swayed);
  distort_geometry(passed.outputs, inputs);
  disturb_process("process");
  return spoil_outputs(passed, status, error);
}

/// Fails where the process may have no more than 20 GB.
std::int32_t take_much_memory(weft_error& error) {
  void* volatile memory = std::malloc(std::size_t{20} << 30);
  std::free(memory);
  if (memory != nullptr) return WEFT_OK;
  error.code = WEFT_CODE_NO_MEMORY;
  return refuse(error, "there is not enough memory");
}

}  // namespace

std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  if (has("prepare_crashes")) write_where_nothing_is();
  if (has("prepare_exits")) std::exit(0);
  if (has("prepare_status")) return -5;
  read_host(*call);
  Instance& instance = instance_of(self);
  if (has("crashes_prepared_twice") && instance.is_prepared) std::abort();
  instance.is_prepared = true;
  disturb_process("prepare");
  return original().prepare(self, call, inputs, count, error);
}

std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error) {
  if (call->frame == 1) {
    if (const std::int32_t status = end_in_frame_1(*error); status != WEFT_OK) return status;
  } else if (is_mode_changed()) {
    return refuse(*error, "a fault of another call still changes how numbers are computed");
  }
  read_host(*call);
  if (has("answers_all_methods") && call->method > 1) return WEFT_OK;
  Inputs passed(inputs, inputs + count);
  misuse_host(*call, passed, inputs);
  if (has("crashes_with_nothing") && has_nothing(passed)) std::abort();
  if (has("hangs_on_large_input") && is_large(passed)) sleep_for_ever();
  if (has("deaf") && is_large(passed)) std::this_thread::sleep_for(3s);
  if (has("needs_much_memory") && is_large(passed)) {
    if (const std::int32_t status = take_much_memory(*error); status != WEFT_OK) return status;
  }
  return call_and_spoil(self, *call, passed, *error);
}

void destroy(void* self) {
  const Instance& instance = instance_of(self);
  if (has("destroy_crashes")) write_where_nothing_is();
  if (has("destroy_exits")) std::exit(0);
  disturb_process("destroy");
  if (has("crashes_unprepared") && !instance.is_prepared) std::abort();
  if (has("reads_input_afterwards") && instance.kept_input != nullptr) {
    [[maybe_unused]] const unsigned char seen = *instance.kept_input;
  }
  forget_instance(self);
  original().destroy(self);
}

}  // namespace weft::faults
