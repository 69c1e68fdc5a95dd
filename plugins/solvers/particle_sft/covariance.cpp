// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <weft/core/index.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kPriorM = 0.3;
constexpr double kLeastRadiusM = 5e-4;  // a known point that is held exactly is known this well

double width_m(const BendingHinge& hinge) {
  return (1.0 / hinge.coefficient_per_m[2] + 1.0 / hinge.coefficient_per_m[3]) / 3.0;
}

double bend_rad(const BendingHinge& hinge, const Points3& vertices_m) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    sum += hinge.coefficient_per_m[k] * vertices_m.row(hinge.vertex[k]);
  }
  return sum.norm();
}

bool all_seen(const BendingHinge& hinge, const std::vector<std::uint8_t>& seen) {
  return std::all_of(hinge.vertex.begin(), hinge.vertex.end(),
                     [&](std::int32_t v) { return seen[to_index(v)] != 0; });
}

}  // namespace

HoldingNoise holding_noise(const ShapeSigns& signs) {
  constexpr double kLeastPx = 0.1, kNoiseOfResidual = 6.0, kShared = 0.5, kCommon = 0.9;
  constexpr double kUnseenBend = 0.23, kUnseenOfSeen = 2.0;
  const double sharing =
      static_cast<double>(signs.sightlines) / std::max(1, signs.agreeing_matches);
  HoldingNoise noise;
  noise.ray_px = std::hypot(kLeastPx, kNoiseOfResidual * signs.residual_px) *
                 std::sqrt(1.0 + kShared * sharing);
  noise.strain = 0.0015;
  noise.bend_rad = 0.05;
  noise.common_strain = kCommon * signs.strain;
  noise.unseen_strain = 0.03;
  noise.unseen_bend =
      kUnseenBend * std::hypot(1.0, kUnseenOfSeen * signs.curvature_per_m * signs.diagonal_m);
  return noise;
}

Result<void> ShapeCovariance::build(const MeshModel& mesh) {
  couplings_ = {};
  for (const DistanceConstraint& edge : mesh.stretch()) couplings_.of(edge.i, edge.j);
  hinges_.clear();
  for (const BendingHinge& hinge : mesh.hinges()) {
    CoupledHinge coupled{hinge, bend_rad(hinge, mesh.rest_m()), {}};
    auto pair = coupled.pair.begin();
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = r + 1; c < 4; ++c) {
        *pair++ = couplings_.of(hinge.vertex[r], hinge.vertex[c]);
      }
    }
    hinges_.push_back(coupled);
  }
  if (auto fits = factor_.analyse(mesh.rest_m(), couplings_.pairs()); !fits) {
    Error error = fits.error();
    error.message = "covariance: " + error.message + ", or set covariance: false";
    return error;
  }
  const auto vertices = to_index(mesh.vertex_count());
  matrix_.diagonal.resize(vertices);
  matrix_.coupling.resize(couplings_.pairs().size());
  inverse_.resize(vertices);
  shared_.resize(mesh.vertex_count(), 3);
  solved_.resize(mesh.vertex_count(), 3);
  return {};
}

double ShapeCovariance::curvature_per_m(const Points3& vertices_m,
                                        const std::vector<std::uint8_t>& seen) const {
  double squares = 0.0;
  std::size_t count = 0;
  for (const auto& [hinge, rest_rad, pair] : hinges_) {
    if (!all_seen(hinge, seen)) continue;
    const double turn_rad = bend_rad(hinge, vertices_m) - rest_rad;
    squares += std::pow(turn_rad / width_m(hinge), 2);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

bool ShapeCovariance::compute(const ParticleSystem& system, const std::vector<std::uint8_t>& seen,
                              const Pinhole& camera, const Points3& vertices_m,
                              const HoldingNoise& noise, double* covariance_m2) {
  matrix_.set_zero();
  add_rays(system, camera, vertices_m, noise.ray_px);
  add_edges(system, seen, vertices_m, noise);
  add_bends(seen, noise);
  for (const KnownSurfacePoint& known : system.spheres) {
    const double trust = std::pow(std::max(known.radius_m, kLeastRadiusM), -2);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        add_block(known.vertices[r], known.vertices[c],
                  trust * known.weights[r] * known.weights[c] * Eigen::Matrix3d::Identity());
      }
    }
  }
  if (!factor_.factorise(matrix_, 1.0 / (kPriorM * kPriorM))) return false;
  double shared_m2 = 0.0;
  if (noise.common_strain > 0.0) {
    // The inverse of H with the border of e is H^-1 + v g g^T, g = H^-1 h, v = 1 / (h_ee - h^T g).
    solved_ = shared_;
    factor_.solve(solved_);
    const double left =
        edge_weights_ + std::pow(noise.common_strain, -2) - shared_.cwiseProduct(solved_).sum();
    if (!(left > 0.0) || !std::isfinite(left)) return false;
    shared_m2 = 1.0 / left;
  }
  factor_.inverse_blocks(inverse_);
  for (std::size_t v = 0; v < inverse_.size(); ++v) {
    const Eigen::Vector3d of_e = solved_.row(static_cast<Eigen::Index>(v)).transpose();
    if (shared_m2 > 0.0) inverse_[v] += shared_m2 * of_e * of_e.transpose();
    std::copy_n(inverse_[v].data(), 9, covariance_m2 + 9 * v);
  }
  return true;
}

