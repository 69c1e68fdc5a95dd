// SPDX-License-Identifier: Apache-2.0
// Faults in complete answers.
#include <algorithm>
#include <cmath>
#include <limits>

#include "faults.hpp"

namespace weft::faults {
namespace {

bool is_real(const Output& output) { return output.dtype == WEFT_F64 && output.bytes() > 0; }

double* reals(Output& output) { return reinterpret_cast<double*>(output.data); }

std::size_t count(const Output& output) { return output.bytes() / element_bytes(output.dtype); }

Output* find(std::vector<Output>& outputs, std::string_view array) {
  const auto found = std::find_if(outputs.begin(), outputs.end(),
                                  [&](const Output& each) { return each.array == array; });
  return found != outputs.end() && found->bytes() > 0 ? &*found : nullptr;
}

Output* largest(std::vector<Output>& outputs) {
  const auto found =
      std::max_element(outputs.begin(), outputs.end(),
                       [](const Output& a, const Output& b) { return a.bytes() < b.bytes(); });
  return found != outputs.end() && found->bytes() > 0 ? &*found : nullptr;
}

/// The first number that may be another one: of evidence, trust, or a place.
Output* harmless(std::vector<Output>& outputs) {
  for (const char* name :
       {"response", "score", "xy_px", "vertices_m", "t_s", "weight", "image_px"}) {
    Output* const found = find(outputs, name);
    if (found != nullptr && is_real(*found)) return found;
  }
  for (Output& output : outputs) {
    const bool is_model = output.array.starts_with("model.") || output.array.starts_with("diag.");
    if (is_model && is_real(output)) return &output;
  }
  return nullptr;
}

void spoil_bytes(std::vector<Output>& outputs) {
  Output* const output = largest(outputs);
  if (output == nullptr) return;
  if (has("writes_past_output")) std::memset(output->data + output->bytes(), 0x5A, 8);
  if (has("last_row_unwritten")) {
    const std::size_t start = output->bytes() - output->row_bytes();
    std::copy(output->before.begin() + static_cast<std::ptrdiff_t>(start), output->before.end(),
              output->data + start);
  }
  if (!has("reads_uninitialised")) return;
  const bool is_even = std::all_of(output->before.begin(), output->before.end(),
                                   [](unsigned char byte) { return byte == 0xFF; });
  if (is_even) sway(outputs);
}

void spoil_numbers(std::vector<Output>& outputs) {
  if (has("nan_in_output")) {
    const auto real = std::find_if(outputs.begin(), outputs.end(), is_real);
    if (real != outputs.end()) reals(*real)[0] = std::numeric_limits<double>::quiet_NaN();
  }
  if (has("flag_255")) {
    for (const char* name : {"kept", "source"}) {
      if (Output* flags = find(outputs, name)) flags->data[0] = 255;
    }
  }
  if (has("negative_depth")) {
    if (Output* vertices = find(outputs, "vertices_m")) {
      for (std::size_t i = 2; i < count(*vertices); i += 3) reals(*vertices)[i] *= -1.0;
    }
  }
  if (has("keeps_rejected")) {
    if (Output* kept = find(outputs, "kept")) std::fill_n(kept->data, kept->bytes(), 1);
  }
}

/// Sets an invalid confidence, in a new array if there is none.
void claim_confidence(PassedCall& passed) {
  if (Output* made = find(passed.outputs, "confidence")) {
    reals(*made)[0] = 1.5;
    return;
  }
  if (passed.outputs.empty()) return;
  const Output& other = passed.outputs.front();
  const std::int64_t none = 0;
  void* data = weft_alloc(&passed.original, other.slot.c_str(), other.type.c_str(), "confidence",
                          WEFT_F64, 0, &none);
  const double value = 1.5;
  if (data != nullptr) std::memcpy(data, &value, sizeof(value));
}

}  // namespace

void sway(std::vector<Output>& outputs, double strength) {
  Output* const output = harmless(outputs);
  if (output == nullptr) {
    // An image, a region: a grey level, a flag.
    if (Output* any = largest(outputs)) any->data[any->bytes() / 2] ^= 1U;
    return;
  }
  double* const first = reals(*output);
  double* const number = std::max_element(
      first, first + count(*output), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (std::isfinite(*number)) *number = *number == 0.0 ? strength : *number * (1.0 - strength);
}

std::int32_t spoil_outputs(PassedCall& passed, std::int32_t status, weft_error& error) {
  const bool is_usable = status == WEFT_OK || status == WEFT_DEGENERATE;
  if (is_usable) {
    spoil_bytes(passed.outputs);
    spoil_numbers(passed.outputs);
    if (has("confidence_above_one")) claim_confidence(passed);
  }
  if (status != WEFT_OK && has("error_without_text")) error.message[0] = '\0';
  if (status != WEFT_OK && has("text_not_utf8")) error.message[0] = '\xFF';
  if (has("half_when_cancelled") && status == WEFT_CANCELLED) return WEFT_OK;
  if (has("ok_without_memory") && status != WEFT_CANCELLED && !passed.replacements.empty())
    return WEFT_OK;
  if (has("ok_in_place_of_warning") && (status == WEFT_DEGENERATE || status == WEFT_NO_RESULT)) {
    return WEFT_OK;
  }
  return status;
}

}  // namespace weft::faults
