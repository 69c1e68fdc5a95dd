// SPDX-License-Identifier: Apache-2.0
#include "sight.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/camera_model.hpp>

namespace weft::self_occlusion {
namespace {

constexpr double kEdgeOnCosine = 0.02;
constexpr double kInFullView = 0.5;     // cosine of a face that is certainly no rim
constexpr double kSlackInEdges = 5e-3;  // a surface this near in front of a point is its own

bool in_image(const Camera& camera, const Eigen::Vector3d& point_m) {
  const Eigen::Vector2d pixel = project({camera.fx, camera.fy, camera.cx, camera.cy}, point_m);
  return camera.shows(pixel.x(), pixel.y());  // false for NaN
}

Points3 centroids(const Points3View& vertices_m, const FacesView& faces) {
  Points3 points(faces.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f);
    points.row(f) =
        (vertices_m.row(faces(f, 0)) + vertices_m.row(faces(f, 1)) + vertices_m.row(faces(f, 2))) /
        3.0;
  }
  return points;
}

double mean_side(const Points3View& vertices_m, const FacesView& faces) {
  double sum = 0.0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f);
    for (int k = 0; k < 3; ++k) {
      sum += (vertices_m.row(faces(f, k)) - vertices_m.row(faces(f, (k + 1) % 3))).norm();
    }
  }
  return sum / static_cast<double>(3 * faces.rows());
}

/// The visibility of the faces around a vertex.
struct Ring {
  Facing facing = Facing::edge_on;
  double seen_share = 0.0;  ///< [] of the faces
};

/// The surface at a vertex looks where its faces do on the mean. Next to a rim that is nearer to
/// the truth than any one face of a coarse mesh; at a crease it is not, and the face in view
/// counts.
Ring ring_of(std::span<const std::int32_t> around, const std::vector<double>& cosines,
             const std::vector<std::uint8_t>& face_hidden) {
  Ring ring;
  if (around.empty()) return ring;
  double sum = 0.0, largest = -1.0;
  for (const std::int32_t face : around) {
    const auto f = to_index(face);
    sum += cosines[f];
    largest = std::max(largest, cosines[f]);
    const bool seen = facing_of(cosines[f]) == Facing::towards && face_hidden[f] == 0;
    ring.seen_share += seen ? 1.0 : 0.0;
  }
  const auto count = static_cast<double>(around.size());
  ring.facing = largest > kInFullView ? Facing::towards : facing_of(sum / count);
  ring.seen_share /= count;
  return ring;
}

}  // namespace

Facing facing_of(double cosine) {
  if (std::abs(cosine) < kEdgeOnCosine) return Facing::edge_on;
  return cosine > 0.0 ? Facing::towards : Facing::away;
}

std::vector<double> facing_cosines(const Points3View& vertices_m, const FacesView& faces) {
  std::vector<double> cosines;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f, 3);
    const Eigen::Vector3d a = vertices_m.row(faces(f, 0)), b = vertices_m.row(faces(f, 1)),
                          c = vertices_m.row(faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a), centre = a + b + c;
    const double size = normal.norm() * centre.norm();
    cosines.push_back(size > 0.0 ? -normal.dot(centre) / size : 0.0);
  }
  return cosines;
}

Sight look(const Points3View& vertices_m, const FacesView& faces, const IndexLists& around,
           const Camera& camera, scene::RayCaster& scene) {
  Sight sight;
  sight.cosines = facing_cosines(vertices_m, faces);
  scene.set_mesh(vertices_m, faces);
  const double slack_m = kSlackInEdges * mean_side(vertices_m, faces);
  const auto hidden = scene.are_hidden(vertices_m, slack_m);
  const auto face_hidden = scene.are_hidden(centroids(vertices_m, faces), slack_m);
  for (Eigen::Index v = 0; v < vertices_m.rows(); ++v) {
    worked_in_loop(v, 5);
    const bool covered = hidden[to_index(v)] != 0;
    const Ring ring = ring_of(around[v], sight.cosines, face_hidden);
    SightReason reason = SightReason::seen;
    if (!in_image(camera, vertices_m.row(v))) {
      reason = SightReason::outside;
    } else if (covered) {
      reason = SightReason::hidden;
    } else if (ring.facing != Facing::towards) {
      reason = SightReason::faces_away;
    }
    const bool seen = reason == SightReason::seen;
    sight.reason.push_back(reason);
    sight.known.push_back(covered || ring.facing != Facing::edge_on ? 1 : 0);
    sight.score.push_back(0.5 * (seen ? 1.0 : 0.0) + 0.5 * ring.seen_share);
  }
  return sight;
}

}  // namespace weft::self_occlusion
