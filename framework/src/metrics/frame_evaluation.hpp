// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "metrics/metrics.hpp"
#include "metrics/runs/run_reader.hpp"
#include "metrics/shapes/shape_meter.hpp"

namespace weft::evaluation {

/// All that can be said of one frame by itself.
Result<FrameMetrics> evaluate_frame(const RunReader& reader, const ShapeMeter& meter,
                                    const FrameLine& line, const FrameRecords& records,
                                    const EvaluationOptions& options);

}  // namespace weft::evaluation
