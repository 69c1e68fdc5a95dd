// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/ground_truth.hpp>
#include <weft/data/template.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/face_locator.hpp>

#include "lab/metrics/shapes/alignment.hpp"

namespace weft::lab {

/// Distances between a shape and the truth at the points of the truth.
struct PointErrors {
  std::vector<double> distances_m;   ///< [L] m, of the points that lie on the mesh
  std::vector<double> depths_m;      ///< [L] m, true distance of each along the camera's axis
  std::vector<std::int64_t> points;  ///< [L] which points of the truth these are, ascending
  std::int64_t extrapolated = 0;     ///< [] of them beside the mesh, within the locator's rule
  std::int64_t unlocated = 0;        ///< [] points too far from the mesh to have a place on it
};

/// Measures shapes of one template.
///
/// A truth point at template_xy_m has the texel (u,v) = xy / m_per_px. The texel is in a face of
/// the flat mesh with barycentric weights w. The estimate is X = sum w_k X_k over that face's
/// vertices, and its error is |X - X_truth| (Euclidean).
class ShapeMeter {
 public:
  /// Copies what it needs. Fails on a mesh that cannot be used.
  static Result<ShapeMeter> create(const Template& templ);

  /// Errors of vertices [V,3] m, camera frame. Fails with invalid_data where the template has no
  /// m_per_px, with no_result where the alignment is not determined.
  Result<PointErrors> errors(const Points3View& vertices_m, const GroundTruth& truth,
                             Alignment alignment) const;

  /// |l / l0 - 1| over the edges of vertices [V,3].
  StrainStatistics strain(const Points3View& vertices_m) const {
    return strain_statistics(edges_, vertices_m);
  }

  Eigen::Index vertex_count() const { return vertex_count_; }
  double diagonal_m() const { return diagonal_m_; }  ///< diagonal of the bounding box at rest

 private:
  explicit ShapeMeter(FaceLocator locator) : locator_(std::move(locator)) {}

  FaceLocator locator_;
  Faces faces_;
  Eigen::Index vertex_count_ = 0;
  std::vector<DistanceConstraint> edges_;
  Eigen::Vector2d m_per_px_ = Eigen::Vector2d::Zero();  ///< 0 when the template has none
  double diagonal_m_ = 0.0;
};

}  // namespace weft::lab
