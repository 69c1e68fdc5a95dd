// SPDX-License-Identifier: Apache-2.0
#include "lab/results/cell_line.hpp"

#include <string_view>

#include "host/records/content_hash.hpp"

namespace weft::lab {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::string_view kCheckStart = ",\"check\":\"";
constexpr std::string_view kCheckEnd = "\"}";
constexpr std::size_t kCheckSize = kCheckStart.size() + kKeyDigits + kCheckEnd.size();

enum class Check { none, right, wrong };

Check check_of(std::string_view line) {
  if (line.size() <= kCheckSize) return Check::none;
  const std::string_view end = line.substr(line.size() - kCheckSize);
  if (!end.starts_with(kCheckStart) || !end.ends_with(kCheckEnd)) return Check::none;
  const std::string text = std::string(line.substr(0, line.size() - kCheckSize)) + "}";
  const bool right = host::content_hash(text) == end.substr(kCheckStart.size(), kKeyDigits);
  return right ? Check::right : Check::wrong;
}

/// Where the JSON object or list that begins here ends, behind its last character; npos where it
/// does not. The text is valid JSON: its check is right.
std::size_t end_of_value(std::string_view text, std::size_t begin) {
  int depth = 0;
  for (std::size_t i = begin; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '"') {
      for (++i; i < text.size() && text[i] != '"'; ++i) i += text[i] == '\\' ? 1U : 0U;
    } else if (c == '{' || c == '[') {
      ++depth;
    } else if ((c == '}' || c == ']') && --depth == 0) {
      return i + 1;
    }
  }
  return std::string_view::npos;
}

/// Omits a member whose name and first character of its value are `start`. A quote in a text has a
/// backslash before it, so that the first such name is none in a text.
void omit(std::string_view start, std::string& line) {
  const std::size_t begin = line.find(start);
  if (begin == std::string::npos) return;
  const std::size_t end = end_of_value(line, begin + start.size() - 1);
  if (end != std::string_view::npos) line.erase(begin, end - begin);
}

/// The line without what is not needed. Metrics are most of it, and frames most of them; `metrics`
/// is the first member of these names, and no other list of objects in it is called `frames`.
std::string needed_of(std::string line, const LineParts& parts) {
  if (!parts.metrics) {
    omit(",\"metrics\":{", line);
  } else if (!parts.frames) {
    omit(",\"frames\":[", line);
  }
  return line;
}

}  // namespace

bool is_key(const std::string& text) {
  return text.size() == kKeyDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string::npos;
}

std::string checked_line(const ordered_json& object) {
  std::string line = object.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
  const std::string check = host::content_hash(line);
  line.pop_back();
  return line.append(kCheckStart).append(check).append(kCheckEnd);
}

std::string withdrawal_line(const std::string& file, int number, const std::string& reason) {
  return checked_line(
      {{"schema", kWithdrawalSchema}, {"file", file}, {"line", number}, {"reason", reason}});
}

Result<TrustedLine> trusted_line(const std::string& text, const LineParts& parts) {
  const Check check = check_of(text);
  const bool may_omit = check == Check::right;
  TrustedLine line{may_omit ? json::parse(needed_of(text, parts), nullptr, false)
                            : json::parse(text, nullptr, false),
                   may_omit};
  const auto damaged = [](const std::string& what) { return Error{Errc::invalid_data, what}; };
  if (check == Check::wrong) return damaged("it was changed after it was written");
  if (!line.object.is_object()) return damaged("it is not a JSON object");
  const json schema = line.object.value("schema", json());
  const bool of_cell = schema == kLineSchema || schema == kUncheckedLineSchema;
  if (!of_cell && schema != kWithdrawalSchema) {
    return Error{Errc::incompatible,
                 "the schema is " + schema.dump() + ", this program reads '" + kLineSchema + "'"};
  }
  if (schema != kUncheckedLineSchema && !line.checked) return damaged("its check is missing");
  const json key = line.object.value("key", json());
  if (of_cell && !(key.is_string() && is_key(key.get<std::string>()))) {
    return damaged("its key is not made of 32 hexadecimal digits");
  }
  return line;
}

std::string too_many_failed(std::int64_t failed, std::int64_t frames, int max_failed) {
  return std::to_string(failed) + " of " + std::to_string(frames) +
         " frames had an error, more than max_failed (" + std::to_string(max_failed) + ")";
}

std::string failure_of(const json& line) {
  if (line.at("outcome") != "done") {
    const std::string reason = line.value("reason", std::string());
    return reason.empty() ? "no reason was given" : reason;
  }
  // Lines without a check were written when a cell had to fail in every frame; those with another
  // max_failed than 0 have another key by now.
  if (line.at("schema") != kUncheckedLineSchema) return {};
  const std::int64_t failed = line.value("/metrics/counts/failed"_json_pointer, std::int64_t{0});
  if (failed == 0) return {};
  return too_many_failed(failed, line.at("metrics").at("counts").at("frames"), 0);
}

std::vector<CellFile> files_of_line(const json& line) {
  std::vector<CellFile> files;
  for (const json& file : line.value("files", json::array())) {
    files.push_back({file.at("name"), file.at("bytes"), file.at("hash")});
  }
  return files;
}

}  // namespace weft::lab
