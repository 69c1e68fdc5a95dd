// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "common/view/patch.hpp"
#include "common/view/picture.hpp"
#include "common/view/predicted_view.hpp"

namespace weft::refine {

/// The result for a match.
enum class Fate {
  refined,
  hidden,  ///< no patch around it, or beside it, is completely on the surface, in the image and
           ///< visible
  flat,    ///< its patch has no structure along some direction
  unlike,  ///< the image does not look like its patch, or the search did not converge
  far,     ///< the patch lies elsewhere: more than the largest step away
};
inline constexpr int kFates = 5;

struct Refinement {
  Fate fate = Fate::hidden;
  Eigen::Vector2d seen_px = Eigen::Vector2d::Zero();         ///< [2] px, where fate is refined
  Eigen::Matrix2d covariance_px2 = Eigen::Matrix2d::Zero();  ///< [2,2] px^2, of seen_px
};

struct RefineOptions {
  double min_correlation = 0.8;  ///< []
  double max_step_px = 2.0;      ///< [] px
};

/// Searches near `seen_px`, the image point of a match, for the piece of the view around
/// `expected_px`, the projection of the point by the shape. Both are finite, in px of the image.
/// The search minimises over the displacement (view::Patch); the point moves as its patch does.
Refinement refine(const view::PredictedView& view, const view::Picture& image,
                  const Eigen::Vector2d& expected_px, const Eigen::Vector2d& seen_px,
                  const RefineOptions& options);

}  // namespace weft::refine
