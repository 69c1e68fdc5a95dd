// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>
#include <weft/geometry/types.hpp>

#include "common/coarse_mesh/coarse_mesh.hpp"

namespace weft::coarse_to_fine {

/// The smooth surface through the vertices of a coarse mesh, at those of the fine one. All weights
/// follow from the meshes at rest.
class Prolongation {
 public:
  /// `places` [V,2] of the fine vertices on the flat mesh, in any unit, and `rest_m` [V,3].
  void build(const coarse_mesh::CoarseMesh& coarse, const Points2View& places,
             const Points3View& rest_m);

  /// From coarse vertices [C,3] m to fine ones [V,3]. Near each coarse face it is the polyharmonic
  /// spline of order 3 (r^4 log r and polynomials of degree 2) over the flat mesh. The spline
  /// passes through the coarse vertices within two rings of the face. Flat surfaces stay flat and
  /// arcs stay round up to the border, where thin plates would straighten. The difference between
  /// the spline and the shape at rest is added in the frame of the face. A rigid motion is
  /// therefore reproduced exactly.
  Points3 surface_m(const Points3View& coarse_m) const;

 private:
  struct Share {
    std::int32_t vertex = 0;
    double weight = 0.0;
  };

  void add_splines(const coarse_mesh::CoarseMesh& coarse, const Points2View& places);
  void add_details(const coarse_mesh::CoarseMesh& coarse, const Points3View& rest_m);
  Eigen::Matrix3d frame(std::int32_t face, const Points3View& coarse_m) const;

  Faces faces_;                        ///< [.,3] of the coarse mesh
  std::vector<std::int32_t> face_of_;  ///< [V] coarse face of each fine vertex
  std::vector<std::size_t> first_;     ///< [V+1] of each fine vertex in `shares_`
  std::vector<Share> shares_;
  Points3 details_m_;  ///< [V,3] m, in the frame of the face; empty where all are 0
};

}  // namespace weft::coarse_to_fine
