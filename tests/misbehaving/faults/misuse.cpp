// SPDX-License-Identifier: Apache-2.0
// Faults in the use of the host: its structs, its log and its other components.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <utility>

#include "faults.hpp"

namespace weft::faults {
namespace {

using namespace std::chrono_literals;

/// Writes the value that a field has already.
template <class Field>
void write_again(const Field& field) {
  auto& written = const_cast<volatile Field&>(field);
  written = field;
}

void write_structs(const weft_call& call, const Inputs& inputs, const weft_record* given) {
  if (has("writes_call")) write_again(call.threads);
  if (has("writes_host")) write_again(call.host->struct_size);
  if (inputs.empty()) return;
  if (has("writes_record")) write_again(given->view);
  auto* arrays = const_cast<weft_array*>(inputs.front().arrays);
  if (has("writes_array_entry")) write_again(arrays->memory);
  if (has("swaps_arrays") && inputs.front().count > 1) std::swap(arrays[0], arrays[1]);
}

void log_oddly(const weft_call& call) {
  const auto log = [&](const std::string& text) { call.host->log(&call, 1, text.c_str()); };
  if (has("logs_escape")) log("\x1b[2Jall is well");
  if (has("logs_lines")) log("a line\nwarning: another one");
  if (has("logs_bad_text")) log("caf\xe9");
  if (has("logs_huge")) log(std::string(std::size_t{1} << 20U, 'x'));
  for (int i = 0; has("logs_often") && i < 200; ++i) log("once more");
  while (has("logs_for_ever")) log("once more");
}

/// Handles are small numbers, which can be guessed.
void invoke_others(const weft_call& call, const Inputs& inputs) {
  for (std::uint64_t handle = 1; has("invokes_others") && handle < 12; ++handle) {
    weft_invocation asked{};
    asked.struct_size = sizeof(asked);
    asked.component = handle;
    asked.inputs = inputs.data();
    asked.input_count = inputs.size();
    asked.frame = call.frame;
    weft_error error{};
    error.struct_size = sizeof(error);
    call.host->invoke(&call, &asked, &error);
  }
}

/// Its destructor runs when the program ends.
struct Last {
  ~Last() {
    if (has("destructor_crashes")) write_where_nothing_is();
    if (has("prints_at_exit")) std::puts("a last word");
    if (has("changes_exit_code")) _Exit(3);
  }
};

}  // namespace

void misuse_host(const weft_call& call, const Inputs& inputs, const weft_record* given) {
  static const Last last;
  write_structs(call, inputs, given);
  log_oddly(call);
  invoke_others(call, inputs);
  if (!has("keeps_call")) return;
  std::thread([kept = &call] {
    std::this_thread::sleep_for(50ms);
    kept->host->cancelled(kept);
  }).detach();
}

}  // namespace weft::faults
