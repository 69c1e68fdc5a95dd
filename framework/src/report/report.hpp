// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

namespace weft::evaluation {

struct ReportOptions {
  std::string page;    ///< file of the page; empty: report.html in the results folder
  std::string assets;  ///< folder of report.css and, where npm built it, report.js
};

struct ReportFiles {
  std::string page;
  std::vector<std::string> tables;  ///< CSV files and the Markdown file
  bool figures = false;             ///< the page has figures and the 3D view, not tables only
};

/// Writes the report of a results folder: a page that needs nothing beside it, and in DIR/report
/// the tables as CSV, one file each, and all in tables.md. Fails where the folder is no results
/// folder, is damaged or cannot be written, and where the assets have no report.css.
Result<ReportFiles> write_report(const std::string& folder, const ReportOptions& options);

}  // namespace weft::evaluation
