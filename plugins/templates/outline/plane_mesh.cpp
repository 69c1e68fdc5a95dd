// SPDX-License-Identifier: Apache-2.0
#include "plane_mesh.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/lloyd_optimize_mesh_2.h>

#include <algorithm>
#include <array>
#include <map>
#include <tuple>
#include <vector>

namespace weft::outline {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Structure = CGAL::Triangulation_data_structure_2<CGAL::Delaunay_mesh_vertex_base_2<Kernel>,
                                                       CGAL::Delaunay_mesh_face_base_2<Kernel>>;
using Triangulation =
    CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure,
                                               CGAL::No_constraint_intersection_tag>;
using Criteria = CGAL::Delaunay_mesh_size_criteria_2<Triangulation>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;

constexpr double kShapeBound = 0.125;
// Refinement halves what is longer than its bound, so that the mean edge is well below it.
constexpr double kBoundOverSpacing = 1.5;

void insert(const Polygon& polygon, Triangulation& triangulation) {
  std::vector<Vertex> corners;
  for (const Eigen::Vector2d& p : polygon) {
    corners.push_back(triangulation.insert(Kernel::Point_2(p.x(), p.y())));
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vertex& next = corners[(i + 1) % corners.size()];
    if (next != corners[i]) triangulation.insert_constraint(corners[i], next);
  }
}

/// A point in each hole: of the faces, by how many outlines they are inside of, those with two.
std::vector<Kernel::Point_2> points_in_holes(const Triangulation& triangulation) {
  std::map<Face, int> depth_of;
  std::vector<Kernel::Point_2> points;
  std::vector<Face> here{triangulation.infinite_face()}, deeper;
  for (int depth = 0; !here.empty(); ++depth, here.swap(deeper), deeper.clear()) {
    for (const Face& start : here) {
      if (depth_of.count(start) > 0) continue;
      if (depth == 2) points.push_back(CGAL::centroid(triangulation.triangle(start)));
      std::vector<Face> open{start};
      while (!open.empty()) {
        const Face face = open.back();
        open.pop_back();
        if (!depth_of.emplace(face, depth).second) continue;
        for (int k = 0; k < 3; ++k) {
          const Face next = face->neighbor(k);
          if (depth_of.count(next) > 0) continue;
          (face->is_constrained(k) ? deeper : open).push_back(next);
        }
      }
    }
  }
  return points;
}

PlaneMesh exported(const Triangulation& triangulation) {
  std::map<std::pair<double, double>, std::int32_t> number_of;  // by (v, u)
  const auto place = [](const Vertex& vertex) {
    return std::pair(vertex->point().y(), vertex->point().x());
  };
  std::vector<Face> inside;
  for (const Face face : triangulation.finite_face_handles()) {
    if (!face->is_in_domain()) continue;
    inside.push_back(face);
    for (int k = 0; k < 3; ++k) number_of.emplace(place(face->vertex(k)), 0);
  }
  PlaneMesh mesh{Points2(static_cast<Eigen::Index>(number_of.size()), 2), {}};
  std::int32_t next = 0;
  for (auto& [vu, number] : number_of) {
    mesh.flat_px.row(next) << vu.second, vu.first;
    number = next++;
  }
  std::vector<std::array<std::int32_t, 3>> faces;
  for (const Face& face : inside) {
    // CGAL turns from u to v, which the camera sees as clockwise.
    std::array<std::int32_t, 3> corners{number_of.at(place(face->vertex(0))),
                                        number_of.at(place(face->vertex(2))),
                                        number_of.at(place(face->vertex(1)))};
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    faces.push_back(corners);
  }
  std::sort(faces.begin(), faces.end());
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    mesh.faces.row(static_cast<Eigen::Index>(f)) << faces[f][0], faces[f][1], faces[f][2];
  }
  return mesh;
}

}  // namespace

Result<PlaneMesh> fill_outline(const Outline& outline, double spacing_px, int lloyd_iterations) {
  Triangulation triangulation;
  try {
    insert(outline.outer, triangulation);
    for (const Polygon& hole : outline.holes) insert(hole, triangulation);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return Error{Errc::invalid_data,
                 "the outline crosses itself when it is drawn with sides of " +
                     std::to_string(spacing_px) +
                     " px: give a finer 'spacing_mm' or more 'vertices'",
                 {}};
  }
  const auto holes = points_in_holes(triangulation);
  const Criteria criteria(kShapeBound, kBoundOverSpacing * spacing_px);
  CGAL::refine_Delaunay_mesh_2(triangulation, holes.begin(), holes.end(), criteria, false);
  if (lloyd_iterations > 0) {
    CGAL::lloyd_optimize_mesh_2(
        triangulation, CGAL::parameters::max_iteration_number = lloyd_iterations,
        CGAL::parameters::seeds_begin = holes.begin(), CGAL::parameters::seeds_end = holes.end());
  }
  return exported(triangulation);
}

}  // namespace weft::outline
