// SPDX-License-Identifier: Apache-2.0
#include "coarse_problem.hpp"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/check_sightlines.hpp>

namespace weft::coarse_to_fine {

using coarse_mesh::rows_of;

Result<void> CoarseProblem::build(const Template& templ, Eigen::Index count) {
  if (auto built = mesh_.build(templ, count); !built) return built;
  prolongation_.build(mesh_, coarse_mesh::places_of(templ), templ.vertices_m.matrix<3>());
  return {};
}

Result<SolverInput> CoarseProblem::on_coarse_mesh(const SolverInput& in) const {
  SolverInput asked = in;
  asked.templ = mesh_.of(in.templ);
  if (in.sightlines) {
    auto lines = sightlines(*in.sightlines, in.templ);
    if (!lines) return lines.error();
    asked.sightlines = *std::move(lines);
  }
  if (in.correspondences) asked.correspondences = mesh_.of(*in.correspondences);
  if (in.visibility) {
    auto seen = mesh_.of(*in.visibility);
    if (!seen) return seen.error();
    asked.visibility = *std::move(seen);
  }
  if (in.known_points) {
    auto known = known_points(*in.known_points, in.templ);
    if (!known) return known.error();
    asked.known_points = *std::move(known);
  }
  if (in.previous_shape) {  // a shape of another mesh is ignored
    auto before = mesh_.of(*in.previous_shape);
    asked.previous_shape.reset();
    if (before) asked.previous_shape = *std::move(before);
  }
  return asked;
}

/// Those of coarse vertices, and those inside faces; sightlines of other vertices are omitted.
Result<Sightlines> CoarseProblem::sightlines(const Sightlines& fine, const Template& templ) const {
  auto checked = check_sightlines(fine, mesh_.fine_count(), templ.faces.rows());
  if (!checked) return checked.error();
  const auto flat_px = templ.flat_px.matrix<2>();
  const auto faces = templ.faces.matrix<3>();
  std::vector<std::int32_t> rows, vertices;
  std::vector<FaceLocation> places;
  for (std::int32_t i = 0; i < fine.count(); ++i) {
    worked_in_loop(i, 5);
    const std::int32_t v = fine.vertex(i), coarse = v < 0 ? -1 : mesh_.coarse_of(v);
    if (v >= 0 && coarse < 0) continue;
    FaceLocation at;
    if (v < 0) {
      const Eigen::Vector3d weights = fine.barycentrics.matrix<3>().row(i).transpose();
      at = mesh_.locate(interpolate(flat_px, faces, fine.face(i), weights));
      if (at.face < 0) continue;
    } else {
      at = mesh_.location(v);
    }
    rows.push_back(i);
    vertices.push_back(coarse);
    places.push_back(at);
  }
  Sightlines coarse = fine;
  const auto count = static_cast<std::int64_t>(rows.size());
  coarse.vertex = Array<std::int32_t>({count});
  coarse.face = Array<std::int32_t>({count});
  coarse.barycentrics = Array<double>({count, 3});
  coarse.pixel_px = rows_of(fine.pixel_px, rows);
  coarse.ray = rows_of(fine.ray, rows);
  coarse.weight = rows_of(fine.weight, rows);
  for (std::int64_t i = 0; i < count; ++i) {
    coarse.vertex(i) = vertices[to_index(i)];
    coarse.face(i) = places[to_index(i)].face;
    coarse.barycentrics.matrix<3>().row(i) = places[to_index(i)].weights.transpose();
  }
  return coarse;
}

/// A point in a face, or at a vertex that the coarse mesh lacks, becomes one of the template.
Result<KnownPoints> CoarseProblem::known_points(const KnownPoints& fine,
                                                const Template& templ) const {
  KnownPoints coarse = fine;
  coarse.vertex = Array<std::int32_t>({fine.count()});
  coarse.template_xy_m = Array<double>({fine.count(), 2}, 0.0);
  coarse.face = {};
  coarse.barycentrics = {};
  for (std::int64_t p = 0; p < fine.count(); ++p) {
    const std::int32_t v = fine.vertex(p);
    const std::string name = "known point " + std::to_string(p);
    const bool in_face = v == -1 && fine.face.present() && fine.face(p) >= 0;
    if (in_face && (fine.face(p) >= templ.faces.rows() || !fine.barycentrics.present())) {
      return Error{Errc::invalid_data,
                   name + " names face " + std::to_string(fine.face(p)) + " of a template with " +
                       std::to_string(templ.faces.rows()) + ", and needs barycentrics"};
    }
    const bool is_placed = v >= 0 || in_face || fine.template_xy_m.present();
    if (v >= mesh_.fine_count() || v < -1 || !is_placed) {
      return Error{Errc::invalid_data, name + " names vertex " + std::to_string(v) +
                                           " of a template with " +
                                           std::to_string(mesh_.fine_count())};
    }
    coarse.vertex(p) = v < 0 ? -1 : mesh_.coarse_of(v);
    if (coarse.vertex(p) >= 0) continue;
    if (!templ.m_per_px.present()) {
      return Error{Errc::invalid_data,
                   name +
                       " is at no vertex of the coarse mesh, and without m_per_px in the template "
                       "its place is unknown: use the fine mesh"};
    }
    for (int axis = 0; axis < 2; ++axis) {
      double& coordinate_m = coarse.template_xy_m(p, axis);
      if (in_face) {
        coordinate_m = 0.0;
        for (int k = 0; k < 3; ++k) {
          coordinate_m += fine.barycentrics(p, k) * templ.m_per_px(axis) *
                          templ.flat_px(templ.faces(fine.face(p), k), axis);
        }
      } else {
        coordinate_m =
            v < 0 ? fine.template_xy_m(p, axis) : templ.m_per_px(axis) * templ.flat_px(v, axis);
      }
    }
  }
  return coarse;
}

Result<Shape> CoarseProblem::on_fine_mesh(const Shape& coarse) const {
  if (coarse.vertices_m.rows() != mesh_.count()) {
    return Error{Errc::plugin_failure,
                 "the nested solver gave " + std::to_string(coarse.vertices_m.rows()) +
                     " vertices for a mesh of " + std::to_string(mesh_.count())};
  }
  Shape fine;
  fine.vertices_m = make_array<double>(prolongation_.surface_m(coarse.vertices_m.matrix<3>()));
  fine.state = coarse.state;
  fine.confidence = coarse.confidence;
  fine.source = Array<std::uint8_t>({mesh_.fine_count()});
  for (Eigen::Index v = 0; v < mesh_.fine_count(); ++v) {
    fine.source(v) = coarse.source(mesh_.nearest(v));
  }
  if (!coarse.covariance_m2.present()) return fine;
  fine.covariance_m2 = Array<double>({mesh_.fine_count(), 3, 3});
  auto to = fine.covariance_m2.matrix<9>();
  const auto from = coarse.covariance_m2.matrix<9>();
  for (Eigen::Index v = 0; v < mesh_.fine_count(); ++v) {
    worked_in_loop(v, 3);
    const Eigen::Vector3d inside = mesh_.location(v).weights.cwiseMax(0.0);
    to.row(v) =
        interpolate(from, mesh_.faces(), mesh_.location(v).face, inside / inside.sum()).transpose();
  }
  return fine;
}

}  // namespace weft::coarse_to_fine
