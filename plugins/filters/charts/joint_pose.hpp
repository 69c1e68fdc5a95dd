// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/types.hpp>

namespace weft::charts {

/// Kept matches of all charts, those of one chart in a row: points of the object at rest and where
/// they are seen.
struct RestMatches {
  Points3 points_m;        ///< [N,3] m, template frame
  Points3 normals;         ///< [N,3] unit normals of the faces, outwards
  Points2 pixels;          ///< [N,2] px
  std::vector<int> chart;  ///< [N] chart of the match
};

/// Where the object would be if it were rigid, by the charts that agree with each other.
struct JointPose {
  Eigen::Matrix3d rotation;       ///< [3,3] camera from template
  Eigen::Vector3d translation_m;  ///< [3] m, camera frame
  double tolerance_px = 0.0;      ///< [] px, largest residual of a match that fits
};

/// The rigid pose that fits most matches within `rigid_tolerance` times the object's size in the
/// image. Nothing for fewer than 6 matches, for matches in one place, and where no pose fits.
std::optional<JointPose> joint_pose(const RestMatches& matches, const Template& templ,
                                    const Camera& camera, double rigid_tolerance);

/// Residuals [N] px of matches; infinite behind the camera.
Eigen::VectorXd residuals_px(const JointPose& pose, const RestMatches& matches,
                             const Camera& camera);

/// Returns whether a chart fits the pose: at least half of its matches are within the tolerance,
/// and its surface does not face away from the camera.
bool fits(const JointPose& pose, const RestMatches& matches, const Eigen::VectorXd& residuals_px,
          int chart);

}  // namespace weft::charts
