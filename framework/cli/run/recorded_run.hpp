// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/runs/run.hpp"

namespace weft::cli {

/// What the lines of a frames.jsonl tell of a run. Fails where the file cannot be read or a line of
/// it is none of a run, with its number.
Result<RecordedRun> recorded_run(const std::string& file);

}  // namespace weft::cli
