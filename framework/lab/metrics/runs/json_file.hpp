// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <weft/core/text_file.hpp>

#include "lab/statistics/unknown.hpp"

namespace weft::lab {

/// Largest file that a program writes for itself and reads whole again.
inline constexpr std::uint64_t kMostJsonBytes = std::uint64_t{1} << 30U;

/// A file that holds one JSON object. Errc::not_found where there is none, Errc::io where it cannot
/// be read, Errc::invalid_data where it is something else.
inline Result<nlohmann::json> read_json_object(const std::string& file) {
  const auto text = read_text_file(file, kMostJsonBytes);
  if (!text) return text.error();
  auto content = nlohmann::json::parse(*text, nullptr, false);
  if (!content.is_object()) return Error{Errc::invalid_data, "is no JSON object", file};
  return content;
}

/// The library's message about a member that is missing or has another type, without its own name.
inline std::string reason_of(const nlohmann::json::exception& mistake) {
  const std::string text = mistake.what();
  const std::size_t end = text.find("] ");
  return end == std::string::npos ? text : text.substr(end + 2);
}

/// A number of an object, or NaN where there is null or nothing.
inline double number_of(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() || found->is_null() ? kUnknown : found->get<double>();
}

/// The text under a key; empty where there is none.
inline std::string text_in(const nlohmann::json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : "";
}

}  // namespace weft::lab
