// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/report/panel_figures.hpp"

namespace weft::lab {

/// Provenance of a table or figure: program with commit, command, sequences with their data seeds,
/// run seeds; a line each.
std::string origin_of(const Results& results);

struct PaperFiles {
  std::vector<std::string> files;  ///< [.] written files
  bool figures = false;            ///< there is a figure
  bool pdf = false;                ///< it is there as PDF too
};

/// Writes figures to a folder as SVG, as PGF and, where write_pdf can, as PDF, and adds what it
/// wrote to `files`.
Result<void> write_figures(const std::vector<PanelFigure>& figures, const std::string& folder,
                           const std::string& origin, PaperFiles& files);

/// Writes the tables of a results folder as LaTeX, and its figures as SVG, as PGF and, where
/// write_pdf can, as PDF, to DIR/paper. Fails as write_report does.
Result<PaperFiles> write_paper(const std::string& folder);

}  // namespace weft::lab
