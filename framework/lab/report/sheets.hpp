// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lab/report/tables/tables.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// The main table: one row a combination.
TextTable combinations_sheet(const Results& results, const ReportTables& tables);
/// Two values of an axis a row, of one comparison or of all.
TextTable comparison_sheet(const std::vector<ComparisonResult>& comparisons);
/// Each value of the axis against each, the best first; empty for less than three, or if the plan
/// compares all with a reference.
TextTable matrix_sheet(const ComparisonResult& comparison);
/// One row an expectation of the plan.
TextTable expectations_sheet(const Results& results, const ReportTables& tables);
/// One row a combination and filter stage.
TextTable filters_sheet(const Results& results, const ReportTables& tables);
/// One row a ROC curve.
TextTable roc_sheet(const Results& results, const ReportTables& tables);
/// One row for each combination whose frames have a confidence.
TextTable certainty_sheet(const Results& results, const ReportTables& tables);
/// One row a combination whose times were taken: its error and its frames a second.
TextTable speed_sheet(const Results& results, const ReportTables& tables);
/// One row a combination and stage.
TextTable times_sheet(const Results& results, const ReportTables& tables);
/// One row a cell, of those that `cells` names.
TextTable cells_sheet(const Results& results, const std::vector<std::size_t>& cells);

/// The tables that have rows, with every cell of the plan last.
std::vector<TextTable> all_sheets(const Results& results, const ReportTables& tables);

/// The metrics of the plan's table that the main table does not have anyway.
std::vector<std::size_t> shown_metrics(const Results& results, const ReportTables& tables);

/// The command that runs the cell of a key anew and measures it.
std::string run_command(const Results& results, const std::string& key);
std::string command_of(const Results& results, const PlanCell& cell);
/// The command that goes on with the folder, with an option.
std::string ablate_command(const Results& results, const std::string& option);

/// The anchor of what reproduces a combination.
std::string anchor_of(std::size_t combination);

}  // namespace weft::lab
