// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/template.hpp>

#include "prediction.hpp"

namespace weft::mask {

struct SeedOptions {
  double band_px = 15.0;    ///< [] px of the image, on either side of the predicted outline
  double agreement = 25.0;  ///< [] grey levels by which the rendered template may differ
};

/// Knowledge about the pixels of a reduced crop before the cut.
struct Seeds {
  cv::Mat labels;          ///< u8, cv::GC_BGD, GC_PR_BGD, GC_PR_FGD or GC_FGD
  cv::Mat occluded;        ///< u8, 255 where an occluder is, or near it
  double agreement = 1.0;  ///< [] share of the inner pixels that show the texture
};

/// Seeds from a shape. Inner pixels that look like the rendered template, up to a gain that changes
/// slowly, are object. Other pixels that connect to the inside are an occluder. Pixels further than
/// the band outside are background, and the rest is decided by the cut.
Seeds seeds_of_shape(const Rendering& rendering, const Template& templ, const cv::Mat& grey,
                     double scale, const SeedOptions& options);

/// Seeds from matches: the convex hull of the kept ones is object, and the band is three times as
/// wide.
Seeds seeds_of_matches(const Rendering& rendering, const Correspondences& matches, const Crop& crop,
                       const SeedOptions& options);

}  // namespace weft::mask
