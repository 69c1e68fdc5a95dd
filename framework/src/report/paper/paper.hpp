// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "report/tables/tables.hpp"

namespace weft::evaluation {

/// What a table or figure was made from: program with commit, command, sequences with their data
/// seeds, run seeds; a line each.
std::string origin_of(const Results& results);

/// Mean 3D error of each combination with its 95 % interval, as an SVG file that carries its
/// origin. Empty where no combination has an error.
std::string error_figure(const Results& results, const ReportTables& tables);

/// Writes the tables of a results folder as LaTeX, and its figures as SVG, to DIR/paper; the files.
/// Fails as write_report does.
Result<std::vector<std::string>> write_paper(const std::string& folder);

}  // namespace weft::evaluation
