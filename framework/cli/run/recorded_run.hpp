// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "pipeline/runs/run.hpp"

namespace weft::cli {

/// Summary of a run from the lines of its frames.jsonl. Fails if the file cannot be read or if a
/// line is not part of a run; the error has the line number.
Result<RecordedRun> recorded_run(const std::string& file);

}  // namespace weft::cli
