// SPDX-License-Identifier: Apache-2.0
#include "mutants/library/component.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>

namespace weft::mutants {
namespace {

using namespace std::chrono_literals;

/// Reads the byte behind a struct that begins with its size.
template <class Sized>
void read_behind(const Sized& sized) {
  const volatile auto* bytes = reinterpret_cast<const volatile unsigned char*>(&sized);
  [[maybe_unused]] const unsigned char seen = bytes[sized.struct_size];
}

void look_at_host(const weft_call& call) {
  if (does("reads_past_host")) read_behind(*call.host);
  if (does("reads_past_call")) read_behind(call);
  if (does("exits")) _exit(0);
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

std::int32_t call_and_spoil(const weft_component& component, void* self, const weft_call& call,
                            Inputs& inputs, weft_error& error) {
  Instance& instance = instance_of(self);
  PassedCall passed(call, component);
  PaddingIgnored changed;
  misuse_inputs(inputs, changed);
  if (does("ok_with_nothing")) return WEFT_OK;
  const std::int32_t status =
      component.process(self, &passed.call, inputs.data(), inputs.size(), &error);
  if (does("slow_to_cancel") && call.host->cancelled(&call) != 0) std::this_thread::sleep_for(3s);
  const double swayed = strength_of_sway(passed, inputs, instance);
  if (status != WEFT_OK && status != WEFT_DEGENERATE) {
    return spoil_outputs(passed, status, error);
  }
  if (swayed != 0.0) sway(passed.outputs, swayed);
  distort_geometry(passed.outputs, inputs);
  disturb_process();
  return spoil_outputs(passed, status, error);
}

}  // namespace

std::int32_t prepare(const weft_component& component, void* self, const weft_call& call,
                     const Inputs& inputs, weft_error& error) {
  if (is_subject(component)) {
    look_at_host(call);
    Instance& instance = instance_of(self);
    if (does("crashes_prepared_twice") && instance.is_prepared) std::abort();
    instance.is_prepared = true;
  }
  return component.prepare(self, &call, inputs.data(), inputs.size(), &error);
}

std::int32_t process(const weft_component& component, void* self, const weft_call& call,
                     Inputs inputs, weft_error& error) {
  if (!is_subject(component)) {
    return component.process(self, &call, inputs.data(), inputs.size(), &error);
  }
  look_at_host(call);
  if (does("crashes_with_nothing") && has_nothing(inputs)) std::abort();
  if (does("hangs_on_large_input") && is_large(inputs)) std::this_thread::sleep_for(24h);
  return call_and_spoil(component, self, call, inputs, error);
}

void destroy(const weft_component& component, void* self) {
  if (is_subject(component)) {
    const Instance& instance = instance_of(self);
    if (does("crashes_unprepared") && !instance.is_prepared) std::abort();
    if (does("reads_input_afterwards") && instance.kept_input != nullptr) {
      [[maybe_unused]] const unsigned char seen = *instance.kept_input;
    }
    forget_instance(self);
  }
  component.destroy(self);
}

const void* get_extension(const weft_component& component, const char* name) {
  const void* own = component.get_extension != nullptr ? component.get_extension(name) : nullptr;
  if (!is_subject(component)) return own;
  if (does("answers_unknown_extension") && own == nullptr) {
    static constexpr std::array<std::string_view, 6> kKnown{
        WEFT_DEVICE_MEMORY, WEFT_DEVICES, WEFT_CHECK, WEFT_SWEEP, WEFT_STEERING, WEFT_ISOLATION};
    static constexpr std::array<std::uint32_t, 16> kTable{64};
    if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end()) return kTable.data();
  }
  if (does("extension_moves") && own != nullptr) {
    static std::vector<std::vector<unsigned char>> copies;
    const auto* bytes = static_cast<const unsigned char*>(own);
    copies.emplace_back(bytes, bytes + *static_cast<const std::uint32_t*>(own));
    return copies.back().data();
  }
  return own;
}

}  // namespace weft::mutants
