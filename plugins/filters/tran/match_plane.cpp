// SPDX-License-Identifier: Apache-2.0
#include "match_plane.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::tran {
namespace {

constexpr double kLeastArea = 1e-4;   // area of a triangle, doubled, in normalised coordinates
constexpr double kCollinear = 1e-12;  // measure of a scatter: determinant over squared trace
constexpr double kMissed = 0.01;      // probability to miss a better plane

Eigen::Matrix<double, 4, 2> normals_of(const Eigen::Matrix2d& slope, Residual residual) {
  Eigen::Matrix<double, 4, 2> normals;
  normals << slope, -Eigen::Matrix2d::Identity();
  if (residual == Residual::regression) return normals;
  normals.col(0).normalize();
  normals.col(1) -= normals.col(0) * normals.col(0).dot(normals.col(1));
  normals.col(1).normalize();
  return normals;
}

/// Samples after which a triple of agreeing matches was drawn at random, except with the
/// probability kMissed.
double draws_for(double agreeing_share) {
  const double triple = agreeing_share * agreeing_share * agreeing_share;
  if (triple >= 1.0) return 1.0;
  return std::log(kMissed) / std::log1p(-triple);
}

}  // namespace

void MatchPlane::distances2(const MatchPoints& matches, Eigen::ArrayXd& distances2) const {
  const Eigen::RowVector2d offset = origin * normals;
  const auto along = [&](Eigen::Index k) {
    return (matches.col(0).array() * normals(0, k) + matches.col(1).array() * normals(1, k) +
            matches.col(2).array() * normals(2, k) + matches.col(3).array() * normals(3, k) -
            offset[k])
        .square();
  };
  distances2 = along(0) + along(1);
}

std::optional<MatchPlane> plane_through(const MatchPoints& matches, Eigen::Index a, Eigen::Index b,
                                        Eigen::Index c, const Search& search) {
  Eigen::Matrix<double, 2, 4> arms;
  arms << matches.row(b) - matches.row(a), matches.row(c) - matches.row(a);
  const double in_template = arms.leftCols<2>().determinant();
  const double in_image = arms.rightCols<2>().determinant();
  if (std::abs(in_template) < kLeastArea || std::abs(in_image) < kLeastArea) return std::nullopt;
  if (search.keep_orientation && in_template * in_image < 0.0) return std::nullopt;
  const Eigen::Matrix2d slope = arms.leftCols<2>().inverse() * arms.rightCols<2>();
  return MatchPlane{matches.row(a), normals_of(slope, search.residual)};
}

std::optional<MatchPlane> plane_of(const MatchPoints& matches,
                                   const std::vector<std::uint8_t>& chosen, Residual residual) {
  MatchPlane plane;
  double count = 0.0;
  for (Eigen::Index i = 0; i < matches.rows(); ++i) {
    if (chosen[to_index(i)] == 0) continue;
    plane.origin += matches.row(i);
    count += 1.0;
  }
  plane.origin /= count;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (Eigen::Index i = 0; i < matches.rows(); ++i) {
    if (chosen[to_index(i)] == 0) continue;
    const Eigen::RowVector4d d = matches.row(i) - plane.origin;
    scatter += d.transpose() * d;
  }
  const Eigen::Matrix2d in_template = scatter.topLeftCorner<2, 2>();
  const double trace = in_template.trace();
  if (!(in_template.determinant() > kCollinear * trace * trace)) return std::nullopt;
  plane.normals =
      residual == Residual::orthogonal
          ? Eigen::Matrix<double, 4, 2>(Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(scatter)
                                            .eigenvectors()
                                            .leftCols<2>())
          : normals_of(in_template.inverse() * scatter.topRightCorner<2, 2>(), residual);
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
    worked(n / 2);
    const auto a = static_cast<Eigen::Index>(rng.below(bound));
    const auto b = static_cast<Eigen::Index>(rng.below(bound));
    const auto c = static_cast<Eigen::Index>(rng.below(bound));
    if (a == b || b == c || a == c) continue;
    const auto plane = plane_through(matches, a, b, c, search);
    if (!plane) continue;
    plane->distances2(matches, distances2);
    const Eigen::Index agreeing = (distances2 < limit2).count();
    if (best && agreeing < best->agreeing) continue;
    const double cost = distances2.min(limit2).sum();
    if (best && agreeing == best->agreeing && cost >= least_cost) continue;
    best = Found{*plane, agreeing, 0};
    least_cost = cost;
    const double share = static_cast<double>(agreeing) / static_cast<double>(n);
    needed = std::min<double>(search.most_draws, draws_for(share));
  }
  if (best) best->draws = draws;
  return best;
}

}  // namespace weft::tran
