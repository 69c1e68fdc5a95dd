// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/report/tables/tables.hpp"

namespace weft::lab {

/// Provenance of a table or figure: program with commit, command, sequences with their data seeds,
/// run seeds; a line each.
std::string origin_of(const Results& results);

/// Mean 3D error of each combination with its 95 % interval, as an SVG file that carries its
/// origin. Empty where no combination has an error.
std::string error_figure(const Results& results, const ReportTables& tables);

/// The main rates of the last filter stage of each combination, as an SVG file. Empty if no filter
/// was measured.
std::string filter_figure(const Results& results, const ReportTables& tables);

struct PaperFiles {
  std::vector<std::string> files;  ///< [.] written files
  bool figures = false;            ///< there is a figure
  bool pdf = false;                ///< it is there as PDF too
};

/// Writes the tables of a results folder as LaTeX, and its figures as SVG and, where write_pdf can,
/// as PDF, to DIR/paper. Fails as write_report does.
Result<PaperFiles> write_paper(const std::string& folder);

}  // namespace weft::lab
