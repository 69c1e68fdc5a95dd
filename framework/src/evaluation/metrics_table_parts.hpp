// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/evaluation/metrics.hpp>

namespace weft::evaluation {

inline constexpr const char* kNoValue = "-";

/// With so many decimals; kNoValue for what is not finite.
std::string decimal(double value, int decimals);

/// Lines of the table of a run; empty where there is nothing to say.
std::string visibility_text(const VisibilityMetrics& visibility);
std::string certainty_text(const CertaintyMetrics& certainty);

}  // namespace weft::evaluation
