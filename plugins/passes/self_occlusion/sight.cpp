// SPDX-License-Identifier: Apache-2.0
#include "sight.hpp"

#include <cmath>
#include <cstddef>
#include <weft/geometry/camera_model.hpp>

namespace weft::self_occlusion {
namespace {

constexpr double kEdgeOnCosine = 0.02;
constexpr double kSlackInEdges = 5e-3;  // what lies this near before a point is its own surface

bool in_image(const Camera& camera, const Eigen::Vector3d& point_m) {
  const Eigen::Vector2d pixel = project({camera.fx, camera.fy, camera.cx, camera.cy}, point_m);
  return pixel.x() >= -0.5 && pixel.y() >= -0.5 &&  // false for NaN
         pixel.x() <= static_cast<double>(camera.width_px) - 0.5 &&
         pixel.y() <= static_cast<double>(camera.height_px) - 0.5;
}

Points3 centroids(const Points3View& vertices_m, const FacesView& faces) {
  Points3 points(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    points.row(f) =
        (vertices_m.row(faces(f, 0)) + vertices_m.row(faces(f, 1)) + vertices_m.row(faces(f, 2))) /
        3.0;
  }
  return points;
}

double mean_side(const Points3View& vertices_m, const FacesView& faces) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    for (int k = 0; k < 3; ++k) {
      sum += (vertices_m.row(faces(f, k)) - vertices_m.row(faces(f, (k + 1) % 3))).norm();
    }
  }
  return sum / static_cast<double>(3 * faces.rows());
}

/// What the faces around a vertex show.
struct Ring {
  bool towards = false, edge_on = false;
  double seen_share = 0.0;  ///< [] of the faces
};

Ring ring_of(std::span<const std::int32_t> around, const std::vector<Facing>& facing,
             const std::vector<std::uint8_t>& face_hidden) {
  Ring ring;
  for (const std::int32_t face : around) {
    const auto f = static_cast<std::size_t>(face);
    ring.edge_on = ring.edge_on || facing[f] == Facing::edge_on;
    if (facing[f] != Facing::towards) continue;
    ring.towards = true;
    ring.seen_share += face_hidden[f] == 0 ? 1.0 : 0.0;
  }
  if (!around.empty()) ring.seen_share /= static_cast<double>(around.size());
  return ring;
}

}  // namespace

std::vector<Facing> face_directions(const Points3View& vertices_m, const FacesView& faces) {
  std::vector<Facing> facing(static_cast<std::size_t>(faces.rows()), Facing::edge_on);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0)), b = vertices_m.row(faces(f, 1)),
                          c = vertices_m.row(faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a), centre = (a + b + c) / 3.0;
    const double along = normal.dot(centre);
    if (!(std::abs(along) >= kEdgeOnCosine * normal.norm() * centre.norm()) || along == 0.0) {
      continue;
    }
    facing[static_cast<std::size_t>(f)] = along < 0.0 ? Facing::towards : Facing::away;
  }
  return facing;
}

Sight look(const Points3View& vertices_m, const FacesView& faces, const IndexLists& around,
           const Camera& camera, RayScene& scene) {
  Sight sight;
  sight.facing = face_directions(vertices_m, faces);
  scene.set_mesh(vertices_m, faces);
  const double slack_m = kSlackInEdges * mean_side(vertices_m, faces);
  const auto hidden = scene.are_hidden(vertices_m, slack_m);
  const auto face_hidden = scene.are_hidden(centroids(vertices_m, faces), slack_m);
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    const bool covered = hidden[static_cast<std::size_t>(v)] != 0;
    const Ring ring = ring_of(around[v], sight.facing, face_hidden);
    SightReason reason = SightReason::seen;
    if (!in_image(camera, vertices_m.row(v))) {
      reason = SightReason::outside;
    } else if (covered) {
      reason = SightReason::hidden;
    } else if (!ring.towards) {
      reason = SightReason::faces_away;
    }
    const bool seen = reason == SightReason::seen;
    sight.reason.push_back(reason);
    sight.known.push_back(covered || ring.towards || !ring.edge_on ? 1 : 0);
    sight.score.push_back(0.5 * (seen ? 1.0 : 0.0) + 0.5 * ring.seen_share);
  }
  return sight;
}

}  // namespace weft::self_occlusion
