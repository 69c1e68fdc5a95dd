// SPDX-License-Identifier: Apache-2.0
#include "common/truth_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/text_file.hpp>

namespace weft::sources {
namespace {

constexpr std::array<const char*, 8> kColumns{"point_id", "template_x_mm", "template_y_mm", "u_px",
                                              "v_px",     "X_mm",          "Y_mm",          "Z_mm"};
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

/// The numbers of a line; the first entry, the point's name, is unused.
using Row = std::array<double, kColumns.size()>;

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields;
  while (true) {
    const std::size_t comma = line.find(',');
    const std::string_view field = line.substr(0, comma);
    const std::size_t first = field.find_first_not_of(" \t");
    const std::size_t last = field.find_last_not_of(" \t");
    fields.emplace_back(first == field.npos ? "" : field.substr(first, last - first + 1));
    if (comma == line.npos) return fields;
    line.remove_prefix(comma + 1);
  }
}

class TruthReader {
 public:
  explicit TruthReader(const std::string& path) : path_(path) {}

  Result<GroundTruth> read() {
    constexpr std::uint64_t kMostBytes = 1U << 26U;
    auto text = read_text_file(path_, kMostBytes);
    if (!text) {
      return Error{text.error().code, path_ + ": cannot be read: " + text.error().message};
    }
    stream_.str(*std::move(text));
    if (!next_line()) return mistake("is empty: the first line names the columns");
    if (auto header = read_header(); !header) return header.error();
    while (next_line()) {
      if (auto row = read_row(); !row) return row.error();
    }
    if (rows_.empty()) return mistake("holds no points");
    return truth();
  }

 private:
  Error mistake(const std::string& message) const {
    return {Errc::invalid_data, path_ + ":" + std::to_string(line_number_) + ": " + message, {}};
  }

  /// Goes to the next line that is not blank.
  bool next_line() {
    std::string line;
    while (std::getline(stream_, line)) {
      if (++line_number_ == 1 && line.starts_with(kByteOrderMark)) {
        line.erase(0, kByteOrderMark.size());
      }
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.find_first_not_of(" \t") == line.npos) continue;
      fields_ = split(line);
      return true;
    }
    return false;
  }

  Result<void> read_header() {
    for (const std::string& name : fields_) {
      const auto known = std::find(kColumns.begin(), kColumns.end(), name);
      if (known == kColumns.end()) {
        return mistake("the column '" + name + "' is unknown: remove or rename it");
      }
      const auto column = to_index(known - kColumns.begin());
      if (std::find(column_of_.begin(), column_of_.end(), column) != column_of_.end()) {
        return mistake("the column '" + name + "' is given twice: remove one");
      }
      column_of_.push_back(column);
    }
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
      if (std::find(column_of_.begin(), column_of_.end(), column) == column_of_.end()) {
        return mistake(std::string("the column '") + kColumns[column] + "' is missing: add it");
      }
    }
    return {};
  }

  Result<void> read_row() {
    if (fields_.size() != column_of_.size()) {
      return mistake("has " + std::to_string(fields_.size()) + " fields where the header has " +
                     std::to_string(column_of_.size()));
    }
    Row row{};
    for (std::size_t i = 0; i < fields_.size(); ++i) {
      const std::string& text = fields_[i];
      const std::size_t column = column_of_[i];
      if (column == 0) {
        if (!points_.insert(text).second) return mistake("the point '" + text + "' is given twice");
        continue;
      }
      const char* end = text.data() + text.size();
      const auto parsed = std::from_chars(text.data(), end, row[column]);
      if (parsed.ec != std::errc{} || parsed.ptr != end || !std::isfinite(row[column])) {
        return mistake(std::string("'") + kColumns[column] + "' must be a finite number, not '" +
                       text + "'");
      }
    }
    if (!(row[7] > 0.0)) return mistake("'Z_mm' must be positive: the camera looks along +z");
    rows_.push_back(row);
    return {};
  }

  GroundTruth truth() const {
    constexpr double kMetresPerMillimetre = 1e-3;
    const auto count = static_cast<std::int64_t>(rows_.size());
    GroundTruth truth;
    truth.template_xy_m = Array<double>({count, 2});
    truth.points_m = Array<double>({count, 3});
    for (std::int64_t i = 0; i < count; ++i) {
      const Row& row = rows_[to_index(i)];
      for (std::size_t k = 0; k < 2; ++k) {
        truth.template_xy_m.row(i)[k] = kMetresPerMillimetre * row[1 + k];
      }
      for (std::size_t k = 0; k < 3; ++k) {
        truth.points_m.row(i)[k] = kMetresPerMillimetre * row[5 + k];
      }
    }
    return truth;
  }

  std::string path_;
  std::istringstream stream_;
  int line_number_ = 0;
  std::vector<std::string> fields_;
  std::vector<std::size_t> column_of_;  // entry of kColumns for each field of the file
  std::set<std::string> points_;
  std::vector<Row> rows_;
};

}  // namespace

Result<GroundTruth> read_truth_file(const std::string& path) { return TruthReader(path).read(); }

}  // namespace weft::sources
