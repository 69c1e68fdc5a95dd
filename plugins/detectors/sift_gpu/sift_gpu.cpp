// SPDX-License-Identifier: Apache-2.0
#include "detector.hpp"
#include "matcher.hpp"

WEFT_LIBRARY(WEFT_COMPONENT(weft::sift_gpu::SiftGpu, "detectors/sift_gpu", "1.0.0",
                            "Finds SIFT keypoints on an OpenCL device, as detectors/sift does on "
                            "the processor."),
             WEFT_COMPONENT(weft::sift_gpu::GpuMatcher, "matchers/gpu", "1.0.0",
                            "Matches keypoints by their nearest descriptor with Lowe's ratio test "
                            "on an OpenCL device, exactly."))
