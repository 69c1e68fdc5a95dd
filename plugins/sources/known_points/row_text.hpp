// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

#include "point_row.hpp"

namespace weft::known_points {

/// "path:line:column: message"; the column counts characters from 1.
Error mistake_at(const std::string& path, int line, int column, const std::string& message);

/// The rows of a CSV file whose first line names its fields, in any order. A radius_mm or sigma_mm
/// may be left empty. Fails at the first error, with its place.
class CsvReader {
 public:
  explicit CsvReader(std::string path) : path_(std::move(path)) {}

  Result<void> read_header(std::string_view line, int line_number);
  Result<PointRow> read(std::string_view line, int line_number) const;

 private:
  std::string path_;
  std::vector<Field> fields_;
};

/// A row of a JSON object whose keys are fields and whose values are numbers, such as
/// {"time_s": 0.4, "vertex": 3, "X_mm": -12.5, "Y_mm": 40, "Z_mm": 610, "radius_mm": 5}.
Result<PointRow> read_json_row(const std::string& path, std::string_view line, int line_number);

}  // namespace weft::known_points
