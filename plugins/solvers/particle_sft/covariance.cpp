// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <weft/core/stop_check.hpp>
#include <weft/geometry/surface_distance.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kPriorM = 0.1;
constexpr double kMiB = 1024.0 * 1024.0, kMostBytes = 1024.0 * kMiB;  // 38,000 vertices of a square
constexpr double kLeastRadiusM = 5e-4;  // a known point that is held exactly is known this well

/// Vertices by their place along the longest principal axis of the mesh.
std::vector<std::int32_t> along_longest_axis(const Points3& rest_m) {
  const Points3 centred_m = rest_m.rowwise() - rest_m.colwise().mean();
  const Eigen::Matrix3d spread = centred_m.transpose() * centred_m;
  const Eigen::Vector3d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  const Eigen::VectorXd along_m = centred_m * axis;
  std::vector<std::int32_t> order(static_cast<std::size_t>(rest_m.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return along_m[a] < along_m[b]; });
  return order;
}

}  // namespace

HoldingNoise holding_noise(double residual_px, std::size_t sightlines, int agreeing_matches,
                           double diagonal_m) {
  constexpr double kLeastPx = 0.1, kNoiseOfResidual = 6.0, kShared = 0.5, kUnseenBend = 2.0;
  const double sharing = static_cast<double>(sightlines) / std::max(1, agreeing_matches);
  return {std::hypot(kLeastPx, kNoiseOfResidual * residual_px) * std::sqrt(1.0 + kShared * sharing),
          0.0015, 0.05, kUnseenBend / diagonal_m};
}

Result<void> ShapeCovariance::build(const MeshModel& mesh) {
  hinges_ = mesh.hinges();
  rest_m_ = mesh.rest_m();
  neighbours_ = mesh.neighbours();
  const std::vector<std::int32_t> order = along_longest_axis(mesh.rest_m());
  place_.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    place_[static_cast<std::size_t>(order[k])] = 3 * static_cast<Eigen::Index>(k);
  }
  Eigen::Index apart = 0;
  const auto join = [&](std::int32_t i, std::int32_t j) {
    apart = std::max(
        apart, std::abs(place_[static_cast<std::size_t>(i)] - place_[static_cast<std::size_t>(j)]));
  };
  for (const DistanceConstraint& pair : mesh.stretch()) join(pair.i, pair.j);
  for (const DistanceConstraint& pair : mesh.bending()) join(pair.i, pair.j);
  size_ = 3 * static_cast<Eigen::Index>(order.size());
  below_ = std::min(apart + 2, size_ - 1);
  const double bytes = 8.0 * static_cast<double>(size_) * static_cast<double>(below_ + 1);
  if (bytes > kMostBytes) {
    return Error{Errc::unsupported,
                 "the covariance of " + std::to_string(order.size()) + " vertices needs " +
                     std::to_string(std::llround(bytes / kMiB)) + " MiB, more than " +
                     std::to_string(std::llround(kMostBytes / kMiB)) +
                     ": set covariance: false, or give a template with fewer vertices",
                 {}};
  }
  band_.resize(static_cast<std::size_t>(size_ + (size_ - 1) * below_));
  column_.resize(below_);
  return {};
}

bool ShapeCovariance::compute(const ParticleSystem& system, const Pinhole& camera,
                              const Points3& vertices_m, const HoldingNoise& noise,
                              double* covariance_m2) {
  std::fill(band_.begin(), band_.end(), 0.0);
  for (Eigen::Index i = 0; i < size_; ++i) at(i, i) = 1.0 / (kPriorM * kPriorM);
  add_rays(system, camera, vertices_m, noise.ray_px);
  add_edges(system.stretch, vertices_m, noise.strain);
  add_bends(system, noise);
  for (const KnownSurfacePoint& known : system.spheres) {
    const double trust = std::pow(std::max(known.radius_m, kLeastRadiusM), -2);
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) {
        add_block(known.vertices[r], known.vertices[c],
                  trust * known.weights[r] * known.weights[c] * Eigen::Matrix3d::Identity());
      }
    }
  }
  if (!factorise()) return false;
  invert();
  for (const Eigen::Index from : place_) {
    for (Eigen::Index r = 0; r < 3; ++r) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        *covariance_m2++ = at(from + std::max(r, c), from + std::min(r, c));
      }
    }
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

