// SPDX-License-Identifier: Apache-2.0
#include "detector.hpp"
#include "matcher.hpp"

using weft::sift_gpu::GpuMatcher;
using weft::sift_gpu::SiftGpu;
WEFT_LIBRARY(WEFT_COMPONENT(SiftGpu, "detectors/sift_gpu", "1.0.0",
                            "Detects the SIFT keypoints of detectors/sift on an OpenCL device."),
             WEFT_COMPONENT(GpuMatcher, "matchers/gpu", "1.0.0",
                            "Matches keypoints to the nearest descriptor with Lowe's ratio test, "
                            "exactly, on an OpenCL device."))
