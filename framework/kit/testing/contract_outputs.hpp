// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kit/testing/contract_cases.hpp"
#include "kit/testing/contract_checks.hpp"

namespace weft::testing {

/// That an answer is one that the contract knows: no broken output, and a reason for whatever is
/// not ok. The host has compared lengths and types with the catalogue.
void check_answer(const Answer& answer, Checks& checks);

/// Whether the outputs hold nothing: no keypoint, no match, no match that is kept, no sightline.
bool is_nothing(const Answer& answer);

/// What the records that a stage makes promise beyond the catalogue.
void check_outputs(const Subject& subject, const Case& given, const Answer& answer, Checks& checks);

}  // namespace weft::testing
