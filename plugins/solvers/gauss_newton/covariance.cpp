// SPDX-License-Identifier: Apache-2.0
#include "covariance.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>

#include "terms.hpp"

namespace weft::gauss_newton {
namespace {

constexpr double kPriorM = 0.3;
constexpr double kLeastRadiusM = 5e-4;  // a known point that is held exactly is known this well

bool all_seen(const Hinge& hinge, const std::vector<std::uint8_t>& seen) {
  return std::all_of(hinge.vertex.begin(), hinge.vertex.end(),
                     [&](std::int32_t v) { return seen[to_index(v)] != 0; });
}

}  // namespace

double observed_noise(double residual, double coherence) {
  return std::hypot(0.1, 2.0 * residual * std::sqrt(coherence));
}

HoldingNoise holding_noise(const ShapeSigns& signs) {
  HoldingNoise noise;
  noise.observed = observed_noise(signs.residual, signs.coherence);
  // A strain that varies from edge to edge may as well be common to all of them.
  noise.strain = std::hypot(0.0015, signs.strain);
  noise.bend_rad = 0.05;
  noise.common_strain = std::hypot(0.0005, signs.strain, signs.scale_noise);
  noise.unseen_strain = 0.03;
  noise.unseen_bend = 0.23 * std::hypot(1.0, 2.0 * signs.curvature_per_m * signs.diagonal_m);
  return noise;
}

void ShapeCovariance::prepare(const MeshModel& mesh) {
  mesh_ = &mesh;
  matrix_.diagonal.resize(to_index(mesh.vertex_count()));
  matrix_.coupling.resize(mesh.couplings.size());
  inverse_.resize(matrix_.diagonal.size());
  normals_.resize(mesh.faces.rows(), 3);
  shared_.resize(mesh.vertex_count(), 3);
  solved_.resize(mesh.vertex_count(), 3);
}

double ShapeCovariance::curvature_per_m(const Points3& vertices_m,
                                        const std::vector<std::uint8_t>& seen) {
  face_normals(vertices_m, mesh_->faces, normals_);
  double squares = 0.0;
  std::size_t count = 0;
  for (const Hinge& hinge : mesh_->hinges) {
    if (!all_seen(hinge, seen)) continue;
    const double turn_rad = angle_rad(hinge, normals_, vertices_m) - hinge.rest_rad;
    squares += std::pow(turn_rad / hinge.width_m, 2);
    ++count;
  }
  return count == 0 ? 0.0 : std::sqrt(squares / static_cast<double>(count));
}

bool ShapeCovariance::compute(const FrameData& frame, const Scales& scales,
                              const std::vector<std::uint8_t>& seen, const Points3& vertices_m,
                              const HoldingNoise& noise, Energy& energy, BlockCholesky& factor,
                              double* covariance_m2) {
  matrix_.set_zero();
  energy.add_observations(frame, scales, vertices_m, matrix_);
  const double trust = std::pow(noise.observed, -2);
  for (auto* blocks : {&matrix_.diagonal, &matrix_.coupling}) {
    for (Eigen::Matrix3d& block : *blocks) block *= trust;
  }
  if (frame.outline.present()) {
    Scales weighted = scales;
    weighted.outline.noise_px *= noise.outline;
    energy.add_outline(frame, weighted, vertices_m, matrix_);
  }
  add_edges(seen, vertices_m, noise);
  add_bends(seen, vertices_m, noise);
  add_known(frame);
  if (!factor.factorise(matrix_, 1.0 / (kPriorM * kPriorM))) return false;
  double shared_m2 = 0.0;
  if (noise.common_strain > 0.0) {
    // The inverse of H with the border of e is H^-1 + v g g^T, g = H^-1 h, v = 1 / (h_ee - h^T g).
    solved_ = shared_;
    factor.solve(solved_);
    const double left =
        edge_weights_ + std::pow(noise.common_strain, -2) - shared_.cwiseProduct(solved_).sum();
    if (!(left > 0.0) || !std::isfinite(left)) return false;
    shared_m2 = 1.0 / left;
  }
  factor.inverse_blocks(inverse_);
  for (std::size_t v = 0; v < inverse_.size(); ++v) {
    const Eigen::Vector3d of_e = solved_.row(static_cast<Eigen::Index>(v)).transpose();
    if (shared_m2 > 0.0) inverse_[v] += shared_m2 * of_e * of_e.transpose();
    std::copy_n(inverse_[v].data(), 9, covariance_m2 + 9 * v);
  }
  return true;
}

void ShapeCovariance::add_edges(const std::vector<std::uint8_t>& seen, const Points3& vertices_m,
                                const HoldingNoise& noise) {
  shared_.setZero();
  edge_weights_ = 0.0;
  const double known = std::pow(noise.strain, -2);
  const double unknown =
      1.0 / (noise.strain * noise.strain + noise.unseen_strain * noise.unseen_strain);
  for (const Arc& edge : mesh_->edges) {
    const Eigen::Vector3d along =
        (vertices_m.row(edge.j) - vertices_m.row(edge.i)).transpose().normalized() / edge.rest_m;
    const bool is_seen = seen[to_index(edge.i)] != 0 && seen[to_index(edge.j)] != 0;
    const double weight = is_seen ? known : unknown;
    add_square(edge, weight * along * along.transpose(), matrix_);
    shared_.row(edge.i) += weight * along.transpose();
    shared_.row(edge.j) -= weight * along.transpose();
    edge_weights_ += weight;
  }
}

void ShapeCovariance::add_bends(const std::vector<std::uint8_t>& seen, const Points3& vertices_m,
                                const HoldingNoise& noise) {
  face_normals(vertices_m, mesh_->faces, normals_);
  for (const Hinge& hinge : mesh_->hinges) {
    double variance = noise.bend_rad * noise.bend_rad;
    if (!all_seen(hinge, seen)) {
      variance += 3.0 * noise.unseen_bend * noise.unseen_bend / hinge.weight;
    }
    HingeSlopes slopes = angle_slopes(hinge, normals_, vertices_m);
    for (Eigen::Vector3d& slope : slopes) slope /= std::sqrt(variance);
    add_square(hinge, slopes, matrix_);
  }
}

void ShapeCovariance::add_known(const FrameData& frame) {
  for (const KnownSurfacePoint& known : frame.spheres) {
    const double trust = std::pow(std::max(known.radius_m, kLeastRadiusM), -2);
    add_square(*mesh_, known, trust * Eigen::Matrix3d::Identity(), matrix_);
  }
}

}  // namespace weft::gauss_newton
