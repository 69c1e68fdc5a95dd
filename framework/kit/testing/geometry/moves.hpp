// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "kit/testing/contract_scene.hpp"

/// Changes of a scene after which a component must give the same answer, moved along.
namespace weft::testing {

/// A transformation of a scene. Points of the image move to image * (x,y) + image_shift_px, which
/// keeps axes parallel to axes; points in the camera frame move to space * (X,Y,Z).
struct Move {
  std::string name;  ///< "image rolled"
  Eigen::Matrix2d image = Eigen::Matrix2d::Identity();
  Eigen::Vector2d image_shift_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d border_px = Eigen::Vector2d::Zero();  ///< by which the image becomes larger
  Eigen::Matrix3d space = Eigen::Matrix3d::Identity();
  double metres = 1.0;                   ///< [] factor of lengths of template and space
  bool mirrors_texture = false;          ///< its left is its right, and faces turn round
  std::vector<std::int64_t> matches{};   ///< [.] which of the old ones each is; empty: as they were
  std::vector<std::int64_t> vertices{};  ///< [V] the same
  std::vector<std::int64_t> faces{};     ///< [F] the same

  /// Factor of lengths in the image.
  double pixels() const { return image.row(0).norm(); }
  bool moves_image() const { return !image.isIdentity() || !image_shift_px.isZero(); }
  bool renumbers() const { return !vertices.empty() || !faces.empty(); }
  Points2 in_image(const Points2View& points_px) const {
    return (points_px * image.transpose()).rowwise() + image_shift_px.transpose();
  }
  Points3 in_space(const Points3View& points_m) const { return points_m * space.transpose(); }
  /// The old row of row `row`.
  std::int64_t match(std::int64_t row) const {
    return matches.empty() ? row : matches[static_cast<std::size_t>(row)];
  }
  std::int64_t vertex(std::int64_t row) const {
    return vertices.empty() ? row : vertices[static_cast<std::size_t>(row)];
  }
};

Move permute_matches(const Scene& scene);
/// A tenth of the matches once more, behind all.
Move repeat_matches(const Scene& scene);
/// The image with a border on its left and at its top.
Move shift_image();
/// Twice as many pixels along each side. Twice and not once and a half: numbers keep their digits,
/// so that no difference of rounding tips a threshold.
Move scale_image();
/// A quarter of a turn clockwise, with the camera.
Move roll_image(const Scene& scene);
/// Left is right, in the texture too.
Move mirror_image(const Scene& scene);
/// The world twice as large, the image the same.
Move scale_world();
Move renumber_vertices(const Scene& scene);

/// The scene after it.
Scene moved(const Scene& scene, const Move& move);

/// Points of the texture after it, [N,2] px.
Points2 moved_texels(const Template& templ, const Points2View& texels_px, const Move& move);

}  // namespace weft::testing
