// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/evaluation/results_folder.hpp>

/// The texts of a results folder; docs/results.md describes them.
namespace weft::evaluation {

inline constexpr const char* kFolderSchema = "weft.results/1";
inline constexpr const char* kLineSchema = "weft.cell/1";

/// The line of a cell, without its line break.
std::string cell_line(const Cell& cell, const CellResult& result, bool timed,
                      const Measurement& measurement);

/// What a line says; fails with invalid_data where it is no line of this schema.
Result<StoredCell> parse_cell_line(const std::string& line);

std::string manifest_text(const Grid& grid, bool accept_rebuilt);

std::string plan_text(const Grid& grid, const std::string& command);

}  // namespace weft::evaluation
