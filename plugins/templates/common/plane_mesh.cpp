// SPDX-License-Identifier: Apache-2.0
#include "plane_mesh.hpp"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_size_criteria_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

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
using Point = Kernel::Point_2;

constexpr double kShapeBound = 0.125;
// Refinement halves edges above their bound, so that the mean edge is well below it.
constexpr double kBoundOverSpacing = 1.5;

void insert(const Polygon& polygon, Triangulation& triangulation) {
  std::vector<Vertex> corners;
  for (const Eigen::Vector2d& p : polygon) {
    corners.push_back(triangulation.insert(Point(p.x(), p.y())));
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vertex& next = corners[(i + 1) % corners.size()];
    if (next != corners[i]) triangulation.insert_constraint(corners[i], next);
  }
}

/// The number of outlines around each face: faces with an odd number are inside.
std::map<Face, int> depths_of(const Triangulation& triangulation) {
  std::map<Face, int> depth_of;
  std::vector<Face> here{triangulation.infinite_face()}, deeper;
  for (int depth = 0; !here.empty(); ++depth, here.swap(deeper), deeper.clear()) {
    while (!here.empty()) {
      const Face face = here.back();
      here.pop_back();
      if (!depth_of.emplace(face, depth).second) continue;
      for (int k = 0; k < 3; ++k) {
        (face->is_constrained(k) ? deeper : here).push_back(face->neighbor(k));
      }
    }
  }
  return depth_of;
}

std::vector<Face> faces_inside(const Triangulation& triangulation) {
  const std::map<Face, int> depth_of = depths_of(triangulation);
  std::vector<Face> inside;
  for (const Face face : triangulation.finite_face_handles()) {
    if (depth_of.at(face) % 2 == 1) inside.push_back(face);
  }
  return inside;
}

/// Points in the holes, at least one in each.
std::vector<Point> points_in_holes(const Triangulation& triangulation) {
  const std::map<Face, int> depth_of = depths_of(triangulation);
  std::vector<Point> points;
  for (const Face face : triangulation.finite_face_handles()) {
    if (depth_of.at(face) == 2) points.push_back(CGAL::centroid(triangulation.triangle(face)));
  }
  return points;
}

/// Points and which of them are joined by sides of the outline, in an order that does not depend on
/// where they are in memory.
struct Net {
  std::vector<Point> points;                      ///< by v and then by u
  std::vector<std::array<std::size_t, 2>> sides;  ///< the smaller index first
  std::vector<bool> is_inner;                     ///< on no side
};

Net net_of(const Triangulation& triangulation) {
  std::map<std::pair<double, double>, std::size_t> number_of;
  const auto place = [](const Vertex& vertex) {
    return std::pair(vertex->point().y(), vertex->point().x());
  };
  for (const Vertex vertex : triangulation.finite_vertex_handles()) {
    number_of.emplace(place(vertex), 0);
  }
  Net net;
  for (auto& [vu, number] : number_of) {
    number = net.points.size();
    net.points.emplace_back(vu.second, vu.first);
  }
  net.is_inner.assign(net.points.size(), true);
  for (const auto& edge : triangulation.constrained_edges()) {
    const std::size_t a = number_of.at(place(edge.first->vertex(Triangulation::cw(edge.second))));
    const std::size_t b = number_of.at(place(edge.first->vertex(Triangulation::ccw(edge.second))));
    net.sides.push_back({std::min(a, b), std::max(a, b)});
    net.is_inner[a] = net.is_inner[b] = false;
  }
  std::sort(net.sides.begin(), net.sides.end());
  return net;
}

Triangulation triangulated(const Net& net, std::map<Vertex, std::size_t>& number_of) {
  Triangulation triangulation;
  std::vector<Vertex> vertices;
  for (const Point& point : net.points) {
    vertices.push_back(triangulation.insert(point));
    number_of.emplace(vertices.back(), vertices.size() - 1);
  }
  for (const auto& [a, b] : net.sides) triangulation.insert_constraint(vertices[a], vertices[b]);
  return triangulation;
}

/// Each inner point at the centroid of the faces around it.
void smooth(Net& net) {
  std::map<Vertex, std::size_t> number_of;
  const Triangulation triangulation = triangulated(net, number_of);
  std::vector<Eigen::Vector3d> sums(net.points.size(), Eigen::Vector3d::Zero());
  for (const Face& face : faces_inside(triangulation)) {
    const auto triangle = triangulation.triangle(face);
    const Point centre = CGAL::centroid(triangle);
    const Eigen::Vector3d weighted = triangle.area() * Eigen::Vector3d(centre.x(), centre.y(), 1.0);
    for (int k = 0; k < 3; ++k) sums[number_of.at(face->vertex(k))] += weighted;
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (!net.is_inner[i] || !(sums[i].z() > 0.0)) continue;
    net.points[i] = Point(sums[i].x() / sums[i].z(), sums[i].y() / sums[i].z());
  }
}

PlaneMesh exported(const Triangulation& triangulation) {
  std::map<std::pair<double, double>, std::int32_t> number_of;  // by (v, u)
  const auto place = [](const Vertex& vertex) {
    return std::pair(vertex->point().y(), vertex->point().x());
  };
  const std::vector<Face> inside = faces_inside(triangulation);
  for (const Face& face : inside) {
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

Result<PlaneMesh> fill_outline(const Outline& outline, double spacing_px, int smoothing_rounds) {
  Triangulation triangulation;
  try {
    insert(outline.outer, triangulation);
    for (const Polygon& hole : outline.holes) insert(hole, triangulation);
  } catch (const Triangulation::Intersection_of_constraints_exception&) {
    return Error{Errc::invalid_data,
                 "the outline crosses itself when it is approximated with sides of " +
                     std::to_string(spacing_px) +
                     " px: give a finer 'spacing_mm' or more 'vertices'"};
  }
  const auto holes = points_in_holes(triangulation);
  const Criteria criteria(kShapeBound, kBoundOverSpacing * spacing_px);
  CGAL::refine_Delaunay_mesh_2(triangulation, holes.begin(), holes.end(), criteria, false);
  if (smoothing_rounds == 0) return exported(triangulation);
  Net net = net_of(triangulation);
  for (int round = 0; round < smoothing_rounds; ++round) smooth(net);
  std::map<Vertex, std::size_t> unused;
  return exported(triangulated(net, unused));
}

}  // namespace weft::outline
