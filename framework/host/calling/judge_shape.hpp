// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <weft/geometry/evidence_count.hpp>

#include "host/records/record.hpp"

namespace weft::host {

/// Applies the common rule for the state of a shape, state_of(), to the answer of a solver. A shape
/// that the matches or sightlines among `inputs` do not confirm is `weak`. A state other than
/// `estimated` is kept. The evidence is added as `diag.agreeing_matches`, `diag.kept_matches` and
/// `diag.agreeing_coverage`. `memory` is used again.
void judge_shape(Record& shape, std::span<const weft_record> inputs, EvidenceMemory& memory);

}  // namespace weft::host
