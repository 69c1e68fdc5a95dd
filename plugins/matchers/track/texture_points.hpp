// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/template.hpp>

namespace weft::track {

/// A point of the template.
struct TexturePoint {
  Eigen::Vector2d template_px = Eigen::Vector2d::Zero();  ///< px of the texture
  std::int32_t face = -1;                                 ///< -1: there is no such point
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();      ///< in that face
};

/// The most distinctive points of a texture, one for each cell of a grid over it. The smaller
/// eigenvalue of the structure tensor is largest there (Shi and Tomasi, CVPR 1994, equation 9). It
/// is computed at the resolution with which a camera may see the whole texture.
class TexturePoints {
 public:
  /// Cells are squares, such that about `most` of them cover the mesh. Fails with what is wrong
  /// with the mesh.
  Result<void> load(const Template& templ, const Camera& camera, int most);

  int cells() const { return static_cast<int>(points_.size()); }
  /// The cell of a place in the texture, the nearest one for a place beyond it.
  int cell_of(const Eigen::Vector2d& template_px) const;
  /// That of a cell; its face is -1 where the cell has no texture, or none on the mesh.
  const TexturePoint& point(int cell) const { return points_[to_index(cell)]; }

 private:
  double cell_px_ = 1.0;
  int columns_ = 0, rows_ = 0;
  std::vector<TexturePoint> points_;
};

}  // namespace weft::track
