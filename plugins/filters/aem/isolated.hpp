// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "matches.hpp"

namespace weft::aem {

/// Matches that seem correct amid others that do not.
struct Isolated {
  explicit Isolated(Eigen::Index matches)
      : is(Eigen::Array<bool, Eigen::Dynamic, 1>::Constant(matches, false)),
        shift(Eigen::ArrayXd::Zero(matches)) {}

  Eigen::Array<bool, Eigen::Dynamic, 1> is;  ///< [n]
  Eigen::ArrayXd shift;  ///< [n] shift of the log odds, by the share of inliers around; 0 if not
                         ///< isolated
};

/// If it stays in a fit, an isolated match bends the warp to itself and then appears to be an
/// inlier. Where the object is hidden and copies of it are visible, one match to a copy turns up
/// the corner of the warp. `share` is the share of inliers in all matches.
Isolated find_isolated(const Matches& matches, const Eigen::ArrayXd& logit, double share);

}  // namespace weft::aem
