// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/metrics/metrics.hpp"

namespace weft::lab {

inline constexpr const char* kNoValue = "-";

/// The number with `decimals` decimals; kNoValue if it is not finite.
std::string decimal(double value, int decimals);

using TableRow = std::vector<std::string>;

/// Rows of cells as aligned columns: the first to the left, the others to the right.
std::string align(const std::vector<TableRow>& rows);

/// Text from a file on one line: control characters could move a terminal's cursor.
std::string printable(std::string text);

/// Lines of the table of a run; empty if there are no such figures.
std::string surfaces_text(const RunMetrics& metrics);
std::string visibility_text(const VisibilityMetrics& visibility);
std::string registration_text(const RegistrationMetrics& registration);
std::string certainty_text(const CertaintyMetrics& certainty);

}  // namespace weft::lab
