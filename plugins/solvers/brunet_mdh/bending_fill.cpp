// SPDX-License-Identifier: Apache-2.0
#include "bending_fill.hpp"

#include <cstddef>
#include <weft/geometry/mesh_bending.hpp>
#include <weft/geometry/rigid_alignment.hpp>

#include "at.hpp"

namespace weft::brunet_mdh {
namespace {

constexpr double kRidge = 1e-6;
constexpr double kPointWeight = 100.0;

}  // namespace

void BendingFill::prepare(const RestSurface& surface, std::span<const SurfacePoint> points) {
  points_.assign(points.begin(), points.end());
  const Eigen::Index vertices = surface.vertices_m().rows();
  fixed_by_.assign(at(vertices), -1);
  unknown_.assign(at(vertices), -1);
  terms_.clear();
  const double scale = mean_edge_length(surface.vertices_m(), surface.topology().edges);
  ridge_ = kRidge / (scale * scale);
  for (const BendingHinge& hinge :
       bending_hinges(surface.vertices_m(), surface.faces(), surface.topology())) {
    terms_.push_back({hinge.weight, 4, hinge.vertex, hinge.coefficient_per_m, -1});
  }
  for (std::int32_t p = 0; p < static_cast<std::int32_t>(points_.size()); ++p) {
    const SurfacePoint& point = points_[at(p)];
    if (point.vertex >= 0) {
      fixed_by_[at(point.vertex)] = p;
      continue;
    }
    const auto corners = surface.support(point);
    terms_.push_back({kPointWeight / (scale * scale),
                      3,
                      {corners[0], corners[1], corners[2], 0},
                      {point.weights[0], point.weights[1], point.weights[2], 0.0},
                      p});
  }
  free_count_ = 0;
  for (std::size_t v = 0; v < unknown_.size(); ++v) {
    if (fixed_by_[v] < 0) unknown_[v] = static_cast<std::int32_t>(free_count_++);
  }
  if (free_count_ > 0) factorise();
}

void BendingFill::factorise() {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < free_count_; ++i) entries.emplace_back(i, i, ridge_);
  for (const Term& term : terms_) {
    for (int r = 0; r < term.count; ++r) {
      for (int c = 0; c < term.count; ++c) {
        const std::int32_t row = unknown_[at(term.vertex[at(r)])];
        const std::int32_t column = unknown_[at(term.vertex[at(c)])];
        if (row < 0 || column < 0 || row < column) continue;
        entries.emplace_back(row, column,
                             term.weight * term.coefficient[at(r)] * term.coefficient[at(c)]);
      }
    }
  }
  Eigen::SparseMatrix<double> normal(free_count_, free_count_);
  normal.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(normal);
}

Result<Points3> BendingFill::place(const RestSurface& surface, const Points3& positions_m) const {
  Points3 rest_m(positions_m.rows(), 3);
  for (Eigen::Index p = 0; p < rest_m.rows(); ++p) {
    rest_m.row(p) = surface.position_m(points_[at(p)]);
  }
  const auto rigid = align_points(rest_m, positions_m);
  if (!rigid) return rigid.error();
  const Points3 offsets = positions_m - transform_points(*rigid, rest_m);
  Points3 placed = transform_points(*rigid, surface.vertices_m());
  Eigen::MatrixX3d right = Eigen::MatrixX3d::Zero(free_count_, 3);
  for (const Term& term : terms_) {
    Eigen::RowVector3d known = Eigen::RowVector3d::Zero();
    if (term.target >= 0) known -= offsets.row(term.target);
    for (int k = 0; k < term.count; ++k) {
      const std::int32_t point = fixed_by_[at(term.vertex[at(k)])];
      if (point >= 0) known += term.coefficient[at(k)] * offsets.row(point);
    }
    for (int k = 0; k < term.count; ++k) {
      const std::int32_t row = unknown_[at(term.vertex[at(k)])];
      if (row >= 0) right.row(row) -= term.weight * term.coefficient[at(k)] * known;
    }
  }
  Eigen::MatrixX3d moves = right;
  if (free_count_ > 0) moves = factor_.solve(right);
  for (Eigen::Index v = 0; v < placed.rows(); ++v) {
    if (fixed_by_[at(v)] >= 0) {
      placed.row(v) = positions_m.row(fixed_by_[at(v)]);
    } else {
      placed.row(v) += moves.row(unknown_[at(v)]);
    }
  }
  return placed;
}

}  // namespace weft::brunet_mdh
