// SPDX-License-Identifier: Apache-2.0
#include "common/truth_file.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

#include "common/csv_lines.hpp"

namespace weft::sources {
namespace {

constexpr std::array<const char*, 8> kColumns{"point_id", "template_x_mm", "template_y_mm", "u_px",
                                              "v_px",     "X_mm",          "Y_mm",          "Z_mm"};
/// The numbers of a line; the first entry, the point's name, is unused.
using Row = std::array<double, kColumns.size()>;

class TruthReader {
 public:
  explicit TruthReader(CsvLines lines) : lines_(std::move(lines)) {}

  Result<GroundTruth> read() {
    auto more = lines_.next();
    if (!more) return more.error();
    if (!*more) return lines_.mistake("is empty: the first line names the columns");
    if (auto header = read_header(); !header) return header.error();
    for (more = lines_.next(); more && *more; more = lines_.next()) {
      if (auto row = read_row(); !row) return row.error();
    }
    if (!more) return more.error();
    if (rows_.empty()) return lines_.mistake("holds no points");
    return truth();
  }

 private:
  Result<void> read_header() {
    for (const std::string& name : lines_.fields()) {
      const auto known = std::find(kColumns.begin(), kColumns.end(), name);
      if (known == kColumns.end()) {
        return lines_.mistake("the column '" + name + "' is unknown: remove or rename it");
      }
      const auto column = to_index(known - kColumns.begin());
      if (std::find(column_of_.begin(), column_of_.end(), column) != column_of_.end()) {
        return lines_.mistake("the column '" + name + "' is given twice: remove one");
      }
      column_of_.push_back(column);
    }
    for (std::size_t column = 0; column < kColumns.size(); ++column) {
      if (std::find(column_of_.begin(), column_of_.end(), column) == column_of_.end()) {
        return lines_.mistake(std::string("the column '") + kColumns[column] +
                              "' is missing: add it");
      }
    }
    return {};
  }

  Result<void> read_row() {
    const std::vector<std::string>& fields = lines_.fields();
    if (fields.size() != column_of_.size()) {
      return lines_.mistake("has " + std::to_string(fields.size()) +
                            " fields where the header has " + std::to_string(column_of_.size()));
    }
    Row row{};
    for (std::size_t i = 0; i < fields.size(); ++i) {
      const std::size_t column = column_of_[i];
      if (column == 0) {
        if (points_.insert(fields[i]).second) continue;
        return lines_.mistake("the point '" + fields[i] + "' is given twice");
      }
      const auto number = lines_.number(i, kColumns[column]);
      if (!number) return number.error();
      row[column] = *number;
    }
    if (!(row[7] > 0.0))
      return lines_.mistake("'Z_mm' must be positive: the camera looks along +z");
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

  CsvLines lines_;
  std::vector<std::size_t> column_of_;  // entry of kColumns for each field of the file
  std::set<std::string> points_;
  std::vector<Row> rows_;
};

}  // namespace

Result<GroundTruth> read_truth_file(const std::string& path) {
  auto lines = CsvLines::open(path);
  if (!lines) return lines.error();
  return TruthReader(*std::move(lines)).read();
}

}  // namespace weft::sources
