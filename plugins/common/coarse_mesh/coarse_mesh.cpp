// SPDX-License-Identifier: Apache-2.0
#include "coarse_mesh.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/mesh_topology.hpp>

#include "vertex_choice.hpp"

namespace weft::coarse_mesh {
namespace {

constexpr double kReachInEdges = 2.0;  // largest distance of a fine vertex beside the coarse mesh

/// The revision of a template that follows from another one and a number; unknown where that one's
/// is.
std::uint64_t mixed_revision(std::uint64_t fine, std::uint64_t count) {
  if (fine == 0) return 0;
  std::uint64_t mixed = fine + 0x9e3779b97f4a7c15U * (count + 1);
  mixed = (mixed ^ (mixed >> 30U)) * 0xbf58476d1ce4e5b9U;
  mixed = (mixed ^ (mixed >> 27U)) * 0x94d049bb133111ebU;
  mixed ^= mixed >> 31U;
  return mixed != 0 ? mixed : 1;
}

/// Where a point lies that is far beside the mesh.
FaceLocation middle_of_nearest(const Points2View& places, const Faces& faces,
                               const Eigen::Vector2d& place) {
  const Eigen::Vector3d thirds = Eigen::Vector3d::Constant(1.0 / 3.0);
  FaceLocation nearest{0, thirds, false};
  double least2 = std::numeric_limits<double>::infinity();
  for (std::int32_t f = 0; f < faces.rows(); ++f) {
    const double far2 = (interpolate(places, faces, f, thirds) - place).squaredNorm();
    if (far2 < least2) least2 = far2, nearest.face = f;
  }
  return nearest;
}

}  // namespace

Points2 places_of(const Template& templ) {
  Points2 places = templ.flat_px.matrix<2>();
  if (!templ.m_per_px.present()) return places;
  places.col(0) *= templ.m_per_px(0);
  places.col(1) *= templ.m_per_px(1);
  return places;
}

Result<void> CoarseMesh::build(const Template& templ, Eigen::Index count) {
  const Points2 places = places_of(templ);
  const Faces faces = templ.faces.matrix<3>();
  if (!templ.vertices_m.matrix<3>().allFinite() || !places.allFinite()) {
    return Error{Errc::invalid_data, "the template needs finite vertices, in m and in the texture"};
  }
  const auto topology = build_topology(faces, places.rows());
  if (!topology) return topology.error();
  mesh_ = thin_mesh(places, faces, choose_vertices(places, faces, *topology, count));
  coarse_of_.assign(to_index(places.rows()), -1);
  for (std::size_t c = 0; c < mesh_.vertices.size(); ++c) {
    coarse_of_[to_index(mesh_.vertices[c])] = static_cast<std::int32_t>(c);
  }
  vertices_m_ = rows_of(templ.vertices_m, mesh_.vertices);
  flat_px_ = rows_of(templ.flat_px, mesh_.vertices);
  faces_ = make_array<std::int32_t>(mesh_.faces);
  revision_ = mixed_revision(templ.revision, static_cast<std::uint64_t>(count));
  return locate_vertices(templ);
}

Result<void> CoarseMesh::locate_vertices(const Template& templ) {
  const Points2 flat_px = flat_px_.matrix<2>();
  auto locator = FaceLocator::create(flat_px, mesh_.faces);
  if (!locator) return locator.error();
  const double reach_px = kReachInEdges * 2.0 * locator->max_distance_px();
  const auto far_locator = FaceLocator::create(flat_px, mesh_.faces, reach_px);
  if (!far_locator) return far_locator.error();
  locator_.emplace(*std::move(locator));
  locations_.clear();
  for (Eigen::Index v = 0; v < templ.flat_px.rows(); ++v) {
    worked_in_loop(v, 20);
    const Eigen::Vector2d place_px = templ.flat_px.matrix<2>().row(v).transpose();
    const FaceLocation at = far_locator->locate(place_px);
    locations_.push_back(at.face >= 0 ? at : middle_of_nearest(flat_px, mesh_.faces, place_px));
  }
  return {};
}

Result<void> CoarseMesh::check(const char* what, std::int64_t vertices) const {
  if (vertices == fine_count()) return {};
  return Error{Errc::invalid_data, std::string(what) + " has " + std::to_string(vertices) +
                                       " vertices, the template " + std::to_string(fine_count()) +
                                       ": use one template throughout"};
}

Template CoarseMesh::of(const Template& fine) const {
  Template coarse = fine;
  coarse.vertices_m = vertices_m_;
  coarse.flat_px = flat_px_;
  coarse.faces = faces_;
  coarse.welded_vertex = {};  // these arrays belong to the fine vertices
  coarse.nodes_m = {};
  coarse.tetrahedra = {};
  coarse.vertex_tetrahedron = {};
  coarse.vertex_barycentric = {};
  coarse.revision = revision_;
  return coarse;
}

Correspondences CoarseMesh::of(const Correspondences& fine) const {
  Correspondences coarse = fine;
  coarse.face = Array<std::int32_t>({fine.count()});
  coarse.barycentrics = Array<double>({fine.count(), 3});
  for (std::int64_t i = 0; i < fine.count(); ++i) {
    worked_in_loop(i, 10);
    FaceLocation at;
    if (fine.face(i) >= 0) at = locate(fine.template_px.matrix<2>().row(i).transpose());
    coarse.face(i) = at.face;
    for (Eigen::Index k = 0; k < 3; ++k) coarse.barycentrics(i, k) = at.weights[k];
  }
  return coarse;
}

Result<Visibility> CoarseMesh::of(const Visibility& fine) const {
  if (auto same = check("the visibility", fine.visible.rows()); !same) return same.error();
  return Visibility{rows_of(fine.visible, vertices()), rows_of(fine.score, vertices()),
                    rows_of(fine.reason, vertices()), fine.diag};
}

Result<WarpSamples> CoarseMesh::of(const WarpSamples& fine) const {
  if (auto same = check("the warp", fine.xy_px.rows()); !same) return same.error();
  WarpSamples coarse;
  coarse.xy_px = rows_of(fine.xy_px, vertices());
  coarse.valid = rows_of(fine.valid, vertices());
  return coarse;
}

Result<Shape> CoarseMesh::of(const Shape& fine) const {
  if (auto same = check("the shape", fine.vertices_m.rows()); !same) return same.error();
  Shape coarse = fine;
  coarse.vertices_m = rows_of(fine.vertices_m, vertices());
  coarse.source = rows_of(fine.source, vertices());
  coarse.covariance_m2 = {};
  return coarse;
}

}  // namespace weft::coarse_mesh
