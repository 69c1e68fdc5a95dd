// SPDX-License-Identifier: Apache-2.0
#include "common/csv_cells.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace weft::sources {
namespace {

constexpr std::string_view kBlanks = " \t\r";

std::size_t skip_blanks(std::string_view line, std::size_t at) {
  return std::min(line.find_first_not_of(kBlanks, at), line.size());
}

/// Reads a quoted cell that begins at `at`; moves `at` behind its last quote and the blanks there.
Result<CsvCell> quoted_cell(std::string_view line, std::size_t& at) {
  CsvCell cell{"", at};
  for (++at;; ++at) {
    const std::size_t end = line.find('"', at);
    if (end == line.npos) {
      return Error{Errc::invalid_data, "has a quote that is not closed on its line"};
    }
    cell.text += line.substr(at, end - at);
    at = end + 1;
    if (!line.substr(at).starts_with('"')) break;
    cell.text += '"';
  }
  at = skip_blanks(line, at);
  if (at == line.size() || line[at] == ',') return cell;
  return Error{Errc::invalid_data,
               "has text behind a closing quote: separate cells by commas, and double a quote "
               "that is part of one"};
}

}  // namespace

Result<std::vector<CsvCell>> csv_cells(std::string_view line) {
  std::vector<CsvCell> cells;
  for (std::size_t at = 0;; ++at) {
    const std::size_t first = skip_blanks(line, at);
    if (line.substr(first).starts_with('"')) {
      at = first;
      auto cell = quoted_cell(line, at);
      if (!cell) return cell.error();
      cells.push_back(*std::move(cell));
    } else {
      const std::size_t end = std::min(line.find(',', at), line.size());
      const std::size_t start = std::min(first, end);
      const std::string_view text = line.substr(start, end - start);
      cells.push_back({std::string(text.substr(0, text.find_last_not_of(kBlanks) + 1)), start});
      at = end;
    }
    if (at == line.size()) return cells;
  }
}

std::optional<std::string> mistake_in_csv_header(std::string_view line) {
  if (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")) {
    return "is UTF-16: save the file as UTF-8";
  }
  if (line.find(',') != line.npos) return std::nullopt;
  for (const auto& [separator, name] : {std::pair{';', "semicolons"}, std::pair{'\t', "tabs"}}) {
    if (line.find(separator) == line.npos) continue;
    return std::string("separates its columns by ") + name +
           ": save the file with commas between columns, and points in numbers";
  }
  return std::nullopt;
}

std::optional<double> csv_number(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0.0;
  const char* end = text.data() + text.size();
  const auto [stop, code] = std::from_chars(text.data(), end, value);
  if (code != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace weft::sources
