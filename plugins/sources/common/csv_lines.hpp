// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <sstream>
#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::sources {

/// The lines of comma-separated values, split into fields (csv_cells.hpp). Empty lines are passed
/// over; CR LF and a byte order mark are understood.
class CsvLines {
 public:
  /// Fails on a file that cannot be read, or of more than 256 MiB.
  static Result<CsvLines> open(const std::string& path);

  /// Reads a further line, which fields() then has; false at the end. Fails at a line that is no
  /// CSV.
  Result<bool> next();
  const std::vector<std::string>& fields() const { return fields_; }

  /// "path:line: sentence" of the line that was read last.
  Error mistake(const std::string& sentence) const;

  /// The finite number of a field; an error that names its column.
  Result<double> number(std::size_t field, const std::string& column) const;

 private:
  CsvLines(std::string path, std::string text) : path_(std::move(path)), stream_(std::move(text)) {}

  std::string path_;
  std::istringstream stream_;
  std::int64_t line_number_ = 0;
  bool in_header_ = true;
  std::vector<std::string> fields_;
};

}  // namespace weft::sources
