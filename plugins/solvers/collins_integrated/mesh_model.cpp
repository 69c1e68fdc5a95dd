// SPDX-License-Identifier: Apache-2.0
#include "mesh_model.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/distance_constraints.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/mesh_validation.hpp>

#include "common/cholesky/couplings.hpp"

namespace weft::collins_integrated {
namespace {

/// Normals of the faces with c and with d, on the same side of a surface that is not folded; 0 for
/// a face without area.
std::pair<Eigen::Vector3d, Eigen::Vector3d> normals_of(const Hinge& hinge,
                                                       const Points3& vertices_m) {
  const auto from_a = [&](std::size_t k) -> Eigen::Vector3d {
    return (vertices_m.row(hinge.vertex[k]) - vertices_m.row(hinge.vertex[0])).transpose();
  };
  const Eigen::Vector3d along = from_a(1);
  return {along.cross(from_a(2)).normalized(), from_a(3).cross(along).normalized()};
}

}  // namespace

Eigen::Vector3d bend_of(const Hinge& hinge, const Points3& vertices_m) {
  Eigen::Vector3d bend = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    bend += hinge.coefficient_per_m[k] * vertices_m.row(hinge.vertex[k]).transpose();
  }
  return bend;
}

Eigen::Vector3d normal_of(const Hinge& hinge, const Points3& vertices_m) {
  const auto [of_c, of_d] = normals_of(hinge, vertices_m);
  if (of_c.isZero(0.0) || of_d.isZero(0.0)) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d sum = of_c + of_d;
  const double length = sum.norm();
  if (!(length > 0.0)) return Eigen::Vector3d::Zero();
  return sum / length;
}

double cosine_of(const Hinge& hinge, const Points3& vertices_m) {
  const auto [of_c, of_d] = normals_of(hinge, vertices_m);
  return of_c.isZero(0.0) || of_d.isZero(0.0) ? 1.0 : of_c.dot(of_d);
}

Result<void> MeshModel::build(const Template& templ) {
  rest_m = templ.vertices_m.matrix<3>();
  faces = templ.faces.matrix<3>();
  if (auto valid = validate_mesh(rest_m, faces); !valid) return valid;
  const auto topology = build_topology(faces, rest_m.rows());
  if (!topology) return topology.error();
  const auto lengths = distance_constraints(topology->edges, rest_m);
  if (!lengths) return lengths.error();
  mean_edge_m = mean_edge_length(rest_m, topology->edges);
  solvers::Couplings numbers;
  edges.clear();
  for (const DistanceConstraint& each : *lengths) {
    const auto [i, j] = std::minmax(each.i, each.j);
    edges.push_back({i, j, numbers.of(i, j), each.rest_length_m});
  }
  face_couplings.clear();
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    face_couplings.push_back({numbers.at(faces(f, 0), faces(f, 1)),
                              numbers.at(faces(f, 1), faces(f, 2)),
                              numbers.at(faces(f, 2), faces(f, 0))});
  }
  hinges.clear();
  bending = bending_hinges(rest_m, faces, *topology);
  for (const BendingHinge& each : bending) {
    const auto [a, b, c, d] = each.vertex;
    Hinge hinge;
    hinge.vertex = each.vertex;
    hinge.coefficient_per_m = each.coefficient_per_m;
    hinge.coupling = {numbers.of(a, b), numbers.of(a, c), numbers.of(a, d),
                      numbers.of(b, c), numbers.of(b, d), numbers.of(c, d)};
    hinge.weight = each.weight;
    hinge.rest_rad = bend_of(hinge, rest_m).dot(normal_of(hinge, rest_m));
    hinge.rest_cosine = cosine_of(hinge, rest_m);
    hinges.push_back(hinge);
  }
  couplings = numbers.pairs();
  return {};
}

}  // namespace weft::collins_integrated
