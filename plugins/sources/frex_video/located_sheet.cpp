// SPDX-License-Identifier: Apache-2.0
#include "located_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::frex_video {
namespace {

constexpr int kBeyondHull_mm = 10;
constexpr double kMostLeaveOneOut_px = 1.0;

SheetSightings sightings_of(const MarkerSheet& sheet, const SheetWarp& warp,
                            const Points3& rough_centres_m) {
  const auto count = static_cast<Eigen::Index>(warp.markers.size());
  SheetSightings sightings{Points2(4 * count, 2), Points2(4 * count, 2), Points2(count, 2),
                           rough_centres_m};
  for (Eigen::Index i = 0; i < count; ++i) {
    const SeenMarker& seen = warp.markers[to_index(i)];
    const SheetMarker& marker = sheet.markers[seen.marker];
    sightings.corners_m.middleRows<4>(4 * i) = kMetre * marker.corners_mm;
    sightings.corners_px.middleRows<4>(4 * i) = seen.corners_px;
    sightings.centres_m.row(i) = kMetre * marker.centre_mm().transpose();
  }
  return sightings;
}

cv::Mat1b known_part(const MarkerSheet& sheet, const std::vector<SeenMarker>& markers) {
  std::vector<cv::Point> corners, hull;
  for (const SeenMarker& seen : markers) {
    const Points2& corners_mm = sheet.markers[seen.marker].corners_mm;
    for (int k = 0; k < 4; ++k) {
      corners.emplace_back(static_cast<int>(std::lround(corners_mm(k, 0))),
                           static_cast<int>(std::lround(corners_mm(k, 1))));
    }
  }
  cv::convexHull(corners, hull);
  cv::Mat1b known(static_cast<int>(std::ceil(sheet.height_mm)) + 1,
                  static_cast<int>(std::ceil(sheet.width_mm)) + 1, std::uint8_t{0});
  cv::fillConvexPoly(known, hull, cv::Scalar(1));
  constexpr int kWidth = 2 * kBeyondHull_mm + 1;
  cv::dilate(known, known, cv::getStructuringElement(cv::MORPH_ELLIPSE, {kWidth, kWidth}));
  return known;
}

}  // namespace

bool LocatedSheet::is_known(const Eigen::Vector2d& point_mm) const {
  const auto clamped = [](double value, int size) {
    return static_cast<int>(std::lround(std::clamp(value, 0.0, size - 1.0)));
  };
  return known(clamped(point_mm.y(), known.rows), clamped(point_mm.x(), known.cols)) != 0;
}

Result<LocatedSheet> locate_sheet(const MarkerFinder& finder, const cv::Mat& grey,
                                  const Pinhole& camera, const LocateOptions& options) {
  const MarkerSheet& sheet = finder.sheet();
  auto warp = fit_warp(sheet, finder.find(grey), options.min_markers, options.max_marker_error_px);
  if (!warp) return warp.error();
  if (warp->leave_one_out_px > kMostLeaveOneOut_px) {
    return no_result(
        "the markers do not lie on a smooth surface: check that the page is not creased, and that "
        "the layout belongs to it");
  }
  Points3 rough_m(static_cast<Eigen::Index>(warp->markers.size()), 3);
  for (Eigen::Index i = 0; i < rough_m.rows(); ++i) {
    const SeenMarker& seen = warp->markers[to_index(i)];
    rough_m.row(i) = marker_centre_m(sheet.markers[seen.marker], seen, camera).transpose();
  }
  auto surface = SheetSurface::fit(kMetre * Eigen::Vector2d(sheet.width_mm, sheet.height_mm),
                                   sightings_of(sheet, *warp, rough_m), camera);
  if (!surface) return surface.error();
  const cv::Mat1b known = known_part(sheet, warp->markers);
  return LocatedSheet{*std::move(warp), std::move(rough_m), *std::move(surface), known};
}

}  // namespace weft::frex_video
