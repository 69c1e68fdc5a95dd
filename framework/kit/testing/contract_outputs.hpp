// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_cases.hpp"
#include "kit/testing/contract_checks.hpp"

namespace weft::testing {

/// Checks that an answer conforms to the contract: no broken output, and a reason for each status
/// other than ok. The host has compared lengths and types with the catalogue.
void check_answer(const Answer& answer, Checks& checks);

/// True if the outputs are empty: no keypoint, no match, no match that is kept, no sightline.
bool is_nothing(const Answer& answer);

/// Checks the properties that a stage's records guarantee beyond the catalogue.
void check_outputs(const Subject& subject, const Case& given, const Answer& answer, Checks& checks);

}  // namespace weft::testing
