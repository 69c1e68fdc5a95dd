// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>
#include <weft/generators/marker_sheet.hpp>
#include <weft/geometry/camera_model.hpp>

namespace cv::aruco {
class Dictionary;
struct DetectorParameters;
}  // namespace cv::aruco

namespace weft::frex_video {

/// A marker of the layout in an image.
struct SeenMarker {
  std::size_t marker = 0;     ///< [] index in the layout
  Points2 corners_px{};       ///< [4,2] px, in the order of the layout's
  Eigen::Vector2d centre_px;  ///< [2] px, where the diagonals meet: the image of the centre
};

/// Finds the markers of a sheet of paper in images, with sub-pixel corners (Garrido-Jurado et al.
/// 2014).
class MarkerFinder {
 public:
  explicit MarkerFinder(MarkerSheet sheet);

  /// The markers in a grey image u8, by their index in the layout. Omits ids that the image shows
  /// twice or that the layout does not have, and mirrored markers.
  std::vector<SeenMarker> find(const cv::Mat& grey) const;

  const MarkerSheet& sheet() const { return sheet_; }

 private:
  MarkerSheet sheet_;
  std::map<int, std::size_t> marker_of_id_;
  cv::Ptr<cv::aruco::Dictionary> dictionary_;
  cv::Ptr<cv::aruco::DetectorParameters> parameters_;
};

/// The centre of a marker in the camera frame, m, from its four corners alone: planar pose (Collins
/// and Bartoli, Infinitesimal Plane-based Pose Estimation, IJCV 2014) refined by reprojection. NaN
/// where there is none in front of the camera.
Eigen::Vector3d marker_centre_m(const SheetMarker& marker, const SeenMarker& seen,
                                const Pinhole& camera);

}  // namespace weft::frex_video
