// SPDX-License-Identifier: Apache-2.0
#include "common/csv_lines.hpp"

#include <charconv>
#include <cmath>
#include <string_view>
#include <weft/core/stop_check.hpp>
#include <weft/core/text_file.hpp>

namespace weft::sources {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

void split(std::string_view line, std::vector<std::string>& fields) {
  fields.clear();
  while (true) {
    const std::size_t comma = line.find(',');
    const std::string_view field = line.substr(0, comma);
    const std::size_t first = field.find_first_not_of(" \t");
    const std::size_t last = field.find_last_not_of(" \t");
    fields.emplace_back(first == field.npos ? "" : field.substr(first, last - first + 1));
    if (comma == line.npos) return;
    line.remove_prefix(comma + 1);
  }
}

}  // namespace

Result<CsvLines> CsvLines::open(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  auto text = read_text_file(path, kMostBytes);
  if (text) return CsvLines(path, *std::move(text));
  return Error{text.error().code, path + ": cannot be read: " + text.error().message};
}

bool CsvLines::next() {
  std::string line;
  while (std::getline(stream_, line)) {
    worked_in_loop(line_number_, 10);
    if (++line_number_ == 1 && line.starts_with(kByteOrderMark)) {
      line.erase(0, kByteOrderMark.size());
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == line.npos) continue;
    split(line, fields_);
    return true;
  }
  return false;
}

Error CsvLines::mistake(const std::string& sentence) const {
  return {Errc::invalid_data, path_ + ":" + std::to_string(line_number_) + ": " + sentence, {}};
}

Result<double> CsvLines::number(std::size_t field, const std::string& column) const {
  const std::string& text = fields_[field];
  const char* end = text.data() + text.size();
  double value = 0.0;
  const auto parsed = std::from_chars(text.data(), end, value);
  if (parsed.ec == std::errc{} && parsed.ptr == end && std::isfinite(value)) return value;
  return mistake("'" + column + "' must be a finite number, not '" + text + "'");
}

}  // namespace weft::sources
