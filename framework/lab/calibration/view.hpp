// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace weft::calibration {

/// The corners of the board that one image shows.
struct View {
  std::string name;           ///< name of its image
  Eigen::MatrixX2d board_m;   ///< [C,2] m, x right and y down from the board's top left corner
  Eigen::MatrixX2d image_px;  ///< [C,2] px
};

/// Width and height of the images.
struct ImageSize {
  int width_px = 0, height_px = 0;
  bool operator==(const ImageSize&) const = default;
};

/// Where the board lies in a view, about: a camera of an ordinary field of view is assumed.
struct Placement {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [2] of width and height, 0 to 1
  double size = 0.0;  ///< square root of the share of the image that the corners span
  /// [2] rad, how far the board is turned: x, its right side farther away (below 0: its left one);
  /// y, its lower side farther away (below 0: its upper one).
  Eigen::Vector2d tilt_rad = Eigen::Vector2d::Zero();
};

/// How far a board with this normal, in the camera's frame, is turned; as in Placement.
Eigen::Vector2d tilt_of(const Eigen::Vector3d& normal);

Placement placement_of(const View& view, const ImageSize& size);

/// At most `most` views in order of their index, chosen to differ as much as possible: each is the
/// farthest from all chosen before, in position, size and tilt.
std::vector<std::size_t> choose_views(const std::vector<View>& views, const ImageSize& size,
                                      std::size_t most);

/// How different two placements are; 1 is a third of the image, or a quarter of a right angle.
double difference(const Placement& a, const Placement& b);

}  // namespace weft::calibration