void ShapeCovariance::add_edges(const std::vector<DistanceConstraint>& edges,
                                const Points3& vertices_m, double strain) {
  for (const DistanceConstraint& edge : edges) {
    const Eigen::Vector3d along =
        (vertices_m.row(edge.j) - vertices_m.row(edge.i)).transpose().normalized();
    const Eigen::Matrix3d block =
        std::pow(strain * edge.rest_length_m, -2) * along * along.transpose();
    add_block(edge.i, edge.i, block);
    add_block(edge.j, edge.j, block);
    add_block(edge.i, edge.j, -block);
    add_block(edge.j, edge.i, -block);
  }
}

/// Of each vertex, in m along the edges at rest; infinite where no path leads to what is seen.
/// Empty where all vertices are seen.
std::vector<double> ShapeCovariance::distances_to_seen_m(const ParticleSystem& system) const {
  const std::vector<std::uint8_t> seen =
      held_vertices(system.rays, system.spheres, static_cast<Eigen::Index>(place_.size()));
  std::vector<PathStart> starts;
  for (std::size_t v = 0; v < seen.size(); ++v) {
    if (seen[v] != 0) starts.push_back({static_cast<std::int32_t>(v), 0.0});
  }
  if (starts.size() == seen.size()) return {};
  return path_lengths_m(rest_m_, neighbours_, starts);
}

void ShapeCovariance::add_bends(const ParticleSystem& system, const HoldingNoise& noise) {
  const std::vector<double> from_seen_m =
      noise.bend_per_m > 0.0 ? distances_to_seen_m(system) : std::vector<double>{};
  for (const BendingHinge& hinge : hinges_) {
    double variance = noise.bend_rad * noise.bend_rad;
    if (!from_seen_m.empty()) {
      double furthest_m = 0.0;
      for (const std::int32_t v : hinge.vertex) {
        furthest_m = std::max(furthest_m, from_seen_m[static_cast<std::size_t>(v)]);
      }
      const double width_m =
          (1.0 / hinge.coefficient_per_m[2] + 1.0 / hinge.coefficient_per_m[3]) / 3.0;
      variance += 3.0 * noise.bend_per_m * noise.bend_per_m * width_m * furthest_m;
    }
    for (std::size_t r = 0; r < 4; ++r) {
      for (std::size_t c = 0; c < 4; ++c) {
        add_block(hinge.vertex[r], hinge.vertex[c],
                  hinge.coefficient_per_m[r] * hinge.coefficient_per_m[c] / variance *
                      Eigen::Matrix3d::Identity());
      }
    }
  }
}

/// Keeps what is in the lower half.
void ShapeCovariance::add_block(std::int32_t row, std::int32_t column,
                                const Eigen::Matrix3d& block) {
  const Eigen::Index first = place_[static_cast<std::size_t>(row)];
  const Eigen::Index second = place_[static_cast<std::size_t>(column)];
  if (first < second) return;
  for (Eigen::Index c = 0; c < 3; ++c) {
    for (Eigen::Index r = first == second ? c : 0; r < 3; ++r) {
      at(first + r, second + c) += block(r, c);
    }
  }
}

/// H = L D L^T with 1 / D on the diagonal, L below it.
bool ShapeCovariance::factorise() {
  for (Eigen::Index j = 0; j < size_; ++j) {
    const double pivot = at(j, j);
    if (!(pivot > 0.0) || !std::isfinite(pivot)) return false;
    at(j, j) = 1.0 / pivot;
    const Eigen::Index below = std::min(below_, size_ - 1 - j);
    if (below == 0) continue;
    worked(below * below / 16);
    Eigen::Map<Eigen::VectorXd> column(&at(j + 1, j), below);
    window(j + 1, below).selfadjointView<Eigen::Lower>().rankUpdate(column, -1.0 / pivot);
    column /= pivot;
  }
  return true;
}

/// From the last row: Z = H^-1 has Z_ij = [i = j] / D_j - sum_k L_kj Z_ik, k > j, i >= j.
void ShapeCovariance::invert() {
  for (Eigen::Index j = size_ - 2; j >= 0; --j) {
    const Eigen::Index below = std::min(below_, size_ - 1 - j);
    Eigen::Map<Eigen::VectorXd> column(&at(j + 1, j), below);
    auto solved = column_.head(below);
    worked(below * below / 16);
    solved.noalias() = window(j + 1, below).selfadjointView<Eigen::Lower>() * column;
    at(j, j) += column.dot(solved);
    column = -solved;
  }
}

}  // namespace weft::particle_sft
