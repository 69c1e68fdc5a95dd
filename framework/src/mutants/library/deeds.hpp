// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/abi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "mutants/operator_table.hpp"

/// What the library that misbehaves is made of. It knows the binary contract and nothing else of
/// Weft.
namespace weft::mutants {

/// The file beside the library, whose name ends in .mutant where the library's ends in .so: what to
/// load and what to do.
struct Order {
  std::string library;    ///< path of the plugin that is mutated
  std::string component;  ///< id of the component that misbehaves
  std::string deed;       ///< name of an operator; empty: nothing, all is handed on as it is
};
const Order& order();

/// The name of an operator, which must stand in the table.
struct Deed {
  consteval Deed(const char* name) : place(0) {  // NOLINT(google-explicit-constructor)
    while (kOperators[place].name != name) ++place;
  }
  std::size_t place;
};
/// Whether this is what to do.
bool does(Deed deed);

bool is_subject(const weft_component& component);

/// What is remembered of one instance.
struct Instance {
  bool is_prepared = false;
  int calls = 0;
  std::uint64_t last_inputs = 0;  ///< a hash of their contents
  std::uint64_t last_frame = 0;
  std::thread::id creator;
  const volatile unsigned char* kept_input = nullptr;
};
/// Of what the plugin's create gave; made when it is asked for first.
Instance& instance_of(void* self);
void forget_instance(void* self);
std::size_t instance_count();

/// An array that the component has asked for in this call.
struct Output {
  std::string slot, type, array;
  std::int32_t dtype;
  std::vector<std::int64_t> shape;
  unsigned char* data;
  std::vector<unsigned char> before;  ///< what it held, where that matters

  std::size_t bytes() const;
  std::size_t row_bytes() const;
};

/// A call as the plugin sees it: it begins with a weft_call, whose host is this library.
struct PassedCall {
  PassedCall(const weft_call& original, const weft_component& component);
  PassedCall(const PassedCall&) = delete;
  PassedCall& operator=(const PassedCall&) = delete;

  weft_call call;
  const weft_call& original;
  const weft_component& component;
  weft_host host;
  std::vector<Output> outputs;
  std::vector<std::vector<unsigned char>> lent;  ///< in place of what the host refused
};

using Inputs = std::vector<weft_record>;

std::size_t element_bytes(std::int32_t dtype);
std::size_t row_bytes(const weft_array& array);  ///< of one step along axis 0, without padding
std::int64_t rows(const weft_array& array);
const weft_array* find_array(const Inputs& inputs, std::string_view array);
double value_at(const weft_array& array, std::int64_t row, std::int64_t column);  ///< of f64
std::uint64_t hash_of(const Inputs& inputs);

// The deeds, by where they are done.
void misbehave_when_loaded();
std::int32_t describe(const weft_component& component, const weft_describe& sink,
                      weft_error& error);
std::int32_t create(const weft_component& component, const weft_create& with, void** self,
                    weft_error& error);
/// Before a call; may change what the plugin sees of the inputs.
struct PaddingIgnored {
  std::vector<std::vector<weft_array>> arrays;
};
void misuse_inputs(Inputs& inputs, PaddingIgnored& changed);
/// By which part something that must not matter changes this call's answer; 0 where nothing does.
inline constexpr double kSway = 0.02;
double strength_of_sway(const PassedCall& passed, const Inputs& inputs, Instance& instance);
/// Makes the largest number of what it made smaller by this part, which is legal.
void sway(std::vector<Output>& outputs, double strength = kSway);
std::int32_t spoil_outputs(PassedCall& passed, std::int32_t status, weft_error& error);
void distort_geometry(std::vector<Output>& outputs, const Inputs& inputs);
void disturb_process();

}  // namespace weft::mutants
