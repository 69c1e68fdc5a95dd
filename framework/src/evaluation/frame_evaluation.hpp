// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <weft/evaluation/metrics.hpp>
#include <weft/evaluation/run_reader.hpp>
#include <weft/evaluation/shape_meter.hpp>

namespace weft::evaluation {

/// All that can be said of one frame by itself.
Result<FrameMetrics> evaluate_frame(const RunReader& reader, const ShapeMeter& meter,
                                    const FrameLine& line, const FrameRecords& records,
                                    const EvaluationOptions& options);

}  // namespace weft::evaluation
