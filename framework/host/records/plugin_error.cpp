// SPDX-License-Identifier: Apache-2.0
#include "host/records/plugin_error.hpp"

#include <string.h>

#include <weft/core/quote.hpp>

namespace weft::host {
namespace {

/// A text that its writer may have forgotten to end, and that may quote a file.
template <std::size_t Size>
std::string text_in(const char (&buffer)[Size]) {
  return escaped({buffer, strnlen(buffer, Size - 1)});
}

}  // namespace

Error plugin_error(std::int32_t status, const weft_error& raw, const std::string& id) {
  if (status == WEFT_OK) return {};
  const std::string where = text_in(raw.where);
  Error error{static_cast<Errc>(raw.code), text_in(raw.message), where.empty() ? id : where,
              text_in(raw.subject)};
  const bool known = (raw.code > static_cast<std::int32_t>(Errc::no_result) &&
                      raw.code < static_cast<std::int32_t>(Errc::cancelled)) ||
                     raw.code == static_cast<std::int32_t>(Errc::no_memory);
  if (status == WEFT_NO_RESULT) {
    error.code = Errc::no_result;
  } else if (status == WEFT_CANCELLED) {
    error.code = Errc::cancelled;
  } else if (status == WEFT_END) {
    error.code = Errc::end;
  } else if (!known) {
    error.code = Errc::plugin_failure;
  }
  if (error.message.empty())
    error.message = "gave no reason for its status " + std::to_string(status);
  return error;
}

}  // namespace weft::host
