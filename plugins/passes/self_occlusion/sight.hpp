// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>
#include <weft/data/camera.hpp>
#include <weft/data/visibility.hpp>
#include <weft/geometry/mesh_adjacency.hpp>
#include <weft/geometry/types.hpp>

#include "ray_scene.hpp"

namespace weft::self_occlusion {

/// Which way a face looks. Edge-on: |n . X| < 0.02 |X| at its centroid X, n its unit normal.
enum class Facing : std::uint8_t { towards, away, edge_on };

/// What the geometry of one shape says.
struct Sight {
  std::vector<SightReason> reason;  ///< [V]
  std::vector<std::uint8_t> known;  ///< [V] 0 where all faces around a vertex are edge-on or away
  std::vector<double> score;   ///< [V] half for the vertex, half for the seen share of its faces
  std::vector<Facing> facing;  ///< [F]
};

/// Facing of each face of vertices [V,3] m, camera frame. Faces are counter-clockwise as seen from
/// their front; a face without area is edge-on.
std::vector<Facing> face_directions(const Points3View& vertices_m, const FacesView& faces);

/// A vertex is seen if it projects into the image, a face around it looks towards the camera, and
/// no triangle stands before it; a face is seen if it looks towards the camera and nothing stands
/// before its centroid. `scene` is given this mesh. `around` lists the faces around each vertex.
/// Vertices must be finite.
Sight look(const Points3View& vertices_m, const FacesView& faces, const IndexLists& around,
           const Camera& camera, RayScene& scene);

}  // namespace weft::self_occlusion
