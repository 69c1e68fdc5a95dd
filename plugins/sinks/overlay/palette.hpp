// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <opencv2/core.hpp>

namespace weft::overlay {

// Colours are BGR.
inline const cv::Scalar kPaper{250, 249, 248};  ///< behind words and the side view
inline const cv::Scalar kInk{46, 40, 36};
inline const cv::Scalar kFaintInk{128, 118, 110};

/// Orange at 0, yellow at 1/2, blue at 1. Readers with any kind of colour blindness can distinguish
/// them: blue and yellow differ without red and green, and the rest differs in brightness.
inline cv::Scalar colour_of_confidence(double confidence) {
  const cv::Scalar low(36, 92, 226), middle(84, 206, 244), high(226, 142, 38);
  const double c = confidence >= 0.0 ? std::min(confidence, 1.0) : 0.0;  // NaN is none
  return c < 0.5 ? low * (1.0 - 2.0 * c) + middle * (2.0 * c)
                 : middle * (2.0 - 2.0 * c) + high * (2.0 * c - 1.0);
}

}  // namespace weft::overlay
