// SPDX-License-Identifier: Apache-2.0
#include "floor.hpp"

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>
#include <weft/core/stop_check.hpp>

#include "fixed_point.hpp"
#include "palette.hpp"
#include "text.hpp"

namespace weft::overlay {
namespace {

constexpr double kReach = 1.25;  // reach of the floor, in radii

bool is_near(const cv::Point2d& p, const cv::Mat& canvas) {  // false for NaN
  return std::abs(p.x) < 10.0 * canvas.cols && std::abs(p.y) < 10.0 * canvas.rows;
}

/// Moves each pixel towards `colour` by mask / 255 * opacity.
void lay(cv::Mat canvas, const cv::Mat1b& mask, const cv::Scalar& colour, double opacity) {
  for (int y = 0; y < canvas.rows; ++y) {
    const std::uint8_t* const covered = mask[y];
    auto* const pixels = canvas.ptr<cv::Vec3b>(y);
    for (int x = 0; x < canvas.cols; ++x) {
      if (covered[x] == 0) continue;
      const double share = covered[x] * opacity / 255.0;
      for (int k = 0; k < 3; ++k) {
        std::uint8_t& value = pixels[x][k];
        value = cv::saturate_cast<std::uint8_t>(value + share * (colour[k] - value));
      }
    }
  }
}

/// A floor during its rendering; points are m from the middle along x and z.
struct Floor {
  const Orbit& orbit;
  double floor_m, reach_m;
  cv::Mat1b& mask;

  cv::Point at(double x_m, double z_m) const {
    const Eigen::Vector3d middle_m = orbit.middle_m();
    return fixed_point(
        orbit.project(orbit.moved({middle_m.x() + x_m, floor_m, middle_m.z() + z_m})));
  }

  /// A line along z (or x) in pieces, each as strong as it is near the middle.
  void line(double across_m, bool along_z, int width_px) const {
    constexpr int kPieces = 24;
    const double half_m = std::sqrt(std::max(0.0, reach_m * reach_m - across_m * across_m));
    for (int piece = 0; piece < kPieces; ++piece) {
      const double from_m = half_m * (2.0 * piece / kPieces - 1.0);
      const double to_m = half_m * (2.0 * (piece + 1) / kPieces - 1.0);
      const double out = std::hypot(across_m, 0.5 * (from_m + to_m)) / reach_m;
      const auto end = [&](double m) { return along_z ? at(across_m, m) : at(m, across_m); };
      cv::line(mask, end(from_m), end(to_m), {255.0 * (1.0 - out * out)}, width_px, cv::LINE_AA,
               kShift);
    }
  }
};

}  // namespace

double floor_step_m(double radius_m) {
  const double decade = std::pow(10.0, std::floor(std::log10(radius_m / 3.0)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * decade <= radius_m / 3.0) return factor * decade;
  }
  return decade;
}

std::string length_text(double length_m) {
  const auto whole = [&](double factor) { return std::to_string(std::llround(length_m * factor)); };
  if (length_m >= 1.0) return whole(1.0) + " m";
  return length_m >= 0.01 ? whole(100.0) + " cm" : whole(1000.0) + " mm";
}

void draw_floor(cv::Mat& canvas, const Orbit& orbit, double floor_m, double radius_m,
                double step_m) {
  cv::Mat1b mask(canvas.size(), 0);
  const Floor floor{orbit, floor_m, kReach * radius_m, mask};
  const int width_px = std::max(1, canvas.rows / 700);
  const Eigen::Vector3d middle_m = orbit.middle_m();
  for (const bool along_z : {false, true}) {
    const double offset_m = along_z ? middle_m.x() : middle_m.z();
    const auto first = static_cast<int>(std::ceil((offset_m - floor.reach_m) / step_m));
    for (int i = first; i * step_m < offset_m + floor.reach_m; ++i) {
      floor.line(i * step_m - offset_m, along_z, width_px);
    }
  }
  lay(canvas, mask, kInk, 0.2);
}

void draw_shadow(cv::Mat& canvas, const Orbit& orbit, double floor_m, const Points3View& vertices_m,
                 const FacesView& faces) {
  cv::Mat1b mask(canvas.size(), 0);
  const cv::Rect whole({}, canvas.size());
  cv::Rect covered;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 30);
    std::array<cv::Point, 3> corners;
    bool drawable = true;
    for (std::size_t k = 0; k < 3; ++k) {
      Eigen::Vector3d point_m = vertices_m.row(faces(f, static_cast<Eigen::Index>(k)));
      point_m.y() = floor_m;
      const Eigen::Vector3d moved_m = orbit.moved(point_m);
      const cv::Point2d at_px = orbit.project(moved_m);
      drawable = drawable && moved_m.z() > 0.1 * orbit.distance_m() && is_near(at_px, canvas);
      if (drawable) corners[k] = fixed_point(at_px);
    }
    if (!drawable) continue;
    cv::fillConvexPoly(mask, corners.data(), 3, {255}, cv::LINE_8, kShift);
    for (const cv::Point& corner : corners) {
      covered |= cv::Rect(corner.x >> kShift, corner.y >> kShift, 2, 2);
    }
  }
  const double blur_px = 0.012 * canvas.rows;
  const int reach_px = cvCeil(3.0 * blur_px) + 1;
  covered = cv::Rect(covered.tl() - cv::Point(reach_px, reach_px),
                     covered.br() + cv::Point(reach_px, reach_px)) &
            whole;
  if (covered.empty()) return;
  cv::Mat1b blurred;
  cv::GaussianBlur(mask(covered), blurred, {}, blur_px, blur_px,
                   cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
  lay(canvas(covered), blurred, kInk, 0.28);
}

}  // namespace weft::overlay
