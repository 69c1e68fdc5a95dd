// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/sift_parameters.hpp"

namespace weft::sift_fast {

constexpr int kDescriptorLength = 128;

using Settings = detectors::SiftSettings;

}  // namespace weft::sift_fast
