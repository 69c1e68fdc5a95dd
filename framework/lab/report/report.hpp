// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "lab/report/text/page.hpp"

namespace weft::lab {

/// Writes the report of a results folder: a page that needs nothing beside it, and in DIR/report
/// the tables as CSV, one file each, and all in tables.md. Fails where the folder is no results
/// folder, is damaged or cannot be written, and where the assets have no report.css.
Result<ReportFiles> write_report(const std::string& folder, const ReportOptions& options);

}  // namespace weft::lab
