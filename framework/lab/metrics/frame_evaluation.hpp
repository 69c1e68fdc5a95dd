// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lab/metrics/metrics.hpp"
#include "lab/metrics/runs/run_reader.hpp"
#include "lab/metrics/shapes/shape_meter.hpp"

namespace weft::lab {

/// All metrics of one frame by itself.
Result<FrameMetrics> evaluate_frame(const RunReader& reader, const ShapeMeter& meter,
                                    const FrameLine& line, const FrameRecords& records,
                                    const EvaluationOptions& options);

}  // namespace weft::lab
