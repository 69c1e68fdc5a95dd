// SPDX-License-Identifier: Apache-2.0
#include "lab/calibration/refusal.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::calibration {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kLeastTilt_rad = 12.0 * kDegree, kLeastSpread_rad = 10.0 * kDegree;
constexpr double kLeastShare = 0.4;
/// Relative to the focal length and, for the centre, to the longer side of the image.
constexpr double kMostDeviation = 0.01;
/// Beyond it, digits are lost to rounding, even if the standard deviations are small.
constexpr double kMostCondition = 1e8;
/// Relative to the longer side of the image, and at least one pixel.
constexpr double kMostError = 1.0 / 500.0;

/// How far tilts are off their mean, at most.
double spread_of(const std::vector<Eigen::Vector2d>& tilts_rad) {
  Eigen::Vector2d mean_rad = Eigen::Vector2d::Zero();
  for (const auto& tilt_rad : tilts_rad) {
    mean_rad += tilt_rad / static_cast<double>(tilts_rad.size());
  }
  double spread_rad = 0.0;
  for (const auto& tilt_rad : tilts_rad) {
    spread_rad = std::max(spread_rad, (tilt_rad - mean_rad).norm());
  }
  return spread_rad;
}

std::string percent(double share) { return fmt::format("{:.2g} %", 100.0 * share); }

}  // namespace

std::optional<std::string> refusal_of(const std::vector<View>& views, const ImageSize& size) {
  if (views.size() < kFewestViews) {
    return fmt::format(
        "{} {} the board, and at least {} are needed: take more, with the board in other places "
        "of the image and turned in other ways",
        views.size(), views.size() == 1 ? "image shows" : "images show", kFewestViews);
  }
  const Coverage coverage = coverage_of(views, size);
  if (coverage.largest_tilt_rad < kLeastTilt_rad) {
    return fmt::format(
        "in all views the board is nearly parallel to the image (turned by {:.0f} degrees at "
        "most): turn the board by 20 to 40 degrees, to all four sides",
        coverage.largest_tilt_rad / kDegree);
  }
  if (coverage.share() < kLeastShare) {
    return fmt::format(
        "corners cover {:.0f} % of the image, and at least {:.0f} % are needed to determine the "
        "lens: bring the board closer, and to the borders of the image",
        100.0 * coverage.share(), 100.0 * kLeastShare);
  }
  return std::nullopt;
}

std::optional<std::string> refusal_of(const Solution& solution, const ImageSize& size) {
  const double side_px = std::max(size.width_px, size.height_px);
  const double most_px = std::max(1.0, kMostError * side_px);
  if (!(solution.rms_px <= most_px)) {
    return fmt::format(
        "the camera that fits best leaves {:.2g} px at the corners, more than {:.2g}. Check that "
        "the board is flat and printed as in --squares, and that the images are sharp and from one "
        "camera with a fixed focus. The lens may need more numbers (--distortion 8)",
        solution.rms_px, most_px);
  }
  const double spread_rad = spread_of(solution.tilt_rad);
  if (spread_rad < kLeastSpread_rad) {
    return fmt::format(
        "in all views the board is turned the same way (within {:.0f} degrees): turn it by 20 to "
        "40 degrees to each of its four sides, or move the camera",
        spread_rad / kDegree);
  }
  const double focal =
      std::max(solution.deviation[0] / solution.fx, solution.deviation[1] / solution.fy);
  const double centre = std::max(solution.deviation[2], solution.deviation[3]) / side_px;
  const bool known =
      solution.deviation.allFinite() && focal <= kMostDeviation && centre <= kMostDeviation;
  if (known && solution.condition <= kMostCondition) return std::nullopt;
  return fmt::format(
      "the views determine the camera badly (focal length to {}, centre to {} of the image's "
      "longer side; condition {:.1g}). Turn the board by 20 to 40 degrees to each of its four "
      "sides, close to the camera, and give no more --distortion numbers than the lens needs",
      percent(focal), percent(centre), solution.condition);
}

}  // namespace weft::calibration
