// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace weft {

/// Quotes a text as a field of comma-separated values (RFC 4180).
inline std::string csv_field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace weft
