// SPDX-License-Identifier: Apache-2.0
#include "detector.hpp"
#include "matcher.hpp"

using weft::sift_gpu::GpuMatcher;
using weft::sift_gpu::SiftGpu;
WEFT_LIBRARY(WEFT_COMPONENT(SiftGpu, "detectors/sift_gpu", "1.0.0",
                            "Finds SIFT keypoints on an OpenCL device, as detectors/sift does on "
                            "the processor."),
             WEFT_COMPONENT(GpuMatcher, "matchers/gpu", "1.0.0",
                            "Matches keypoints by their nearest descriptor with Lowe's ratio test "
                            "on an OpenCL device, exactly."))
