// SPDX-License-Identifier: Apache-2.0
#include "evidence.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/data/matrix.hpp>
#include <weft/geometry/barycentric.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/mesh_validation.hpp>

namespace weft::self_occlusion {
namespace {

/// Fewer than this may be missing by chance.
constexpr double kFewestExpected = 4.0 / 3.0;

/// px^2 of a face in the image times the squared cosine of its slant; 0 where it is not in view.
double exposure_px2(const Scene& scene, const Points2& pixels, Eigen::Index face) {
  const double cosine = scene.cosines[to_index(face)];
  const double area_px2 = std::abs(signed_area_px2(pixels, scene.faces, face));
  return cosine > 0.0 && std::isfinite(area_px2) ? cosine * cosine * area_px2 : 0.0;
}

bool two_agree(const std::vector<Eigen::Vector2d>& offsets_px, double tolerance_px) {
  for (std::size_t i = 0; i < offsets_px.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      worked_in_loop(static_cast<std::int64_t>(j));
      if ((offsets_px[i] - offsets_px[j]).norm() <= tolerance_px) return true;
    }
  }
  return false;
}

/// Calls `visit` for each vertex that shares a face with this one, itself included.
template <class Visit>
void for_neighbours(const Scene& scene, std::size_t vertex, const Visit& visit) {
  for (const std::int32_t face : scene.around[static_cast<Eigen::Index>(vertex)]) {
    for (int k = 0; k < 3; ++k) visit(to_index(scene.faces(face, k)));
  }
}

/// The marked vertices that `start` is joined to by marked ones; they are unmarked.
std::vector<std::size_t> take_part(const Scene& scene, std::size_t start,
                                   std::vector<std::uint8_t>& marked) {
  std::vector<std::size_t> part{start};
  marked[start] = 0;
  for (std::size_t next = 0; next < part.size(); ++next) {
    const std::size_t vertex = part[next];
    worked(10);
    for_neighbours(scene, vertex, [&](std::size_t v) {
      if (marked[v] == 0) return;
      marked[v] = 0;
      part.push_back(v);
    });
  }
  return part;
}

}  // namespace

Evidence gather_evidence(const Scene& scene, const Camera& camera, const Correspondences& matches,
                         double tolerance_px) {
  const Pinhole pinhole{camera.fx, camera.fy, camera.cx, camera.cy};
  const auto vertex_count = to_index(scene.vertices_m.rows());
  std::vector<int> in_face(to_index(scene.faces.rows()), 0);
  std::vector<std::vector<Eigen::Vector2d>> nearest(vertex_count);
  for (std::int64_t i = 0; i < matches.count(); ++i) {
    const std::int32_t face = matches.face(i);
    if (matches.kept(i) == 0 || face < 0) continue;
    ++in_face[to_index(face)];
    const Eigen::Vector3d weights = matches.barycentrics.matrix<3>().row(i);
    const Eigen::Vector3d point_m = interpolate(scene.vertices_m, scene.faces, face, weights);
    const Eigen::Vector2d image_px = matches.image_px.matrix<2>().row(i);
    Eigen::Index corner = 0;
    weights.maxCoeff(&corner);
    nearest[to_index(scene.faces(face, corner))].push_back(image_px - project(pinhole, point_m));
  }
  const Points2 pixels = project_points(pinhole, scene.vertices_m);
  std::vector<double> exposure(in_face.size());
  double counted = 0.0, exposed_px2 = 0.0;
  for (std::size_t f = 0; f < in_face.size(); ++f) {
    exposure[f] = exposure_px2(scene, pixels, static_cast<Eigen::Index>(f));
    if (in_face[f] == 0 || exposure[f] == 0.0) continue;
    counted += in_face[f];
    exposed_px2 += exposure[f];
  }
  const double rate_per_px2 = exposed_px2 > 0.0 ? counted / exposed_px2 : 0.0;
  Evidence evidence;
  for (std::size_t v = 0; v < vertex_count; ++v) {
    int found = 0;
    double around_px2 = 0.0;
    for (const std::int32_t face : scene.around[static_cast<Eigen::Index>(v)]) {
      found += in_face[to_index(face)];
      around_px2 += exposure[to_index(face)];
    }
    evidence.confirmed.push_back(two_agree(nearest[v], tolerance_px) ? 1 : 0);
    evidence.around.push_back(found);
    evidence.nearest.push_back(static_cast<int>(nearest[v].size()));
    evidence.expected.push_back(rate_per_px2 * around_px2 / 3.0);
  }
  return evidence;
}

std::vector<std::uint8_t> unconfirmed_vertices(const Scene& scene, const Sight& sight,
                                               const Evidence& evidence, double missing) {
  const std::size_t count = sight.reason.size();
  const auto is_unseen = [&](std::size_t v) {
    return sight.reason[v] == SightReason::hidden || sight.reason[v] == SightReason::faces_away;
  };
  std::vector<std::uint8_t> doubtful(count, 0), unconfirmed(count, 0);
  for (std::size_t v = 0; v < count; ++v) {
    const bool lacks = evidence.around[v] == 0 && evidence.expected[v] >= kFewestExpected;
    doubtful[v] = is_unseen(v) || (sight.reason[v] == SightReason::seen && lacks) ? 1 : 0;
  }
  std::vector<std::size_t> unseen;
  for (std::size_t v = 0; v < count; ++v) {
    if (doubtful[v] == 0) continue;
    double expected = 0.0;
    const std::vector<std::size_t> part = take_part(scene, v, doubtful);
    for (const std::size_t member : part) expected += evidence.expected[member];
    if (expected < missing && std::none_of(part.begin(), part.end(), is_unseen)) continue;
    unseen.insert(unseen.end(), part.begin(), part.end());
    for (const std::size_t member : part) unconfirmed[member] = is_unseen(member) ? 0 : 1;
  }
  for (const std::size_t v : unseen) {
    for_neighbours(scene, v, [&](std::size_t next) {
      const bool seen = sight.reason[next] == SightReason::seen;
      if (seen && evidence.nearest[next] == 0) unconfirmed[next] = 1;
    });
  }
  return unconfirmed;
}

}  // namespace weft::self_occlusion
