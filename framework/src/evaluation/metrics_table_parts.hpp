// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <weft/evaluation/metrics.hpp>

/// Lines of the table of a run; empty where there is nothing to say.
namespace weft::evaluation {

std::string visibility_text(const VisibilityMetrics& visibility);
std::string certainty_text(const CertaintyMetrics& certainty);

}  // namespace weft::evaluation
