// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "lab/report/text/page.hpp"

namespace weft::lab {

/// True if a folder is one that `weft run` wrote, or began to write.
bool is_run_folder(const std::string& folder);

/// Writes the report of a run folder: a page that needs nothing beside it, with errors where the
/// run has truth. Fails where the folder is no run folder, is damaged or cannot be written.
Result<ReportFiles> write_run_report(const std::string& folder, const ReportOptions& options);

}  // namespace weft::lab
