// SPDX-License-Identifier: Apache-2.0
#include <charconv>
#include <cmath>
#include <limits>
#include <string_view>
#include <weft/core/index.hpp>
#include <weft/core/quote.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/core/text_file.hpp>
#include <weft/core/utf8.hpp>

#include "match_files.hpp"

namespace weft::matches {
namespace {

constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

std::string_view trimmed(std::string_view cell) {
  const std::size_t first = cell.find_first_not_of(" \t");
  if (first == cell.npos) return cell.substr(cell.size());
  return cell.substr(first, cell.find_last_not_of(" \t") - first + 1);
}

class CsvReader {
 public:
  CsvReader(const std::string& path, std::string_view text) : path_(path), rest_(text) {}

  Result<MatchTable> read() {
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
    if (!next_line()) return mistake("", "is empty: the first line names the columns");
    if (auto header = read_header(); !header) return header.error();
    while (next_line()) {
      worked(100);
      if (auto row = read_row(); !row) return row.error();
    }
    return std::move(table_);
  }

 private:
  /// `cell` is part of the line, or empty for its beginning.
  Error mistake(std::string_view cell, const std::string& message) const {
    const std::size_t byte = cell.data() == nullptr || cell.data() < line_.data()
                                 ? 0
                                 : to_index(cell.data() - line_.data());
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
  bool next_line() {
    while (!rest_.empty()) {
      const std::size_t end = rest_.find('\n');
      line_ = rest_.substr(0, end);
      rest_ = end == rest_.npos ? std::string_view() : rest_.substr(end + 1);
      ++line_number_;
      if (line_.ends_with('\r')) line_.remove_suffix(1);
      if (!trimmed(line_).empty()) {
        split();
        return true;
      }
    }
    line_number_ += line_number_ == 0 ? 1 : 0;
    return false;
  }

  void split() {
    cells_.clear();
    for (std::size_t start = 0;;) {
      const std::size_t end = std::min(line_.find(',', start), line_.size());
      cells_.push_back(trimmed(line_.substr(start, end - start)));
      if (end == line_.size()) return;
      start = end + 1;
    }
  }

  Result<void> read_header() {
    for (const std::string_view cell : cells_) {
      const auto column = column_named(cell);
      if (!column) return mistake(cell, unknown_column(std::string(cell)));
      if (table_.has(*column)) {
        return mistake(cell, "the column " + quote(cell) + " is given twice: remove one");
      }
      table_.declare(*column);
      columns_.push_back(*column);
    }
    if (const auto wrong = table_.mistake()) return mistake("", *wrong);
    return {};
  }

  Result<void> read_row() {
    if (cells_.size() != columns_.size()) {
      return mistake(cells_.back(), "has " + std::to_string(cells_.size()) +
                                        " fields where the header has " +
                                        std::to_string(columns_.size()));
    }
    for (std::size_t i = 0; i < cells_.size(); ++i) {
      const auto value = number_in(columns_[i], cells_[i]);
      const auto wrong = value ? mistake_in(columns_[i], *value) : "must be a finite number";
      if (wrong) {
        return mistake(cells_[i], std::string("'") + name_of(columns_[i]) + "' " + *wrong +
                                      ", not " + quote(cells_[i]));
      }
      table_[columns_[i]].push_back(*value);
    }
    return {};
  }

  /// What is not known is an empty cell: NaN would be a slip elsewhere.
  static std::optional<double> number_in(Column column, std::string_view cell) {
    if (cell.empty() && column == Column::label) return -1.0;
    if (cell.empty() && (column == Column::true_x_px || column == Column::true_y_px)) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    double value = 0.0;
    const char* end = cell.data() + cell.size();
    const auto [stop, code] = std::from_chars(cell.data(), end, value);
    if (code != std::errc{} || stop != end || !std::isfinite(value)) return std::nullopt;
    return value;
  }

  const std::string& path_;
  std::string_view rest_, line_;
  int line_number_ = 0;
  std::vector<std::string_view> cells_;
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
