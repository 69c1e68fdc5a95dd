// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

namespace weft::photo {

/// A straight line in an image, and the places of edges along it.
struct StraightLine {
  Eigen::Vector2d point = Eigen::Vector2d::Zero();       ///< [2] px, on it
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< [2] of length 1
  std::vector<Eigen::Vector2d> stretches;  ///< px from `point`: begin and end, ascending, disjoint

  double along(const Eigen::Vector2d& place) const { return (place - point).dot(direction); }
  /// Root of the squared lengths of all stretches: long ones count more than many short ones, as
  /// the grain of wood has.
  double weight_px() const;
  /// Share of the way between two of its points along which there are edges.
  double covered(const Eigen::Vector2d& from, const Eigen::Vector2d& to) const;
};

/// The straight lines of an image [H,W,3] u8, where edges of each of its channels count, weak ones
/// too. It returns at most `most` of them, half of these within the same 45 degrees, by descending
/// weight. Edges where `seen` [H,W] is 0 or near that do not count. Segments are found by LSD (R.
/// Grompone von Gioi et al., LSD: a line segment detector, IPOL 2, 2012) after the local mean was
/// taken away, and those on one line are joined.
std::vector<StraightLine> straight_lines(const cv::Mat& picture, const cv::Mat& seen,
                                         std::size_t most);

}  // namespace weft::photo
