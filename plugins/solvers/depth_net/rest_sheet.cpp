// SPDX-License-Identifier: Apache-2.0
#include "rest_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>

namespace weft::depth_net {
namespace {

// Obtuse angles make negative weights, with which the energy has no minimum. A little stiffness
// also keeps the mesh connected where two right angles make an edge without any.
constexpr double kLeastStiffness = 1e-3;

Eigen::Vector2d row(const Points2& xy_m, Eigen::Index vertex) {
  return xy_m.row(vertex).transpose();
}

/// Half of the cotangent of the angle at `apex`, and twice the area.
struct Corner {
  double half_cotangent, double_area_m2;
};
Corner corner_at(const Points2& xy_m, Eigen::Index apex, Eigen::Index a, Eigen::Index b) {
  const Eigen::Vector2d to_a = row(xy_m, a) - row(xy_m, apex);
  const Eigen::Vector2d to_b = row(xy_m, b) - row(xy_m, apex);
  const double area = std::abs(to_a.x() * to_b.y() - to_a.y() * to_b.x());
  return {0.5 * to_a.dot(to_b) / area, area};
}

}  // namespace

Result<RestSheet> RestSheet::create(const Template& templ, const inference::FlatSheet& sheet) {
  const auto rest_m = templ.vertices_m.matrix<3>();
  Points2 xy_m = rest_m.leftCols<2>().rowwise() - sheet.corner_m.matrix().transpose();
  Faces faces = templ.faces.matrix<3>();
  const auto topology = build_topology(faces, xy_m.rows());
  if (!topology) return topology.error();
  auto locator = FaceLocator::create(xy_m, faces);
  if (!locator) return locator.error();
  RestSheet made(std::move(xy_m), std::move(faces), *std::move(locator));
  made.set_edges(*topology);
  return made;
}

void RestSheet::set_edges(const MeshTopology& topology) {
  area_m2_ = Eigen::VectorXd::Zero(vertex_count());
  for (Eigen::Index f = 0; f < faces_.rows(); ++f) {
    const Corner corner = corner_at(xy_m_, faces_(f, 0), faces_(f, 1), faces_(f, 2));
    for (int k = 0; k < 3; ++k) area_m2_(faces_(f, k)) += corner.double_area_m2 / 6.0;
  }
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    worked_in_loop(e, 5);
    RestEdge edge{topology.edges(e, 0), topology.edges(e, 1)};
    edge.vector_m = xy_m(edge.from) - xy_m(edge.to);
    for (int side = 0; side < 2; ++side) {
      const std::int32_t face = topology.edge_faces(e, side);
      if (face < 0) continue;
      const Eigen::Index apex = faces_.row(face).sum() - edge.from - edge.to;
      edge.stiffness += corner_at(xy_m_, apex, edge.from, edge.to).half_cotangent;
    }
    edge.stiffness = std::max(edge.stiffness, kLeastStiffness);
    edges_.push_back(edge);
  }
}

std::optional<Eigen::Vector3d> RestSheet::on(const Points3& vertices_m,
                                             const Eigen::Vector2d& xy_m) const {
  const FaceLocation place = locator_.locate(xy_m);
  if (place.face < 0) return std::nullopt;
  return interpolate(vertices_m, faces_, place.face, place.weights);
}

double RestSheet::mean_strain(const Points3& vertices_m) const {
  double sum = 0.0;
  for (const RestEdge& edge : edges_) {
    const double length_m = (vertices_m.row(edge.from) - vertices_m.row(edge.to)).norm();
    sum += std::abs(length_m / edge.vector_m.norm() - 1.0);
  }
  return sum / static_cast<double>(edges_.size());
}

}  // namespace weft::depth_net
