// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <weft/core/index.hpp>

#include "common/clouds/cloud_file.hpp"
#include "common/csv_lines.hpp"

namespace weft::sources {
namespace {

constexpr std::array<const char*, 6> kCloudColumns{"X_m", "Y_m", "Z_m", "X_mm", "Y_mm", "Z_mm"};

/// Place of the name in kCloudColumns, or kCloudColumns.size().
std::size_t cloud_column_of(const std::string& name) {
  return to_index(std::find(kCloudColumns.begin(), kCloudColumns.end(), name) -
                  kCloudColumns.begin());
}

/// The field of each coordinate, and the unit of all.
struct CloudColumns {
  std::array<std::size_t, 3> fields{};
  double unit_m = 1.0;
};

Result<CloudColumns> read_cloud_columns(const CsvLines& lines) {
  const std::vector<std::string>& names = lines.fields();
  const auto in_millimetres = [](const std::string& name) { return name.ends_with("_mm"); };
  const bool millimetres = std::any_of(names.begin(), names.end(), in_millimetres);
  CloudColumns columns{{}, millimetres ? 1e-3 : 1.0};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string wanted = kCloudColumns[k + (millimetres ? 3 : 0)];
    const auto count = std::count(names.begin(), names.end(), wanted);
    if (count == 0) return lines.mistake("the column '" + wanted + "' is missing: add it");
    if (count > 1) return lines.mistake("the column '" + wanted + "' is given twice: remove one");
    columns.fields[k] = to_index(std::find(names.begin(), names.end(), wanted) - names.begin());
  }
  if (names.size() == 3) return columns;
  return lines.mistake("a cloud has three columns, in m or in mm: remove the others");
}

}  // namespace

Result<bool> is_csv_cloud(const std::string& path) {
  auto lines = CsvLines::open(path);
  if (!lines) return lines.error();
  const auto header = lines->next();
  if (!header) return header.error();
  if (!*header) return false;
  return std::all_of(lines->fields().begin(), lines->fields().end(), [](const std::string& name) {
    return cloud_column_of(name) < kCloudColumns.size();
  });
}

Result<Cloud> read_csv_cloud(const std::string& path) {
  auto lines = CsvLines::open(path);
  if (!lines) return lines.error();
  auto more = lines->next();
  if (!more) return more.error();
  if (!*more) return lines->mistake("is empty: the first line names the columns");
  const auto columns = read_cloud_columns(*lines);
  if (!columns) return columns.error();
  Cloud cloud;
  for (more = lines->next(); more && *more; more = lines->next()) {
    if (lines->fields().size() != 3) {
      return lines->mistake("has " + std::to_string(lines->fields().size()) +
                            " fields where the header has 3");
    }
    Eigen::Vector3d point;
    for (std::size_t k = 0; k < 3; ++k) {
      const char* name = columns->unit_m < 1.0 ? kCloudColumns[k + 3] : kCloudColumns[k];
      const auto number = lines->number(columns->fields[k], name);
      if (!number) return number.error();
      point[static_cast<Eigen::Index>(k)] = columns->unit_m * *number;
    }
    if (const auto wrong = mistake_in_point(point)) return lines->mistake(*wrong);
    cloud.points_m.push_back(point);
  }
  if (!more) return more.error();
  if (cloud.points_m.empty()) return no_points(path);
  return cloud;
}

}  // namespace weft::sources
