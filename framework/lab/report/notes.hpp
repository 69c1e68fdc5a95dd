// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/report/tables/tables.hpp"

/// Plain texts that the page and tables.md share.
namespace weft::lab {

/// Meaning of the columns of a table.
std::string combinations_note(const Results& results, const ReportTables& tables);
std::string comparisons_note();
std::string expectations_note();
std::string filters_note(const Results& results);
std::string times_note();
std::string cells_note(const Results& results);

/// "3 seeds", "1 seed".
std::string counted(std::size_t count, const std::string& thing);

/// Limitations of all results of a report, the gravest first.
std::vector<std::string> notices_of(const Results& results, const ReportTables& tables);

/// Result of a comparison.
struct Verdict {
  std::string about;  ///< the axis; empty: no comparison
  std::string text;
  std::vector<std::string> unlike;  ///< with one value of another axis: another verdict
  std::vector<std::string> like;    ///< the same verdict
};

/// One for each comparison of the plan, and one of its expectations.
std::vector<Verdict> verdicts_of(const ReportTables& tables);

/// The experiment, by name: the axes with their values, the data, the command.
std::vector<std::pair<std::string, std::string>> facts_of(const Results& results,
                                                          const ReportTables& tables);

}  // namespace weft::lab
