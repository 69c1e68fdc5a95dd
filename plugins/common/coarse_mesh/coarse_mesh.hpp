// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/result.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/shape.hpp>
#include <weft/data/template.hpp>
#include <weft/data/visibility.hpp>
#include <weft/data/warp.hpp>
#include <weft/geometry/face_locator.hpp>
#include <weft/geometry/types.hpp>

#include "edge_collapse.hpp"

namespace weft::coarse_mesh {

/// The texture coordinates [V,2], in m where the template has its size, else in px.
Points2 places_of(const Template& templ);

/// Some rows of an array [n] or [n,m]; absent where it is.
template <class T>
Array<T> rows_of(const Array<T>& values, const std::vector<std::int32_t>& rows) {
  if (!values.present()) return {};
  const auto count = static_cast<std::int64_t>(rows.size()), length = values.row_elements();
  Array<T> chosen = values.ndim() == 1 ? Array<T>({count}) : Array<T>({count, length});
  for (std::int64_t i = 0; i < count; ++i) {
    std::copy_n(values.row(rows[to_index(i)]), length, chosen.row(i));
  }
  return chosen;
}

/// Some vertices of a template, the mesh on them, and records on that mesh. Large arrays that stay
/// the same, such as the texture, are not copied: the coarse records must not outlive the fine
/// ones.
class CoarseMesh {
 public:
  /// Settles a mesh of about `count` vertices, fewer than the template has: spread evenly over its
  /// texture, by choose_vertices() and thin_mesh(). Fails on a template that is not manifold, not
  /// finite or without an area in the texture.
  Result<void> build(const Template& templ, Eigen::Index count);

  const std::vector<std::int32_t>& vertices() const { return mesh_.vertices; }  ///< [C] fine ones
  const Faces& faces() const { return mesh_.faces; }                            ///< [.,3] coarse
  Eigen::Index count() const { return static_cast<Eigen::Index>(mesh_.vertices.size()); }
  Eigen::Index fine_count() const { return static_cast<Eigen::Index>(locations_.size()); }

  /// The coarse vertex that is this fine one, or -1.
  std::int32_t coarse_of(std::int32_t fine) const { return coarse_of_[to_index(fine)]; }
  /// Where a fine vertex lies; beside the coarse mesh, in the face next to it.
  const FaceLocation& location(Eigen::Index fine) const { return locations_[to_index(fine)]; }
  /// The coarse vertex that has the most of a fine one.
  std::int32_t nearest(Eigen::Index fine) const {
    Eigen::Index most = 0;
    location(fine).weights.maxCoeff(&most);
    return mesh_.faces(location(fine).face, most);
  }
  /// Where a point of the texture lies on the coarse mesh.
  FaceLocation locate(const Eigen::Vector2d& point_px) const { return locator_->locate(point_px); }

  /// With a revision that follows from the fine one's.
  Template of(const Template& fine) const;
  /// The same matches, in coarse faces; -1 stays -1.
  Correspondences of(const Correspondences& fine) const;
  /// These fail on a record of another mesh.
  Result<Visibility> of(const Visibility& fine) const;
  Result<WarpSamples> of(const WarpSamples& fine) const;
  Result<Shape> of(const Shape& fine) const;  ///< without covariance

 private:
  Result<void> locate_vertices(const Template& templ);
  Result<void> check(const char* what, std::int64_t vertices) const;

  ThinMesh mesh_;
  std::vector<std::int32_t> coarse_of_;  ///< [V]
  std::vector<FaceLocation> locations_;  ///< [V]
  Array<double> vertices_m_, flat_px_;   ///< [C,3] m, [C,2] px of the coarse template
  Array<std::int32_t> faces_;            ///< [.,3]
  std::uint64_t revision_ = 0;
  std::optional<FaceLocator> locator_;  ///< in px of the texture
};

}  // namespace weft::coarse_mesh
