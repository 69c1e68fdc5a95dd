// SPDX-License-Identifier: Apache-2.0
// A library that makes one fault, chosen by the environment when it is loaded.
#pragma once

#include <weft/abi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

namespace weft::faults {

/// True if WEFT_FAULT names this fault, as "fault" or "fault@place".
bool has(std::string_view fault);

/// True if WEFT_FAULT names this place, or none and the place is "process".
bool is_place(std::string_view place);

/// The component that is called unless a fault is made: the only one of the library that
/// WEFT_FAULT_PLUGIN names, else plain_filter().
const weft_component& original();

/// A filter without a fault: it has two numbers and a choice, which change its evidence.
const weft_component& plain_filter();

/// The state of one instance.
struct Instance {
  bool is_prepared = false;
  int number = 0;  ///< index among the instances of this process, from 0
  int calls = 0;
  std::uint64_t last_inputs = 0;  ///< a hash of their contents
  std::thread::id creator;
  const volatile unsigned char* kept_input = nullptr;
};
/// The state for an instance that the original's create() returned; made on first use.
Instance& instance_of(void* self);
void forget_instance(void* self);
std::size_t instance_count();

/// An array that the component has allocated in this call.
struct Output {
  std::string slot, type, array;
  std::int32_t dtype;
  std::vector<std::int64_t> shape;
  unsigned char* data;
  std::vector<unsigned char> before;  ///< its content after allocation, where that matters

  std::size_t bytes() const;
  std::size_t row_bytes() const;
};

/// A call as the original sees it: it begins with a weft_call, whose host is this library.
struct PassedCall {
  explicit PassedCall(const weft_call& original);
  PassedCall(const PassedCall&) = delete;
  PassedCall& operator=(const PassedCall&) = delete;

  weft_call call;
  const weft_call& original;
  weft_host host;
  std::vector<Output> outputs;
  std::vector<std::vector<unsigned char>> replacements;  ///< for arrays that the host refused
};

using Inputs = std::vector<weft_record>;

std::size_t element_bytes(std::int32_t dtype);
std::size_t row_bytes(const weft_array& array);  ///< one step along axis 0, without padding
std::int64_t rows(const weft_array& array);
const weft_array* find_array(const Inputs& inputs, std::string_view array);
double value_at(const weft_array& array, std::int64_t row, std::int64_t column);  ///< f64 only
std::uint64_t hash_of(const Inputs& inputs);

void write_where_nothing_is();
[[noreturn]] void sleep_for_ever();
std::int32_t refuse(weft_error& error, const char* message);

// Faults by the function in which they are made.
void act_when_loaded();
std::int32_t describe(const weft_describe* sink, weft_error* error);
const void* get_extension(const weft_component* component, const char* name);
std::int32_t create(const weft_create* with, void** self, weft_error* error);
std::int32_t prepare(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
std::int32_t process(void* self, const weft_call* call, const weft_record* inputs,
                     std::uint64_t count, weft_error* error);
void destroy(void* self);

/// Faults of frame 1 that end the process or the call; returns WEFT_OK where the call goes on.
std::int32_t end_in_frame_1(weft_error& error);
/// True if rounding mode or locale differ from those that the host guarantees when a call begins.
bool is_mode_changed();
/// Faults of a call, whose inputs as the host gave them are `given`.
void misuse_host(const weft_call& call, const Inputs& inputs, const weft_record* given);
/// Before a call; may change what the original sees of the inputs.
struct PaddingIgnored {
  std::vector<std::vector<weft_array>> arrays;
};
void misuse_inputs(Inputs& inputs, PaddingIgnored& changed);
/// The part by which something that must not matter changes this call's answer; 0 where it does
/// not.
inline constexpr double kSway = 0.02;
double strength_of_sway(const PassedCall& passed, const Inputs& inputs, Instance& instance);
/// Makes the largest number of the answer smaller by this part, which is legal.
void sway(std::vector<Output>& outputs, double strength = kSway);
std::int32_t spoil_outputs(PassedCall& passed, std::int32_t status, weft_error& error);
void distort_geometry(std::vector<Output>& outputs, const Inputs& inputs);
/// In the function `place` of the component, or when it is loaded ("load").
void disturb_process(std::string_view place);

}  // namespace weft::faults