void ShapeCovariance::add_rays(const ParticleSystem& system, const Pinhole& camera,
                               const Points3& vertices_m, double ray_px) {
  const double focal_px = 0.5 * (camera.fx + camera.fy);
  for (const RayConstraint& seen : system.rays) {
    double depth_m = 0.0;
    for (std::size_t k = 0; k < 3; ++k)
      depth_m += seen.weights[k] * vertices_m(seen.vertices[k], 2);
    const double sigma_m = ray_px * std::abs(depth_m) / focal_px;
    const Eigen::Map<const Eigen::Vector3d> ray(seen.ray.data());
    const Eigen::Matrix3d across =
        seen.trust / (sigma_m * sigma_m) * (Eigen::Matrix3d::Identity() - ray * ray.transpose());
    const std::size_t corners = seen.at_vertex() ? 1 : 3;
    for (std::size_t r = 0; r < corners; ++r) {
      for (std::size_t c = 0; c < corners; ++c) {
        add_block(seen.vertices[r], seen.vertices[c], seen.weights[r] * seen.weights[c] * across);
      }
    }
  }
}

void ShapeCovariance::add_edges(const ParticleSystem& system, const std::vector<std::uint8_t>& seen,
                                const Points3& vertices_m, const HoldingNoise& noise) {
  shared_.setZero();
  edge_weights_ = 0.0;
  const double known = std::pow(noise.strain, -2);
  const double unknown =
      1.0 / (noise.strain * noise.strain + noise.unseen_strain * noise.unseen_strain);
  for (const DistanceConstraint& edge : system.stretch) {
    const Eigen::Vector3d along =
        (vertices_m.row(edge.j) - vertices_m.row(edge.i)).transpose().normalized() /
        edge.rest_length_m;
    const bool is_seen = seen[to_index(edge.i)] != 0 && seen[to_index(edge.j)] != 0;
    const double weight = is_seen ? known : unknown;
    const Eigen::Matrix3d block = weight * along * along.transpose();
    matrix_.diagonal[to_index(edge.i)] += block;
    matrix_.diagonal[to_index(edge.j)] += block;
    matrix_.coupling[to_index(couplings_.at(edge.i, edge.j))] -= block;
    shared_.row(edge.i) += weight * along.transpose();
    shared_.row(edge.j) -= weight * along.transpose();
    edge_weights_ += weight;
  }
}

void ShapeCovariance::add_bends(const std::vector<std::uint8_t>& seen, const HoldingNoise& noise) {
  for (const auto& [hinge, rest_rad, pairs] : hinges_) {
    double variance = noise.bend_rad * noise.bend_rad;
    if (!all_seen(hinge, seen)) {
      variance += 3.0 * noise.unseen_bend * noise.unseen_bend / hinge.weight;
    }
    const auto* pair = pairs.data();
    const auto& factor = hinge.coefficient_per_m;
    for (std::size_t r = 0; r < 4; ++r) {
      matrix_.diagonal[to_index(hinge.vertex[r])].diagonal().array() +=
          factor[r] * factor[r] / variance;
      for (std::size_t c = r + 1; c < 4; ++c) {
        matrix_.coupling[to_index(*pair++)].diagonal().array() += factor[r] * factor[c] / variance;
      }
    }
  }
}

void ShapeCovariance::add_block(std::int32_t row, std::int32_t column,
                                const Eigen::Matrix3d& block) {
  if (row == column) {
    matrix_.diagonal[to_index(row)] += block;
  } else if (row < column) {
    matrix_.coupling[to_index(couplings_.at(row, column))] += block;
  }
}

}  // namespace weft::particle_sft
