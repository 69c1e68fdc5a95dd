// SPDX-License-Identifier: Apache-2.0
#include "common/scene/cloth.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <weft/core/index.hpp>
#include <weft/geometry/mesh_topology.hpp>
#include <weft/geometry/rectangular_grid.hpp>

namespace weft::scene {
namespace {

double length_of(const Points3View& points, std::int32_t i, std::int32_t j) {
  return (points.row(i) - points.row(j)).norm();
}

void measure(const Points3View& surface_m, std::vector<DistanceConstraint>& constraints) {
  for (DistanceConstraint& c : constraints) c.rest_length_m = length_of(surface_m, c.i, c.j);
}

std::vector<DistanceConstraint> bonds_between(const Edges& pairs) {
  std::vector<DistanceConstraint> bonds;
  for (Eigen::Index e = 0; e < pairs.rows(); ++e) bonds.push_back({pairs(e, 0), pairs(e, 1), 0});
  return bonds;
}

}  // namespace

Result<Cloth> Cloth::create(int columns, int rows, const Points3View& flat_m,
                            const ClothSettings& settings) {
  if (columns < 3 || rows < 3 || flat_m.rows() != Eigen::Index{columns} * rows) {
    return Error{Errc::invalid_value,
                 "a cloth of " + std::to_string(columns) + " x " + std::to_string(rows) +
                     " vertices is not possible: give at least 3 x 3, and a place for each"};
  }
  return Cloth(flat_m, bonds_of_grid(columns, rows), settings);
}

Result<Cloth> Cloth::create(const Points3View& rest_m, const FacesView& faces,
                            const ClothSettings& settings) {
  const auto topology = build_topology(faces, rest_m.rows());
  if (!topology) return topology.error();
  return Cloth(rest_m, {bonds_between(topology->edges), {}, bonds_between(topology->bending_pairs)},
               settings);
}

Cloth::Cloth(const Points3View& rest_m, Bonds bonds, const ClothSettings& settings)
    : settings_(settings),
      position_m_(rest_m),
      before_m_(rest_m),
      velocity_m_per_s_(Points3::Zero(rest_m.rows(), 3)),
      mobility_(to_index(rest_m.rows()), 1.0),
      edges_(std::move(bonds.edges)),
      shear_(std::move(bonds.shear)),
      bending_(std::move(bonds.bending)) {
  set_lengths_of(rest_m);
}

Cloth::Bonds Cloth::bonds_of_grid(int columns, int rows) {
  const Faces faces = *rectangular_grid_faces(columns, rows);
  Bonds bonds;
  bonds.edges = bonds_between(build_topology(faces, Eigen::Index{columns} * rows)->edges);
  const auto vertex = [&](int i, int j) { return static_cast<std::int32_t>(j * columns + i); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      if (i + 1 < columns && j + 1 < rows) {
        // The mesh has one diagonal of the cell; this is the other one.
        const bool falling = (i + j) % 2 != 0;
        bonds.shear.push_back(
            {vertex(i, j + (falling ? 0 : 1)), vertex(i + 1, j + (falling ? 1 : 0)), 0});
      }
      if (i + 2 < columns) bonds.bending.push_back({vertex(i, j), vertex(i + 2, j), 0});
      if (j + 2 < rows) bonds.bending.push_back({vertex(i, j), vertex(i, j + 2), 0});
    }
  }
  return bonds;
}

void Cloth::set_lengths_of(const Points3View& surface_m) {
  measure(surface_m, edges_);
  measure(surface_m, shear_);
  measure(surface_m, bending_);
}

Result<void> Cloth::step(double duration_s, std::span<const ClothGuide> guides) {
  std::fill(mobility_.begin(), mobility_.end(), 1.0);
  for (const ClothGuide& guide : guides) {
    if (guide.compliance <= 0.0) mobility_[to_index(guide.vertex)] = 0.0;
  }
  if (last_guides_.size() != guides.size()) last_guides_.assign(guides.begin(), guides.end());
  std::vector<ClothGuide> moving(guides.begin(), guides.end());
  for (int k = 1; k <= settings_.substeps; ++k) {
    const double share = static_cast<double>(k) / settings_.substeps;
    for (std::size_t g = 0; g < guides.size(); ++g) {
      moving[g].target_m = (1.0 - share) * last_guides_[g].target_m + share * guides[g].target_m;
    }
    substep(duration_s / settings_.substeps, moving);
  }
  last_guides_.assign(guides.begin(), guides.end());
  return sweep_until_unstrained();
}

void Cloth::substep(double h_s, std::span<const ClothGuide> guides) {
  before_m_ = position_m_;
  velocity_m_per_s_.col(2).array() += h_s * settings_.push_m_per_s2;
  position_m_ += h_s * velocity_m_per_s_;
  pull_to_guides(h_s, guides);
  project(bending_, settings_.bending_compliance / (h_s * h_s));
  project(shear_, 0.0);
  project(edges_, 0.0);
  velocity_m_per_s_ = settings_.kept_velocity / h_s * (position_m_ - before_m_);
}

void Cloth::pull_to_guides(double h_s, std::span<const ClothGuide> guides) {
  for (const ClothGuide& guide : guides) {
    const double softness = std::max(guide.compliance, 0.0) / (h_s * h_s);
    const Eigen::RowVector3d off = guide.target_m.transpose() - position_m_.row(guide.vertex);
    position_m_.row(guide.vertex) += off / (1.0 + softness);
  }
}

void Cloth::project(std::span<const DistanceConstraint> constraints, double softness) {
  double* const x = position_m_.data();
  for (const DistanceConstraint& c : constraints) {
    double* const a = x + std::ptrdiff_t{3} * c.i;
    double* const b = x + std::ptrdiff_t{3} * c.j;
    const double wa = mobility_[to_index(c.i)];
    const double wb = mobility_[to_index(c.j)];
    const double dx = b[0] - a[0], dy = b[1] - a[1], dz = b[2] - a[2];
    const double length = std::sqrt(dx * dx + dy * dy + dz * dz);
    if (wa + wb <= 0.0 || length <= 0.0) continue;
    const double move = (length - c.rest_length_m) / (length * (wa + wb + softness));
    const double to_b = wa * move, to_a = -wb * move;
    a[0] += to_b * dx, a[1] += to_b * dy, a[2] += to_b * dz;
    b[0] += to_a * dx, b[1] += to_a * dy, b[2] += to_a * dz;
  }
}

Result<void> Cloth::sweep_until_unstrained() {
  constexpr int kBetweenChecks = 10;
  for (int sweeps = 0;; sweeps += kBetweenChecks) {
    const double worst = worst_strain();
    if (worst < settings_.largest_strain) return {};
    if (sweeps >= settings_.most_sweeps || !std::isfinite(worst)) {
      return Error{Errc::invalid_value,
                   "the surface cannot keep its lengths: an edge is strained by " +
                       std::to_string(100.0 * worst) +
                       " %; let it bend or move less, or give it more vertices"};
    }
    for (int k = 0; k < kBetweenChecks; ++k) project(edges_, 0.0);
  }
}

double Cloth::worst_strain() const {
  const std::vector<double> all = strains(edges_, position_m_);
  double worst = 0.0;
  for (const double strain : all) {
    if (!(strain <= worst)) worst = strain;  // NaN stays
  }
  return worst;
}

}  // namespace weft::scene
