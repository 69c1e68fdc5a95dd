// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lab/report/runs/run_data.hpp"
#include "lab/report/text/page.hpp"
#include "lab/report/text/text_table.hpp"

namespace weft::lab {

/// Sentences on the results of a run: the number of frames with a shape, their errors, their times,
/// and the warnings about its set-up.
std::vector<std::string> sentences_of(const RunData& run);

/// One row for each stage and reason for which it had no result.
TextTable reasons_sheet(const RunData& run);
/// One row a stage.
TextTable stages_sheet(const RunData& run);
/// One row a frame.
TextTable frames_sheet(const RunData& run);

/// Content of the page of a run; `scripted`: with places for figures.
Page page_of(const RunData& run, bool scripted);

/// The figures' data as JSON that may stand inside a script element; arrays are base64 of
/// little-endian f32 or u32.
std::string to_json(const RunData& run);

}  // namespace weft::lab
