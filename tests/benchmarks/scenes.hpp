// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <weft/data/keypoints.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/sightlines.hpp>
#include <weft/testing/synthetic.hpp>

#include "host/records/record.hpp"

namespace weft::bench {

/// A bent surface in a 640x480 image, with the inputs of the stages. It has 10 x 6 vertices by
/// default.
struct SheetScene {
  Camera camera = testing::make_camera();
  Template templ;
  Points3 truth_m;  ///< [V,3] m, camera frame
  Shape previous;   ///< slightly different pose
  Sightlines sightlines;

  explicit SheetScene(const testing::SheetSpec& sheet = {});

  /// Matches with noise of half a pixel; `correct_rate` is the share of inliers.
  Correspondences matches(int count, double correct_rate) const;
};

/// Random descriptors like SIFT's: 128 whole numbers that together have the length 512.
Keypoints descriptors(int count, std::uint64_t seed);

/// Random descriptors; the first half of the template's descriptors appear as noisy copies.
Keypoints descriptors_seen(const Keypoints& templ, int count, std::uint64_t seed);

/// The first frame of sources/synthetic: a textured surface before a cluttered background, 640x480.
host::RecordPtr synthetic_image();

}  // namespace weft::bench
