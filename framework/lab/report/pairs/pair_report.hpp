// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/core/result.hpp>

#include "lab/report/text/page.hpp"

namespace weft::lab {

/// Writes a page that compares two folders of `weft run`, or two of `weft ablate`. A folder of the
/// same name beside it has its tables, and its figures as SVG, PGF and, with rsvg-convert, PDF.
/// Without ReportOptions::page they are in A, named after B. Parts that cannot be compared are
/// named with the reason. Fails with invalid_value if one is a run and the other an ablation, or
/// if they are the same, and as write_report and write_run_report do.
Result<ReportFiles> write_pair_report(const std::string& a, const std::string& b,
                                      const ReportOptions& options);

}  // namespace weft::lab
