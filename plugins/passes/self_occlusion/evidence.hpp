// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

#include "sight.hpp"

namespace weft::self_occlusion {

/// The evidence of the kept matches for each vertex, independent of the prediction by geometry.
struct Evidence {
  /// [V] 1 where two matches that are nearest to the vertex agree: what they lack to their places
  /// on the shape differs by less than the tolerance
  std::vector<std::uint8_t> confirmed;
  std::vector<int> around;   ///< [V] kept matches in the faces around the vertex
  std::vector<int> nearest;  ///< [V] kept matches that are nearer to it than to other vertices
  std::vector<double>
      expected;  ///< [V] how many there should be; all of a face at its three corners
};

/// The mesh as it is believed to lie before the camera.
struct Scene {
  Points3View vertices_m;  ///< [V,3] m, camera frame
  FacesView faces;         ///< [F,3]
  const IndexLists& around;
  const std::vector<double>& cosines;  ///< [F] of their slant, positive towards the camera
};

/// The expected number of matches is proportional to the image area of a face times the squared
/// cosine of its slant, because detectors fail on slanted texture. Its rate is the mean over the
/// faces that contain some. Faces of matches must be in range.
Evidence gather_evidence(const Scene& scene, const Camera& camera, const Correspondences& matches,
                         double tolerance_px);

/// Marks vertices that are visible by geometry, but without recognised texture. A part of the
/// surface is doubted where no match is left around its vertices although at least `missing` are
/// expected in it. A part that joins a geometrically hidden part is doubted too. At the rim of such
/// parts vertices without a nearest match are doubted too: their places in the image are a guess.
std::vector<std::uint8_t> unconfirmed_vertices(const Scene& scene, const Sight& sight,
                                               const Evidence& evidence, double missing);

}  // namespace weft::self_occlusion
