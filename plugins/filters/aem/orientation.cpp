// SPDX-License-Identifier: Apache-2.0
#include "orientation.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace weft::aem {
namespace {

constexpr double kTurnRad = 20.0 * std::numbers::pi / 180.0;  // sigma for an inlier
constexpr double kLogScale = 0.3;                             // the same
constexpr double kLogScaleRange = 2.77;  // range of mismatches, evenly: a factor of 4 up and down
constexpr double kLeastBias = -3.0;      // a bad keypoint does not make a match wrong

}  // namespace

double orientation_log_odds(double log_scale, double turn_rad, const Eigen::Matrix2d& slope) {
  const double area_ratio = slope.determinant();
  if (!(area_ratio > 0.0)) return kLeastBias;
  const double turn = std::atan2(slope(1, 0) - slope(0, 1), slope(0, 0) + slope(1, 1));
  const double of_turn = std::remainder(turn_rad - turn, 2.0 * std::numbers::pi) / kTurnRad;
  const double of_scale = (log_scale - 0.5 * std::log(area_ratio)) / kLogScale;
  static const double at_best = std::log(kLogScaleRange / (kTurnRad * kLogScale));
  return std::max(kLeastBias, at_best - 0.5 * (of_turn * of_turn + of_scale * of_scale));
}

}  // namespace weft::aem
