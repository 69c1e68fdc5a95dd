// SPDX-License-Identifier: Apache-2.0
#include "closed_surface.hpp"

#include <Eigen/Geometry>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>
#include <weft/geometry/solid/validation.hpp>

#include "number_text.hpp"

namespace weft::volume {
namespace {

Error bad_surface(const std::string& sentence) {
  return about("surface", {Errc::invalid_data, "the surface " + sentence});
}

std::string place_of(const Points3& vertices_m, std::int32_t v) {
  std::string text = "(";
  for (int k = 0; k < 3; ++k) {
    text += (k > 0 ? ", " : "") + number_text(1e3 * vertices_m(v, k));
  }
  return text + ") mm";
}

Result<void> check_closed(const ClosedSurface& surface, const MeshTopology& topology) {
  if (topology.boundary_edges.empty()) return {};
  const std::int32_t first = topology.boundary_edges.front();
  return bad_surface(
      "is not closed: " + std::to_string(topology.boundary_edges.size()) + " of its " +
      std::to_string(topology.edges.rows()) + " edges have one face only, the first from " +
      place_of(surface.vertices_m, topology.edges(first, 0)) + " to " +
      place_of(surface.vertices_m, topology.edges(first, 1)) +
      ". Close the holes and merge vertices by distance in a modelling program (Blender: Select "
      "Non Manifold, Fill, Merge by Distance), and export it again");
}

Result<void> check_orientation(const Faces& faces) {
  std::set<std::pair<std::int32_t, std::int32_t>> walks;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 60);
    for (int k = 0; k < 3; ++k) {
      if (walks.emplace(faces(f, k), faces(f, (k + 1) % 3)).second) continue;
      return bad_surface("changes its orientation at face " + std::to_string(f) +
                         ": make all faces point outwards and unwrap the mesh without mirrored "
                         "pieces (Blender: Recalculate Outside), and export it again");
    }
  }
  return {};
}

double volume_in(const Points3& vertices_m, const Faces& faces) {
  const Eigen::RowVector3d centre = vertices_m.colwise().mean();
  double volume_m3 = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::RowVector3d a = vertices_m.row(faces(f, 0)) - centre;
    const Eigen::RowVector3d b = vertices_m.row(faces(f, 1)) - centre;
    const Eigen::RowVector3d c = vertices_m.row(faces(f, 2)) - centre;
    volume_m3 += a.dot(b.cross(c)) / 6.0;
  }
  return volume_m3;
}

int count_surface_parts(const MeshTopology& topology, Eigen::Index face_count) {
  std::vector<std::int32_t> up(to_index(face_count));
  std::iota(up.begin(), up.end(), 0);
  const auto root = [&](std::int32_t f) {
    while (up[to_index(f)] != f) f = up[to_index(f)] = up[to_index(up[to_index(f)])];
    return f;
  };
  auto parts = static_cast<int>(face_count);
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 3);
    const std::int32_t a = root(topology.edge_faces(e, 0)), b = root(topology.edge_faces(e, 1));
    if (a == b) continue;
    up[to_index(b)] = a;
    --parts;
  }
  return parts;
}

}  // namespace

Result<ClosedSurface> closed_surface_of(const Template& templ) {
  ClosedSurface surface;
  surface.vertices_m = templ.vertices_m.matrix<3>();
  if (auto valid = validate_mesh(surface.vertices_m, templ.faces.matrix<3>()); !valid) {
    return bad_surface("cannot be used: " + valid.error().message);
  }
  if (auto valid = validate_solid(templ); !valid) {
    return bad_surface("cannot be used: " + valid.error().message);
  }
  surface.faces = welded_faces(templ.faces.matrix<3>(), templ.welded_vertex);
  const auto topology = build_topology(surface.faces, surface.vertices_m.rows());
  if (!topology) return bad_surface("cannot be used: " + topology.error().message);
  if (auto closed = check_closed(surface, *topology); !closed) return closed.error();
  if (auto oriented = check_orientation(surface.faces); !oriented) return oriented.error();
  surface.parts = count_surface_parts(*topology, surface.faces.rows());
  surface.volume_m3 = volume_in(surface.vertices_m, surface.faces);
  if (surface.volume_m3 > 0.0) return surface;
  return bad_surface(
      "is turned inside out: its texture is mirrored as seen from outside. Correct it with "
      "'flip: u' of templates/mesh, or turn the faces and texture coordinates in a modelling "
      "program");
}

}  // namespace weft::volume
