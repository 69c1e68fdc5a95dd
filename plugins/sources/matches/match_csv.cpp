// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <string_view>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/core/text_file.hpp>
#include <weft/core/utf8.hpp>

#include "common/csv_cells.hpp"
#include "match_files.hpp"

namespace weft::matches {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

class CsvReader {
 public:
  CsvReader(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  Result<MatchTable> read() {
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
    auto more = next_line();
    if (!more) return more.error();
    if (!*more) return mistake(0, "is empty: the first line names the columns");
    if (auto header = read_header(); !header) return header.error();
    for (more = next_line(); more && *more; more = next_line()) {
      worked(100);
      if (auto row = read_row(); !row) return row.error();
    }
    if (!more) return more.error();
    return std::move(table_);
  }

 private:
  /// At a byte of the line.
  Error mistake(std::size_t byte, const std::string& message) const {
    std::size_t column = 1;
    for (const char c : line_.substr(0, std::min(byte, line_.size()))) {
      column += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
    }
    return {
        Errc::invalid_data,
        path_ + ":" + std::to_string(line_number_) + ":" + std::to_string(column) + ": " + message,
        {}};
  }

  /// Goes to the next line that is not blank.
  Result<bool> next_line() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
      ++line_number_;
      if (line_.ends_with('\r')) line_.remove_suffix(1);
      if (line_.find_first_not_of(" \t\r") == line_.npos) continue;
      if (columns_.empty()) {
        if (const auto wrong = sources::mistake_in_csv_header(line_)) return mistake(0, *wrong);
      }
      auto cells = sources::csv_cells(line_);
      if (!cells) return mistake(0, cells.error().message);
      cells_ = *std::move(cells);
      return true;
    }
    line_number_ += line_number_ == 0 ? 1 : 0;
    return false;
  }

  Result<void> read_header() {
    for (const sources::CsvCell& cell : cells_) {
      const auto column = column_named(cell.text);
      if (!column) return mistake(cell.byte, unknown_column(cell.text));
      if (table_.has(*column)) {
        return mistake(cell.byte, "the column " + quote(cell.text) + " is given twice: remove one");
      }
      table_.declare(*column);
      columns_.push_back(*column);
    }
    if (const auto wrong = table_.mistake()) return mistake(0, *wrong);
    return {};
  }

  Result<void> read_row() {
    if (cells_.size() != columns_.size()) {
      return mistake(cells_.back().byte, "has " + std::to_string(cells_.size()) +
                                             " fields where the header has " +
                                             std::to_string(columns_.size()));
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto value = number_in(columns_[i], cells_[i].text);
      const auto wrong = value ? mistake_in(columns_[i], *value) : "must be a finite number";
      if (wrong) {
        return mistake(cells_[i].byte, std::string("'") + name_of(columns_[i]) + "' " + *wrong +
                                           ", not " + quote(cells_[i].text));
      }
      table_[columns_[i]].push_back(*value);
    }
    return {};
  }

  /// Unknown values are empty cells: NaN would be an error elsewhere.
  static std::optional<double> number_in(Column column, std::string_view cell) {
    if (cell.empty() && column == Column::label) return -1.0;
    if (cell.empty() && (column == Column::true_x_px || column == Column::true_y_px)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    return sources::csv_number(cell);
  }

  const std::string& path_;
  std::string_view rest_, line_;
  int line_number_ = 0;
  std::vector<sources::CsvCell> cells_;
  std::vector<Column> columns_;
  MatchTable table_;
};

}  // namespace

Result<MatchTable> read_match_csv(const std::string& path) {
  constexpr std::uint64_t kMostBytes = 1U << 28U;
  const auto text = read_text_file(path, kMostBytes);
  if (!text) {
    return Error{text.error().code, path + ": cannot be read: " + text.error().message};
  }
  return CsvReader(path, *text).read();
}

}  // namespace weft::matches
