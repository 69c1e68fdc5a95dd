// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/visibility.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

#include "common/scene/ray_caster.hpp"

namespace weft::self_occlusion {

/// Which way a surface looks, by the cosine between its normal and the way to the camera; edge-on
/// below 0.02.
enum class Facing : std::uint8_t { towards, away, edge_on };

Facing facing_of(double cosine);

/// The visibility by the geometry of one shape.
struct Sight {
  std::vector<SightReason> reason;  ///< [V]
  std::vector<std::uint8_t> known;  ///< [V] 0 where the surface is edge-on, and nothing before it
  std::vector<double> score;    ///< [V] half for the vertex, half for the seen share of its faces
  std::vector<double> cosines;  ///< [F] between each face's normal and the way to the camera
};

/// Cosines of the faces of vertices [V,3] m, camera frame: positive for those that show their
/// front, on which they are counter-clockwise; 0 for a face without area.
std::vector<double> facing_cosines(const Points3View& vertices_m, const FacesView& faces);

/// A vertex is visible if it projects into the image, no triangle is in front of it, and the faces
/// around it look towards the camera. They do so on the mean, or one of them by more than 30
/// degrees. A face is visible if it looks towards the camera and nothing is in front of its
/// centroid. `scene` is given this mesh. `around` lists the faces around each vertex. Vertices must
/// be finite.
Sight look(const Points3View& vertices_m, const FacesView& faces, const IndexLists& around,
           const Camera& camera, scene::RayCaster& scene);

}  // namespace weft::self_occlusion
