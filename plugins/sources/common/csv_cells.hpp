// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>
#include <weft/core/result.hpp>

/// A line of comma-separated values (RFC 4180), as all readers of CSV files take it.
namespace weft::sources {

struct CsvCell {
  std::string text;      ///< without the quotes and the blanks around it
  std::size_t byte = 0;  ///< position in the line where the cell begins
};

/// The cells of a line without its line break. A cell may be quoted; `""` inside of quotes is one.
/// Fails at a quote that is not closed on its line, or not followed by a comma.
Result<std::vector<CsvCell>> csv_cells(std::string_view line);

/// The error in a first line whose separator is not the comma, or that is UTF-16.
std::optional<std::string> mistake_in_csv_header(std::string_view line);

/// The number that all of a cell spells, finite; a plus sign may precede it.
std::optional<double> csv_number(std::string_view text);

}  // namespace weft::sources
