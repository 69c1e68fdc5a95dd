// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/report/figures.hpp"

/// The content of each section of a report's page; empty where there is nothing to show.
namespace weft::lab {

std::string verdicts_part(const Results& results, const ReportTables& tables);
std::string compared_part(const Results& results, const ReportTables& tables);
std::string results_part(const Results& results, const ReportTables& tables);
std::string comparisons_part(const Results& results, const ReportTables& tables);
std::string expectations_part(const Results& results, const ReportTables& tables);
std::string filters_part(const Results& results, const ReportTables& tables);
std::string certainty_part(const Results& results, const ReportTables& tables, bool scripted);
std::string times_part(const Results& results, const ReportTables& tables, bool scripted);
std::string reproduce_part(const Results& results, const ReportTables& tables);

// Figures
std::string curves_part(const ReportTables& tables, const Figures& figures);
std::string sweeps_part(const Results& results, const Figures& figures);
std::string scores_part(const ReportTables& tables);
std::string worst_part(const Results& results, const Figures& figures);
std::string viewer_part(const Figures& figures);

}  // namespace weft::lab
