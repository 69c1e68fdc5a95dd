// SPDX-License-Identifier: Apache-2.0
#include "depth_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/camera_model.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "robust_weight.hpp"

namespace weft::famouri_local {
namespace {

using solvers::SeenPoint;

constexpr int kFitRounds = 4;
constexpr double kRestRidge = 1e-6;
constexpr double kLeastStd = 1e-3;  // share of a distance: the surface deviates from its mesh

}  // namespace

Result<void> DepthMesh::set_mesh(const Points3View& rest_m, const FacesView& faces,
                                 const MeshTopology& topology) {
  rest_m_ = rest_m;
  hinges_ = bending_hinges(rest_m, faces, topology);
  const double edge_m = mean_edge_length(rest_m, topology.edges);
  ridge_per_m2_ = kRestRidge / (edge_m * edge_m);
  couplings_ = {};
  for (Eigen::Index e = 0; e < topology.edges.rows(); ++e) {
    couplings_.of(topology.edges(e, 0), topology.edges(e, 1));
  }
  for (const BendingHinge& hinge : hinges_) couplings_.of(hinge.vertex[2], hinge.vertex[3]);
  if (auto analysed = factor_.analyse(rest_m_, couplings_.pairs()); !analysed) return analysed;
  matrix_.diagonal.resize(to_index(rest_m_.rows()));
  matrix_.coupling.resize(couplings_.pairs().size());
  matrix_.set_zero();
  for (Eigen::Matrix3d& own : matrix_.diagonal) own.diagonal().array() += ridge_per_m2_;
  for (const BendingHinge& hinge : hinges_) {
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = r; c < 4; ++c) {
        const double value =
            hinge.weight / 3.0 * hinge.coefficient_per_m[r] * hinge.coefficient_per_m[c];
        add_block(hinge.vertex[r], hinge.vertex[c], value * Eigen::Matrix3d::Identity());
      }
    }
  }
  bending_ = matrix_;
  return {};
}

/// Adds a symmetric block, also to its mirror.
void DepthMesh::add_block(std::int32_t i, std::int32_t j, const Eigen::Matrix3d& block) {
  if (i == j) {
    matrix_.diagonal[to_index(i)] += block;
  } else {
    matrix_.coupling[to_index(couplings_.at(i, j))] += block;
  }
}

void DepthMesh::prepare_pulls(const MatchDepths& found, const Camera& camera,
                              const FitOptions& options) {
  const double sigma_px = std::hypot(found.noise_px, options.mesh_error_px);
  const double shared = std::sqrt(std::max(1.0, found.mean_count));
  pulls_.assign(found.points.size(), {});
  for (std::size_t i = 0; i < found.points.size(); ++i) {
    Pull& pull = pulls_[i];
    const LocalDepth& depth = found.depths[i];
    const Eigen::Vector2d& seen_px = found.points[i].seen_px;
    pull.ray = unit_ray({camera.fx, camera.fy, camera.cx, camera.cy}, seen_px);
    pull.distance_m = depth.distance_m;
    const double z_m = pull.distance_m * pull.ray.z();
    pull.rows = solvers::reprojection_rows(camera, seen_px) / (sigma_px * z_m);
    pull.per_m = 1.0 / (shared * std::max(depth.std_m, kLeastStd * depth.distance_m));
  }
}

/// The rest mesh where the depths have it.
Result<Points3> DepthMesh::laid_rigidly(const MatchDepths& found) const {
  const auto count = static_cast<Eigen::Index>(pulls_.size());
  Points3 from_m(count, 3), to_m(count, 3);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Pull& pull = pulls_[to_index(i)];
    from_m.row(i) = found.points[to_index(i)].on(rest_m_).transpose();
    to_m.row(i) = pull.distance_m * pull.ray.transpose();
  }
  const auto aligned = align_points(from_m, to_m);
  if (!aligned) return no_result("the depths do not determine where the surface is");
  return transform_points(*aligned, rest_m_);
}

bool DepthMesh::solve(const MatchDepths& found, const Points3& rigid_m, double stiffness) {
  const std::vector<SeenPoint>& points = found.points;
  const auto scaled = [stiffness](const Eigen::Matrix3d& block) { return stiffness * block; };
  std::transform(bending_.diagonal.begin(), bending_.diagonal.end(), matrix_.diagonal.begin(),
                 scaled);
  std::transform(bending_.coupling.begin(), bending_.coupling.end(), matrix_.coupling.begin(),
                 scaled);
  vertices_m_ = stiffness * ridge_per_m2_ * rigid_m;
  for (const BendingHinge& hinge : hinges_) {
    Eigen::RowVector3d bend = Eigen::RowVector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      bend += hinge.coefficient_per_m[k] * rigid_m.row(hinge.vertex[k]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
      vertices_m_.row(hinge.vertex[k]) +=
          stiffness * hinge.weight / 3.0 * hinge.coefficient_per_m[k] * bend;
    }
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    worked_in_loop(static_cast<std::int64_t>(i), 30);
    const Pull& pull = pulls_[i];
    const double depth_weight = pull.depth_weight * pull.per_m * pull.per_m;
    const Eigen::Matrix3d block = pull.seen_weight * pull.rows.transpose() * pull.rows +
                                  depth_weight * pull.ray * pull.ray.transpose();
    const auto& corners = points[i].corners;
    for (std::size_t r = 0; r < 3; ++r) {
      const double own = points[i].weights[static_cast<Eigen::Index>(r)];
      vertices_m_.row(corners[r]) += own * depth_weight * pull.distance_m * pull.ray.transpose();
      for (std::size_t c = r; c < 3; ++c) {
        add_block(corners[r], corners[c],
                  own * points[i].weights[static_cast<Eigen::Index>(c)] * block);
      }
    }
  }
  if (!factor_.factorise(matrix_, 0.0)) return false;
  factor_.solve(vertices_m_);
  return vertices_m_.allFinite();
}

/// Weighs what is off less. Its scale is not below that of the residuals, so that a first fit,
/// which outliers have bent, loses no good matches.
void DepthMesh::weigh(const MatchDepths& found) {
  const double shared = std::sqrt(std::max(1.0, found.mean_count));
  std::vector<double> seen, depth;
  for (std::size_t i = 0; i < pulls_.size(); ++i) {
    const Eigen::Vector3d at_m = found.points[i].on(vertices_m_);
    seen.push_back((pulls_[i].rows * at_m).norm());
    depth.push_back(shared * pulls_[i].per_m *
                    std::abs(pulls_[i].ray.dot(at_m) - pulls_[i].distance_m));
  }
  const double seen_scale = std::max(1.0, median(seen) / kMedianLength);
  const double depth_scale = std::max(1.0, median(depth) * kSigmaPerMad);
  for (std::size_t i = 0; i < pulls_.size(); ++i) {
    pulls_[i].seen_weight = robust_weight(seen[i] / seen_scale);
    pulls_[i].depth_weight = robust_weight(depth[i] / depth_scale);
  }
}

Result<Points3> DepthMesh::fit(const MatchDepths& found, const Camera& camera,
                               const FitOptions& options) {
  prepare_pulls(found, camera, options);
  const auto rigid_m = laid_rigidly(found);
  if (!rigid_m) return rigid_m.error();
  for (int round = 0; round < kFitRounds; ++round) {
    if (round > 0) weigh(found);
    if (!solve(found, *rigid_m, options.stiffness)) {
      return no_result("the depths do not determine the surface");
    }
  }
  return vertices_m_;
}

}  // namespace weft::famouri_local
