// SPDX-License-Identifier: Apache-2.0
#include "match_plane.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace weft::tran {
namespace {

constexpr double kLeastArea = 1e-4;  // of a triangle in normalised coordinates
constexpr double kMissed = 0.01;     // probability that a better plane is not drawn

double doubled_area(const Eigen::RowVector2d& ab, const Eigen::RowVector2d& ac) {
  return std::abs(ab.x() * ac.y() - ab.y() * ac.x());
}

/// Draws after which a triple of agreeing matches was drawn, but for kMissed.
double draws_for(double agreeing_share) {
  const double triple = agreeing_share * agreeing_share * agreeing_share;
  if (triple >= 1.0) return 1.0;
  return std::log(kMissed) / std::log1p(-triple);
}

}  // namespace

void MatchPlane::distances2(const MatchPoints& matches, Eigen::ArrayXd& distances2) const {
  distances2.resize(matches.rows());
  for (Eigen::Index i = 0; i < matches.rows(); ++i) {
    const Eigen::RowVector4d d = matches.row(i) - origin;
    const Eigen::RowVector2d y = d * basis;
    distances2[i] = std::max(0.0, d.squaredNorm() - y.squaredNorm());
  }
}

std::optional<MatchPlane> plane_through(const MatchPoints& matches, Eigen::Index a, Eigen::Index b,
                                        Eigen::Index c) {
  const Eigen::RowVector4d ab = matches.row(b) - matches.row(a);
  const Eigen::RowVector4d ac = matches.row(c) - matches.row(a);
  if (doubled_area(ab.head<2>(), ac.head<2>()) < kLeastArea ||
      doubled_area(ab.tail<2>(), ac.tail<2>()) < kLeastArea) {
    return std::nullopt;
  }
  MatchPlane plane;
  plane.origin = matches.row(a);
  plane.basis.col(0) = ab.transpose().normalized();
  plane.basis.col(1) =
      (ac.transpose() - plane.basis.col(0) * ac.dot(plane.basis.col(0))).normalized();
  return plane;
}

MatchPlane plane_of(const MatchPoints& matches, const std::vector<std::uint8_t>& chosen) {
  MatchPlane plane;
  double count = 0.0;
  for (Eigen::Index i = 0; i < matches.rows(); ++i) {
    if (chosen[static_cast<std::size_t>(i)] == 0) continue;
    plane.origin += matches.row(i);
    count += 1.0;
  }
  plane.origin /= count;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < matches.rows(); ++i) {
    if (chosen[static_cast<std::size_t>(i)] == 0) continue;
    const Eigen::RowVector4d d = matches.row(i) - plane.origin;
    scatter += d.transpose() * d;
  }
  plane.basis =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(scatter).eigenvectors().rightCols<2>();
  return plane;
}

std::optional<Found> search(const MatchPoints& matches, const Search& search, Rng& rng) {
  const Eigen::Index n = matches.rows();
  if (n < 3) return std::nullopt;
  const double limit2 = search.limit * search.limit;
  std::optional<Found> best;
  double least_cost = 0.0;
  Eigen::ArrayXd distances2;
  double needed = search.most_draws;
  int draws = 0;
  const auto bound = static_cast<std::uint32_t>(n);
  while (draws < needed) {
    ++draws;
    const auto a = static_cast<Eigen::Index>(rng.below(bound));
    const auto b = static_cast<Eigen::Index>(rng.below(bound));
    const auto c = static_cast<Eigen::Index>(rng.below(bound));
    if (a == b || b == c || a == c) continue;
    const auto plane = plane_through(matches, a, b, c);
    if (!plane || (search.keep_orientation && !plane->keeps_orientation())) continue;
    plane->distances2(matches, distances2);
    const Eigen::Index agreeing = (distances2 < limit2).count();
    const double cost = distances2.min(limit2).sum();
    if (best && (agreeing < best->agreeing || (agreeing == best->agreeing && cost >= least_cost))) {
      continue;
    }
    best = Found{*plane, agreeing, 0};
    least_cost = cost;
    const double share = static_cast<double>(agreeing) / static_cast<double>(n);
    needed = std::min<double>(search.most_draws, draws_for(share));
  }
  if (best) best->draws = draws;
  return best;
}

}  // namespace weft::tran
