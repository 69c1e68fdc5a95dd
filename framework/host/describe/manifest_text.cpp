// SPDX-License-Identifier: Apache-2.0
#include "host/describe/manifest_text.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <sstream>
#include <weft/sdk/extensions.hpp>

#include "host/describe/declaration_check.hpp"

namespace weft::host {

std::string double_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    if (static_cast<unsigned char>(c) >= 0x20 && c != 0x7F) {
      result += c;
    } else {
      constexpr char kDigits[] = "0123456789abcdef";
      result += std::string("\\x") + kDigits[c / 16] + kDigits[c % 16];
    }
  }
  return result + '"';
}

std::string number(double value) {
  if (std::isinf(value)) return value > 0 ? ".inf" : "-.inf";
  std::array<char, 40> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

std::string words(std::string_view text) {
  std::string list = "[";
  std::istringstream stream{std::string(text)};
  for (std::string word; stream >> word;)
    list += (list.size() > 1 ? ", " : "") + double_quoted(word);
  return list + "]";
}

namespace {

std::string element(const weft_value& value, std::uint64_t index) {
  switch (value.type) {
    case WEFT_VALUE_F64:
      return number(static_cast<const double*>(value.data)[index]);
    case WEFT_VALUE_I64:
      return std::to_string(static_cast<const std::int64_t*>(value.data)[index]);
    case WEFT_VALUE_BOOL:
      return static_cast<const std::uint8_t*>(value.data)[index] != 0 ? "true" : "false";
    default:
      return double_quoted(static_cast<const char* const*>(value.data)[index]);
  }
}

std::string default_of(const weft_value& value) {
  if (value.type == WEFT_VALUE_LABELS) return "{}";
  if (value.is_vector == 0) return element(value, 0);
  std::string list = "[";
  for (std::uint64_t i = 0; i < value.count; ++i) {
    list += (i > 0 ? ", " : "") + element(value, i);
  }
  return list + "]";
}

/// The range of a number as "[0, 10]"; empty if it has none.
std::string range_of(const weft_parameter& parameter) {
  const std::int32_t type = parameter.default_value.type;
  if (type == WEFT_VALUE_F64) {
    const double low = parameter.minimum, high = parameter.maximum;
    if (!std::isfinite(low) && !std::isfinite(high)) return {};
    return "[" + number(low) + ", " + number(high) + "]";
  }
  if (type != WEFT_VALUE_I64) return {};
  const std::int64_t low = parameter.integer_minimum, high = parameter.integer_maximum;
  const bool has_low = low != std::numeric_limits<std::int64_t>::min();
  const bool has_high = high != std::numeric_limits<std::int64_t>::max();
  if (!has_low && !has_high) return {};
  return "[" + (has_low ? std::to_string(low) : "-.inf") + ", " +
         (has_high ? std::to_string(high) : ".inf") + "]";
}

}  // namespace

void write_parameter(std::ostream& out, const weft_parameter& parameter) {
  const weft_value& value = parameter.default_value;
  const char* type = type_name(value.type);
  out << "      - name: " << double_quoted(value.name)
      << "\n        type: " << (type != nullptr ? type : std::to_string(value.type));
  if (value.is_vector != 0) out << "\n        vector: true";
  if (parameter.required != 0) {
    out << "\n        required: true";
  } else if (type != nullptr) {
    out << "\n        default: " << default_of(value);
  }
  if (*parameter.unit != '\0') out << "\n        unit: " << double_quoted(parameter.unit);
  if (const std::string range = range_of(parameter); !range.empty()) {
    out << "\n        range: " << range;
  }
  for (std::uint64_t i = 0; i < parameter.choice_count; ++i) {
    out << (i == 0 ? "\n        choices: [" : ", ") << double_quoted(parameter.choices[i]);
  }
  if (parameter.choice_count > 0) out << "]";
  if (*parameter.role != '\0') out << "\n        role: " << double_quoted(parameter.role);
  if (*parameter.was != '\0') out << "\n        was: " << double_quoted(parameter.was);
  if ((parameter.flags & WEFT_PARAMETER_DEPRECATED) != 0) out << "\n        deprecated: true";
  if ((parameter.flags & WEFT_PARAMETER_PROMINENT) != 0) out << "\n        prominent: true";
  out << "\n        help: " << double_quoted(parameter.help) << "\n";
}

std::string text_of(const weft_field& field) {
  const auto flag = [&](std::uint32_t bit) { return (field.flags & bit) != 0 ? "true" : "false"; };
  return "{name: " + double_quoted(field.name) + ", type: " + dtype_name(field.dtype) +
         ", shape: " + double_quoted(field.shape) + ", unit: " + double_quoted(field.unit) +
         ", meaning: " + double_quoted(field.meaning) + ", optional: " + flag(WEFT_FIELD_OPTIONAL) +
         ", may_be_nan: " + flag(WEFT_FIELD_MAY_BE_NAN) + "}";
}

}  // namespace weft::host
