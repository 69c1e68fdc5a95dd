// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::particle_sft {
namespace {

constexpr double kPriorM = 0.3;
constexpr double kMiB = 1024.0 * 1024.0, kMostBytes = 1024.0 * kMiB;  // 38,000 vertices of a square
constexpr double kLeastRadiusM = 5e-4;  // a known point that is held exactly is known this well

/// Vertices by their place along the longest principal axis of the mesh.
std::vector<std::int32_t> along_longest_axis(const Points3& rest_m) {
  const Points3 centred_m = rest_m.rowwise() - rest_m.colwise().mean();
  const Eigen::Matrix3d spread = centred_m.transpose() * centred_m;
  const Eigen::Vector3d axis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(2);
  const Eigen::VectorXd along_m = centred_m * axis;
  std::vector<std::int32_t> order(to_index(rest_m.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::int32_t a, std::int32_t b) { return along_m[a] < along_m[b]; });
  return order;
}

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
  hinges_ = mesh.hinges();
  rest_bends_rad_.clear();
  for (const BendingHinge& hinge : hinges_) {
    rest_bends_rad_.push_back(bend_rad(hinge, mesh.rest_m()));
  }
  const std::vector<std::int32_t> order = along_longest_axis(mesh.rest_m());
  place_.resize(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    place_[to_index(order[k])] = 3 * static_cast<Eigen::Index>(k);
  }
  Eigen::Index apart = 0;
  const auto join = [&](std::int32_t i, std::int32_t j) {
    apart = std::max(apart, std::abs(place_[to_index(i)] - place_[to_index(j)]));
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
                     ": set covariance: false, or give a template with fewer vertices"};
  }
  band_.resize(to_index(size_ + (size_ - 1) * below_));
  column_.resize(below_);
  shared_.resize(size_);
  return {};
}

double ShapeCovariance::curvature_per_m(const Points3& vertices_m,
                                        const std::vector<std::uint8_t>& seen) const {
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t h = 0; h < hinges_.size(); ++h) {
    if (!all_seen(hinges_[h], seen)) continue;
    const double turn_rad = bend_rad(hinges_[h], vertices_m) - rest_bends_rad_[h];
    squares += std::pow(turn_rad / width_m(hinges_[h]), 2);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

bool ShapeCovariance::compute(const ParticleSystem& system, const std::vector<std::uint8_t>& seen,
                              const Pinhole& camera, const Points3& vertices_m,
                              const HoldingNoise& noise, double* covariance_m2) {
  std::fill(band_.begin(), band_.end(), 0.0);
  for (Eigen::Index i = 0; i < size_; ++i) at(i, i) = 1.0 / (kPriorM * kPriorM);
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
  if (!factorise()) return false;
  const double shared = noise.common_strain > 0.0 ? share_of_common(noise.common_strain) : 0.0;
  if (!(shared >= 0.0) || !std::isfinite(shared)) return false;
  invert();
  for (const Eigen::Index from : place_) {
    for (Eigen::Index r = 0; r < 3; ++r) {
      for (Eigen::Index c = 0; c < 3; ++c) {
        *covariance_m2++ = at(from + std::max(r, c), from + std::min(r, c)) +
                           shared * shared_[from + r] * shared_[from + c];
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
    add_block(edge.i, edge.i, block);
    add_block(edge.j, edge.j, block);
    add_block(edge.i, edge.j, -block);
    add_block(edge.j, edge.i, -block);
    shared_.segment<3>(place_[to_index(edge.i)]) += weight * along;
    shared_.segment<3>(place_[to_index(edge.j)]) -= weight * along;
    edge_weights_ += weight;
  }
}

void ShapeCovariance::add_bends(const std::vector<std::uint8_t>& seen, const HoldingNoise& noise) {
  for (const BendingHinge& hinge : hinges_) {
    double variance = noise.bend_rad * noise.bend_rad;
    if (!all_seen(hinge, seen)) {
      variance += 3.0 * noise.unseen_bend * noise.unseen_bend / hinge.weight;
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
  const Eigen::Index first = place_[to_index(row)];
  const Eigen::Index second = place_[to_index(column)];
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

/// Replaces the column h of the common strain by g = H^-1 h; returns the variance of that strain,
/// v = 1 / (h_ee - h^T g): the inverse of H with its border is H^-1 + v g g^T.
double ShapeCovariance::share_of_common(double common_strain) {
  double left = edge_weights_ + 1.0 / (common_strain * common_strain);
  for (Eigen::Index j = 0; j < size_; ++j) {  // y = L^-1 h, left = h_ee - y^T D^-1 y
    const Eigen::Index below = std::min(below_, size_ - 1 - j);
    left -= shared_[j] * shared_[j] * at(j, j);
    if (below > 0) {
      shared_.segment(j + 1, below) -=
          shared_[j] * Eigen::Map<const Eigen::VectorXd>(&at(j + 1, j), below);
    }
  }
  for (Eigen::Index j = size_ - 1; j >= 0; --j) {
    const Eigen::Index below = std::min(below_, size_ - 1 - j);
    shared_[j] *= at(j, j);
    if (below > 0) {
      shared_[j] -= shared_.segment(j + 1, below)
                        .dot(Eigen::Map<const Eigen::VectorXd>(&at(j + 1, j), below));
    }
  }
  return 1.0 / left;
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
