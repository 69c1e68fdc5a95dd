// SPDX-License-Identifier: Apache-2.0
#include "sheet_view.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace weft::photo {
namespace {

constexpr double kLeastSide_px = 16.0;
constexpr double kLeastSine = 0.035;  // two degrees

std::string text_of(const Eigen::Vector2d& place) {
  return "(" + std::to_string(std::lround(place.x())) + ", " +
         std::to_string(std::lround(place.y())) + ")";
}

Error wrong(const std::string& message) { return {Errc::invalid_value, message, {}}; }

/// H of SheetView, in closed form (Heckbert, Fundamentals of texture mapping and image warping,
/// 1989, section 2.2.3).
Eigen::Matrix3d square_to_corners(const Corners& p) {
  const Eigen::Vector2d d1 = p[1] - p[2], d2 = p[3] - p[2], sum = p[0] - p[1] + p[2] - p[3];
  const double area = cross(d1, d2);
  const double g = cross(sum, d2) / area, h = cross(d1, sum) / area;
  const Eigen::Vector2d u = p[1] - p[0] + g * p[1], v = p[3] - p[0] + h * p[3];
  Eigen::Matrix3d homography;
  homography << u.x(), v.x(), p[0].x(), u.y(), v.y(), p[0].y(), g, h, 1.0;
  return homography;
}

Eigen::Matrix3d inverse_of(const Pinhole& c) {
  Eigen::Matrix3d inverse;
  inverse << 1.0 / c.fx, 0.0, -c.cx / c.fx, 0.0, 1.0 / c.fy, -c.cy / c.fy, 0.0, 0.0, 1.0;
  return inverse;
}

/// The same pinhole with another focal length.
Pinhole with_focal_length(Pinhole camera, double focal_px) {
  camera.fx = camera.fy = focal_px;
  return camera;
}

/// The variance of the skew that errors of half a pixel in each corner cause.
double skew_variance(const Corners& corners_px, const Pinhole& camera, double skew_rad) {
  constexpr double kCornerError_px = 0.5, kLeast = 1e-12;
  double variance = kLeast;
  for (std::size_t k = 0; k < corners_px.size(); ++k) {
    for (const Eigen::Vector2d& by :
         {Eigen::Vector2d(kCornerError_px, 0.0), Eigen::Vector2d(0.0, kCornerError_px)}) {
      Corners moved = corners_px;
      moved[k] += by;
      variance += std::pow(view_of_sheet(moved, camera).skew_rad - skew_rad, 2);
    }
  }
  return variance;
}

}  // namespace

const char* name_of_corner(std::size_t corner) {
  constexpr std::array kNames{"top left", "top right", "bottom right", "bottom left"};
  return kNames[corner];
}

double signed_area_px2(const Corners& p) { return 0.5 * cross(p[2] - p[0], p[3] - p[1]); }

Result<void> check_corners(const Corners& p) {
  std::size_t turns_back = 0, back_at = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d side = p[(k + 1) % 4] - p[k];
    if (!(side.norm() >= kLeastSide_px)) {
      return wrong("the " + std::string(name_of_corner(k)) + " and the " +
                   name_of_corner((k + 1) % 4) +
                   " corner are closer than 16 px: give four different corners, or a photograph "
                   "that shows the object larger");
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d to = p[k] - p[(k + 3) % 4], from = p[(k + 1) % 4] - p[k];
    const double sine = cross(to, from) / (to.norm() * from.norm());
    if (!(std::abs(sine) >= kLeastSine)) {  // nor where it is not finite
      return wrong("the " + std::string(name_of_corner(k)) + " corner " + text_of(p[k]) +
                   " lies on a line with its neighbours: these are no corners of a rectangle");
    }
    if (sine < 0.0) ++turns_back, back_at = k;
  }
  if (turns_back == 4) {
    return wrong(
        "the corners run anticlockwise, which would mirror the object: give them in the order top "
        "left, top right, bottom right, bottom left");
  }
  if (turns_back == 2) {
    return wrong(
        "two sides cross: give the corners in the order top left, top right, bottom right, bottom "
        "left");
  }
  if (turns_back > 0) {
    return wrong("the corners are not convex at the " + std::string(name_of_corner(back_at)) +
                 " corner " + text_of(p[back_at]) + ": these are no corners of a rectangle");
  }
  return {};
}

SheetView view_of_sheet(const Corners& corners_px, const Pinhole& camera) {
  SheetView view;
  view.px_from_unit = square_to_corners(corners_px);
  const Eigen::Matrix3d rays = inverse_of(camera) * view.px_from_unit;
  const Eigen::Vector3d across = rays.col(0), down = rays.col(1);
  const Eigen::Vector3d middle = rays * Eigen::Vector3d(0.5, 0.5, 1.0);
  view.height_over_width = down.norm() / across.norm();
  view.skew_rad = std::asin(std::clamp(across.normalized().dot(down.normalized()), -1.0, 1.0));
  const Eigen::Vector3d normal = across.cross(down).normalized();
  view.tilt_rad = std::acos(std::min(std::abs(normal.dot(middle.normalized())), 1.0));
  return view;
}

FocalGuess guess_focal_length(const Corners& corners_px, const Pinhole& start) {
  constexpr double kSpread = 0.2, kReach = 3.0;
  constexpr int kSteps = 121;
  struct Candidate {
    double log_focal, log_ratio, cost;
  };
  std::vector<Candidate> candidates;
  for (int i = 0; i < kSteps; ++i) {
    const double off = kReach * (2.0 * i / (kSteps - 1) - 1.0);  // in sigmas
    const double log_focal = std::log(start.fx) + kSpread * off;
    const Pinhole camera = with_focal_length(start, std::exp(log_focal));
    const SheetView view = view_of_sheet(corners_px, camera);
    const double variance = skew_variance(corners_px, camera, view.skew_rad);
    candidates.push_back(
        {log_focal, std::log(view.height_over_width),
         0.5 * (off * off + view.skew_rad * view.skew_rad / variance + std::log(variance))});
  }
  const double least =
      std::min_element(candidates.begin(), candidates.end(),
                       [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; })
          ->cost;
  double weights = 0.0, log_focal = 0.0, log_ratio = 0.0, squares = 0.0;
  for (const Candidate& each : candidates) {
    const double weight = std::exp(least - each.cost);
    weights += weight;
    log_focal += weight * each.log_focal;
    log_ratio += weight * each.log_ratio;
    squares += weight * each.log_ratio * each.log_ratio;
  }
  log_focal /= weights, log_ratio /= weights, squares /= weights;
  return {std::exp(log_focal), std::sqrt(std::max(squares - log_ratio * log_ratio, 0.0))};
}

}  // namespace weft::photo
