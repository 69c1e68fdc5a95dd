// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kit/conformance/conformance.hpp"

/// Results of `weft plugins check` in all output formats.
namespace weft::cli {

nlohmann::ordered_json report_json(const std::vector<conformance::Report>& reports,
                                   std::uint64_t seed);

/// As JUnit has it: a suite for each component, a case for each check.
std::string report_junit(const std::vector<conformance::Report>& reports);

/// Lines of a component; with `verbose` each check has a line.
void print_report(const conformance::Report& report, bool verbose);
void print_summary(const std::vector<conformance::Report>& reports);

/// All checks as a table in Markdown.
void print_check_list();

}  // namespace weft::cli
