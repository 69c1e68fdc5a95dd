// SPDX-License-Identifier: Apache-2.0
#include "robust_affine.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::pizarro {
namespace {

constexpr double kFlat = 0.02;         // sine of the least angle at a triangle's first corner
constexpr double kLeastSigmaPx = 0.5;  // keypoints are no better

}  // namespace

std::vector<Triple> spread_triples(int count, int wanted) {
  std::vector<Triple> all;
  for (int a = 0; a < count; ++a) {
    for (int b = a + 1; b < count; ++b) {
      for (int c = b + 1; c < count; ++c) all.push_back({a, b, c});
    }
  }
  const auto most = to_index(wanted);
  if (all.size() <= most) return all;
  std::vector<Triple> spread;
  for (std::size_t t = 0; t < most; ++t) spread.push_back(all[t * all.size() / most]);
  return spread;
}

std::optional<RobustAffine> least_median_affine(const Points2& p, const Points2& q,
                                                std::span<const Triple> triples) {
  const auto n = to_index(p.rows());
  const std::size_t middle = n / 2;
  std::vector<double> residuals2(n);
  std::optional<RobustAffine> best;
  double least2 = 0.0;
  for (const auto& [a, b, c] : triples) {
    worked(3 * static_cast<std::int64_t>(n));
    Eigen::Matrix2d in_template, in_image;
    in_template << p.row(b) - p.row(a), p.row(c) - p.row(a);
    in_image << q.row(b) - q.row(a), q.row(c) - q.row(a);
    const double arms = in_template.row(0).norm() * in_template.row(1).norm();
    if (!(std::abs(in_template.determinant()) > kFlat * arms)) continue;
    const RobustAffine map{p.row(a), q.row(a), in_template.inverse() * in_image};
    for (std::size_t k = 0; k < n; ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      residuals2[k] = (map(p.row(row)) - q.row(row)).squaredNorm();
    }
    std::nth_element(residuals2.begin(), residuals2.begin() + static_cast<std::ptrdiff_t>(middle),
                     residuals2.end());
    if (best && residuals2[middle] >= least2) continue;
    best = map;
    least2 = residuals2[middle];
  }
  if (!best) return best;
  // The factor makes up for three residuals that are zero (Rousseeuw and Leroy 1987).
  const double few = 1.0 + 5.0 / std::max(1.0, static_cast<double>(n) - 3.0);
  best->sigma_px = std::max(kSigmaPerMad * few * std::sqrt(least2), kLeastSigmaPx);
  return best;
}

}  // namespace weft::pizarro
