// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "metrics/metrics.hpp"

namespace weft::evaluation {

inline constexpr const char* kNoValue = "-";

/// With so many decimals; kNoValue for what is not finite.
std::string decimal(double value, int decimals);

/// Text from a file on one line: control characters could move a terminal's cursor.
std::string printable(std::string text);

/// Lines of the table of a run; empty where there is nothing to say.
std::string visibility_text(const VisibilityMetrics& visibility);
std::string certainty_text(const CertaintyMetrics& certainty);

}  // namespace weft::evaluation
