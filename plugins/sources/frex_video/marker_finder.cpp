// SPDX-License-Identifier: Apache-2.0
#include "marker_finder.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::frex_video {
namespace {

double cross(const Eigen::RowVector2d& a, const Eigen::RowVector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Clockwise and convex, as the front of the marker is seen.
bool is_front(const Points2& corners) {
  for (int k = 0; k < 4; ++k) {
    const Eigen::RowVector2d side = corners.row((k + 1) % 4) - corners.row(k);
    const Eigen::RowVector2d next = corners.row((k + 2) % 4) - corners.row((k + 1) % 4);
    if (!(cross(side, next) > 0.0)) return false;
  }
  return true;
}

/// Where the diagonals of a convex quadrilateral meet.
Eigen::Vector2d diagonals_meet(const Points2& corners) {
  const Eigen::RowVector2d first = corners.row(2) - corners.row(0);
  const Eigen::RowVector2d second = corners.row(3) - corners.row(1);
  const double t = cross(corners.row(1) - corners.row(0), second) / cross(first, second);
  return (corners.row(0) + t * first).transpose();
}

/// Moves corners to where the gradients meet. The window ends half a pixel before the next corners,
/// one module away, to which the corners of a larger one may run.
void refine(const cv::Mat& grey, int modules, std::vector<cv::Point2f>& corners) {
  double shortest_px = std::numeric_limits<double>::max();
  for (std::size_t k = 0; k < 4; ++k) {
    shortest_px = std::min(shortest_px, cv::norm(corners[(k + 1) % 4] - corners[k]));
  }
  const int half = std::clamp(static_cast<int>(shortest_px / modules - 0.5), 2, 8);
  cv::cornerSubPix(grey, corners, {half, half}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 1e-3});
}

}  // namespace

MarkerFinder::MarkerFinder(MarkerSheet sheet)
    : sheet_(std::move(sheet)),
      dictionary_(cv::aruco::getPredefinedDictionary(
          sheet_.dictionary == "4x4_250" ? cv::aruco::DICT_4X4_250 : cv::aruco::DICT_5X5_250)),
      parameters_(cv::aruco::DetectorParameters::create()) {
  for (std::size_t i = 0; i < sheet_.markers.size(); ++i) marker_of_id_[sheet_.markers[i].id] = i;
  parameters_->minMarkerPerimeterRate = 0.02;
}

std::vector<SeenMarker> MarkerFinder::find(const cv::Mat& grey) const {
  std::vector<std::vector<cv::Point2f>> quadrilaterals;
  std::vector<int> ids;
  cv::aruco::detectMarkers(grey, dictionary_, quadrilaterals, ids, parameters_);
  std::map<int, int> times;
  for (const int id : ids) ++times[id];
  std::vector<SeenMarker> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    const auto marker = marker_of_id_.find(ids[i]);
    if (times[ids[i]] > 1 || marker == marker_of_id_.end()) continue;
    refine(grey, dictionary_->markerSize + 2, quadrilaterals[i]);
    SeenMarker seen{marker->second, Points2(4, 2), {}};
    for (int k = 0; k < 4; ++k) {
      const cv::Point2f& corner = quadrilaterals[i][to_index(k)];
      seen.corners_px.row(k) << corner.x, corner.y;
    }
    if (!is_front(seen.corners_px)) continue;
    seen.centre_px = diagonals_meet(seen.corners_px);
    found.push_back(std::move(seen));
  }
  std::sort(found.begin(), found.end(),
            [](const SeenMarker& a, const SeenMarker& b) { return a.marker < b.marker; });
  return found;
}

Eigen::Vector3d marker_centre_m(const SheetMarker& marker, const SeenMarker& seen,
                                const Pinhole& camera) {
  const Eigen::Vector2d centre_mm = marker.centre_mm();
  std::vector<cv::Point3d> object_m;
  std::vector<cv::Point2d> image_px;
  for (int k = 0; k < 4; ++k) {
    object_m.emplace_back(0.001 * (marker.corners_mm(k, 0) - centre_mm.x()),
                          0.001 * (marker.corners_mm(k, 1) - centre_mm.y()), 0.0);
    image_px.emplace_back(seen.corners_px(k, 0), seen.corners_px(k, 1));
  }
  const cv::Matx33d matrix(camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0);
  cv::Vec3d rotation, translation_m;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!cv::solvePnP(object_m, image_px, matrix, cv::noArray(), rotation, translation_m, false,
                    cv::SOLVEPNP_IPPE)) {
    return Eigen::Vector3d::Constant(kNone);
  }
  cv::solvePnPRefineLM(object_m, image_px, matrix, cv::noArray(), rotation, translation_m);
  if (!(translation_m[2] > 0.0)) return Eigen::Vector3d::Constant(kNone);
  return {translation_m[0], translation_m[1], translation_m[2]};
}

}  // namespace weft::frex_video
