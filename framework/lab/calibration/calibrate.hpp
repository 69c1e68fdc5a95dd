// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>
#include <weft/core/result.hpp>

#include "lab/calibration/coverage.hpp"
#include "lab/calibration/solution.hpp"
#include "lab/calibration/view.hpp"

namespace weft::calibration {

inline constexpr std::size_t kMostViews = 40;

/// A camera, from views that were chosen.
struct Calibration {
  ImageSize size;
  std::vector<View> views;       ///< those that were used
  std::vector<std::string> odd;  ///< names of omitted views, which do not fit the others
  std::size_t found = 0;         ///< views that were there to be chosen from
  Coverage coverage;
  Solution solution;
};

/// Chooses at most kMostViews views, fits a camera with 0, 4, 5 or 8 coefficients of distortion,
/// and once more without the views that fit much worse than the others. Errc::no_result, with the
/// reason and what to do, where the views do not determine a camera that can be trusted.
Result<Calibration> calibrate(const std::vector<View>& views, const ImageSize& size,
                              int coefficients);

}  // namespace weft::calibration
