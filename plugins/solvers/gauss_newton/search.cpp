// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <weft/core/index.hpp>

namespace weft::gauss_newton {
namespace {

constexpr double kSoft = 10.0;                        // times the strain
constexpr double kHuber = 1.0, kApproachHuber = 4.0;  // distant observations still have to be
                                                      // reached
constexpr double kApproachBendRad = 0.1, kRigidBendRad = 0.02;
constexpr int kApproachIterations = 10;
constexpr double kApproachTolerance = 100.0;  // times that of the last steps
constexpr std::size_t kMostSeenBends = 256;
constexpr std::size_t kFewBesideOutline = 30;  // with fewer the outline counts from the beginning
constexpr double kFarReach = 2.0;              // times the reach of the outline, at first

/// Brings known points into their spheres, by the least motion of their corners.
void bring_into_spheres(const std::vector<KnownSurfacePoint>& spheres, Points3& vertices_m) {
  for (const KnownSurfacePoint& known : spheres) {
    const Eigen::Vector3d distance_m = known.on(vertices_m) - known.centre_m;
    const double length_m = distance_m.norm();
    if (!(length_m > known.radius_m)) continue;
    const Eigen::Vector3d lacks_m = (known.radius_m / length_m - 1.0) * distance_m;
    if (known.vertex >= 0) {
      vertices_m.row(known.vertex) += lacks_m.transpose();
      continue;
    }
    double squares = 0.0;
    for (const double weight : known.weights) squares += weight * weight;
    for (std::size_t k = 0; k < 3; ++k) {
      vertices_m.row(known.vertices[k]) += known.weights[k] / squares * lacks_m.transpose();
    }
  }
}

}  // namespace

Result<void> ShapeSearch::prepare(const Template& templ, const MeshModel& mesh) {
  mesh_ = &mesh;
  expected_.bends_rad.resize(mesh.hinges.size());
  normals_.resize(mesh.faces.rows(), 3);
  if (auto built = continuation_.build(templ); !built) return built;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> hinge_at;
  for (std::size_t h = 0; h < mesh.hinges.size(); ++h) {
    const auto& ends = mesh.hinges[h].vertex;
    hinge_at[std::minmax(ends[0], ends[1])] = static_cast<std::int32_t>(h);
  }
  hinge_of_edge_.assign(continuation_.edge_count(), -1);
  for (std::size_t e = 0; e < hinge_of_edge_.size(); ++e) {
    const auto [a, b] = continuation_.edge(e);
    const auto found = hinge_at.find(std::minmax(a, b));
    if (found != hinge_at.end()) hinge_of_edge_[e] = found->second;
  }
  return minimiser_.prepare(mesh);
}

void ShapeSearch::run(const Frame& frame, Candidate& candidate) {
  Points3& vertices_m = candidate.vertices_m;
  expected_.previous_m = vertices_m;
  expect_bends_of_start(candidate);
  Scales stage = scales;
  stage.trust = {kHuber, false};
  candidate.approach_iterations = 0;
  const MinimiserOptions approach{kApproachIterations, kApproachTolerance * options.tolerance_m,
                                  options.budget};
  const auto settle = [&](const Scales& with) {
    candidate.approach_iterations +=
        minimiser_.run(frame.data, expected_, with, approach, vertices_m).iterations;
  };
  Scales soft = stage;
  soft.outline.share = frame.data.observations.size() < kFewBesideOutline ? 1.0 : 0.0;
  soft.outline.reach_px *= kFarReach;
  soft.strain *= kSoft;
  soft.pair_strain *= kSoft;
  if (candidate.guess == solvers::Guess::rigid) {
    soft.bend_rad = kRigidBendRad;
    settle(soft);
  }
  soft.trust.scale = kApproachHuber;
  soft.bend_rad = kApproachBendRad;
  settle(soft);
  expect_bends(frame, vertices_m);
  settle(stage);
  if (!frame.hidden.empty()) expect_bends(frame, vertices_m);
  if (frame.data.outline.present() && scales.outline.share > 0.0) {
    Scales between = stage;
    between.outline.reach_px = std::sqrt(scales.outline.reach_px * scales.outline.outlier_px);
    settle(between);
  }
  stage = final_scales();
  candidate.result = minimiser_.run(frame.data, expected_, stage, options, vertices_m);
  bring_into_spheres(frame.data.spheres, vertices_m);
}

Scales ShapeSearch::final_scales() const {
  Scales last = scales;
  last.outline.reach_px = std::min(scales.outline.reach_px, scales.outline.outlier_px);
  return last;
}

/// Those of a shape that was measured; of other starts, those at rest.
void ShapeSearch::expect_bends_of_start(const Candidate& candidate) {
  const bool is_measured =
      candidate.guess == solvers::Guess::previous || candidate.guess == solvers::Guess::mirrored;
  if (is_measured) face_normals(candidate.vertices_m, mesh_->faces, normals_);
  for (std::size_t h = 0; h < mesh_->hinges.size(); ++h) {
    const Hinge& hinge = mesh_->hinges[h];
    expected_.bends_rad[h] =
        is_measured ? angle_rad(hinge, normals_, candidate.vertices_m) : hinge.rest_rad;
  }
}

/// Those at rest; in a hidden part those with which the bend of the others goes on.
void ShapeSearch::expect_bends(const Frame& frame, const Points3& vertices_m) {
  for (std::size_t h = 0; h < mesh_->hinges.size(); ++h) {
    expected_.bends_rad[h] = mesh_->hinges[h].rest_rad;
  }
  if (frame.hidden.empty()) return;
  const std::vector<double> angles_rad =
      continuation_.continued_angles(vertices_m, frame.hidden, kMostSeenBends);
  for (std::size_t e = 0; e < angles_rad.size(); ++e) {
    if (hinge_of_edge_[e] < 0) continue;
    const auto h = to_index(hinge_of_edge_[e]);
    const auto& ends = mesh_->hinges[h].vertex;
    const bool is_hidden = std::any_of(
        ends.begin(), ends.end(), [&](std::int32_t v) { return frame.hidden[to_index(v)] != 0; });
    if (is_hidden) expected_.bends_rad[h] = angles_rad[e];
  }
}

}  // namespace weft::gauss_newton
