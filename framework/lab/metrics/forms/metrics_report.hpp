// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lab/metrics/metrics.hpp"

namespace weft::lab {

/// Everything as JSON, indented, the same bytes for the same metrics. Units are in the names;
/// unknown values are null.
std::string to_json(const RunMetrics& metrics);

/// The readable tables: counts, then errors in millimetres, one row a group. Excluded rows and
/// frames with an old shape follow in separate parts. UTF-8, ends with a line break.
std::string to_table(const RunMetrics& metrics);

/// The part of it with the 3D errors alone, for a further alignment.
std::string to_error_table(const RunMetrics& metrics);

/// One row a frame: state, errors, and at the end the frames with the largest errors.
std::string to_frames_table(const RunMetrics& metrics);

/// metrics.json, or metrics_scale.json and metrics_rigid.json for aligned errors: the file in a run
/// folder never mixes them.
std::string metrics_file_name(Alignment alignment);

/// One row a frame, as comma-separated values with a header; unknown values are empty.
std::string to_csv(const RunMetrics& metrics);

/// Write a file, which appears whole: it is renamed from a temporary name beside it.
Result<void> write_json(const RunMetrics& metrics, const std::string& file);
Result<void> write_csv(const RunMetrics& metrics, const std::string& file);

}  // namespace weft::lab
