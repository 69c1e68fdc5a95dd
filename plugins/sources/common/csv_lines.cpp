// SPDX-License-Identifier: Apache-2.0
#include "common/csv_lines.hpp"

#include <string_view>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/core/text_file.hpp>

#include "common/csv_cells.hpp"

namespace weft::sources {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

Result<CsvLines> CsvLines::open(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  auto text = read_text_file(path, kMostBytes);
  if (text) return CsvLines(path, *std::move(text));
  return Error{text.error().code, path + ": cannot be read: " + text.error().message};
}

Result<bool> CsvLines::next() {
  std::string line;
  while (std::getline(stream_, line)) {
    worked_in_loop(line_number_, 10);
    if (++line_number_ == 1 && line.starts_with(kByteOrderMark)) {
      line.erase(0, kByteOrderMark.size());
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.find_first_not_of(" \t") == line.npos) continue;
    if (std::exchange(in_header_, false)) {
      if (const auto wrong = mistake_in_csv_header(line)) return mistake(*wrong);
    }
    auto cells = csv_cells(line);
    if (!cells) return mistake(cells.error().message);
    fields_.clear();
    for (CsvCell& cell : *cells) fields_.push_back(std::move(cell.text));
    return true;
  }
  return false;
}

Error CsvLines::mistake(const std::string& sentence) const {
  return {Errc::invalid_data, path_ + ":" + std::to_string(line_number_) + ": " + sentence, {}};
}

Result<double> CsvLines::number(std::size_t field, const std::string& column) const {
  const std::string& text = fields_[field];
  if (const auto value = csv_number(text)) return *value;
  return mistake("'" + column + "' must be a finite number, not '" + text + "'");
}

}  // namespace weft::sources
