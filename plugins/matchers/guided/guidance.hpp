// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>
#include <weft/sdk/matcher.hpp>

namespace weft::guided {

/// The reason why the whole image was searched; the number is the value of diag.fallback.
enum class Fallback {
  none = 0,
  no_previous_shape = 1,
  not_estimated = 2,  ///< the state of the previous shape is another
  doubtful = 3,       ///< its confidence is too small
  few_agree = 4,      ///< too few matches near the predicted places agree with each other
};

/// Decides whether the inputs predict places, by a previous shape of at least this confidence.
Fallback fallback_before(const MatcherInput& in, double least_confidence);

/// The place of each template keypoint [K] in the image if the surface has not moved: its point of
/// the previous shape, projected. NaN for one on no face of the mesh or not in front of the camera.
std::vector<Eigen::Vector2d> predicted_places(const Keypoints& template_keypoints,
                                              const Template& templ, const Camera& camera,
                                              const Shape& previous);

/// How many matches moved from their predicted places as the median of those around them on the
/// template, within a quarter of `radius_px`. Matches to anything, spread evenly over their
/// circles, do so by chance with one in sixteen.
int agreeing_matches(const Correspondences& matches,
                     const std::vector<Eigen::Vector2d>& predicted_px, double radius_px);

/// How many matches the filters of a frame kept.
int kept_matches(const Correspondences& matches);

}  // namespace weft::guided
