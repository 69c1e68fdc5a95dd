// SPDX-License-Identifier: Apache-2.0
#include "local_map.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::adalam {
namespace {

constexpr double kMissed = 1e-4;           // probability to miss a better map
constexpr double kLeastResidual2 = 1e-12;  // keeps confidences of exact maps finite

/// The map of least squares from template to image; nothing where it stretches too much.
class Fit {
 public:
  void add(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    moments_ += from * from.transpose();
    cross_ += to * from.transpose();
  }

  std::optional<Eigen::Matrix2d> map(double most_stretch) const {
    const double determinant = moments_.determinant(), trace = moments_.trace();
    if (!(determinant > 1e-12 * trace * trace)) return std::nullopt;
    const Eigen::Matrix2d map = cross_ * moments_.inverse();
    // The squares of the singular values have the sum |map|^2 and the product det^2.
    const double half = 0.5 * map.squaredNorm(), det = map.determinant();
    const double spread = std::sqrt(std::max(half * half - det * det, 0.0));
    const double most2 = most_stretch * most_stretch;
    if (half + spread > most2 || (half - spread) * most2 < 1.0) return std::nullopt;
    return map;
  }

 private:
  Eigen::Matrix2d moments_ = Eigen::Matrix2d::Zero(), cross_ = Eigen::Matrix2d::Zero();
};

/// Judges maps for one neighbourhood; memory is kept.
class Judge {
 public:
  Judge(const Neighbourhood& around, double min_confidence)
      : around_(around), min_confidence_(min_confidence), ranks_(around.size() + 2) {
    residual2_.resize(around.size());
  }

  /// The largest k for which the k-th smallest residual has min_confidence r^2 <= k / m. Residuals
  /// are counted by the least such k, instead of sorting them.
  std::size_t agreeing(const Eigen::Matrix2d& map) {
    const std::size_t m = around_.size();
    measure(map);
    std::fill(ranks_.begin(), ranks_.end(), 0U);
    const double per_rank = min_confidence_ * static_cast<double>(m);
    for (const double residual2 : residual2_) {
      const double rank = std::ceil(residual2 * per_rank);
      if (rank <= static_cast<double>(m)) ++ranks_[to_index(rank)];
    }
    std::size_t count = ranks_[0], best = 0;
    for (std::size_t k = 1; k <= m; ++k) {
      count += ranks_[k];
      if (count >= k) best = k;
    }
    return best;
  }

  /// The map of those that agree with a map, unless it is worse.
  Eigen::Matrix2d refitted(const Eigen::Matrix2d& map, double most_stretch) {
    const std::size_t before = agreeing(map);
    const double limit2 = kth_residual2(before);
    Fit fit;
    for (std::size_t i = 0; i < around_.size(); ++i) {
      if (residual2_[i] <= limit2) fit.add(around_.in_template[i], around_.in_image[i]);
    }
    const auto better = fit.map(most_stretch);
    return better && agreeing(*better) >= before ? *better : map;
  }

  Agreement agreement(const Eigen::Matrix2d& map) {
    measure(map);
    const std::size_t m = around_.size();
    std::vector<std::size_t> order(m);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return residual2_[a] != residual2_[b] ? residual2_[a] < residual2_[b] : a < b;
    });
    Agreement found;
    found.confidence.resize(m);
    double largest = 0.0;
    for (std::size_t k = m; k > 0; --k) {
      const double residual2 = std::max(residual2_[order[k - 1]], kLeastResidual2);
      const double confidence = static_cast<double>(k) / (static_cast<double>(m) * residual2);
      largest = std::max(largest, confidence);
      if (found.agreeing == 0 && confidence >= min_confidence_) {
        found.agreeing = k;
        found.sureness = confidence;
      }
      found.confidence[order[k - 1]] = largest;
    }
    return found;
  }

 private:
  void measure(const Eigen::Matrix2d& map) {
    for (std::size_t i = 0; i < around_.size(); ++i) {
      residual2_[i] = (map * around_.in_template[i] - around_.in_image[i]).squaredNorm();
    }
  }

  double kth_residual2(std::size_t k) {
    if (k == 0) return -1.0;
    std::vector<double> sorted = residual2_;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(k - 1),
                     sorted.end());
    return sorted[k - 1];
  }

  const Neighbourhood& around_;
  double min_confidence_;
  std::vector<std::size_t> ranks_;
  std::vector<double> residual2_;
};

/// Samples after which two agreeing matches were drawn at random, except with the probability
/// kMissed.
double draws_for(double agreeing_share) {
  const double pair = agreeing_share * agreeing_share;
  if (pair >= 1.0) return 1.0;
  return std::log(kMissed) / std::log1p(-pair);
}

}  // namespace

Agreement agreement_of(const Neighbourhood& around, const Settings& settings) {
  Judge judge(around, settings.min_confidence);
  std::optional<Eigen::Matrix2d> best;
  std::size_t most = 0;
  double needed = settings.most_draws;
  int draws = 0;
  // Pairs of the most trusted matches come first: (0,1), (0,2), (1,2), (0,3), ...
  for (std::size_t b = 1; b < around.size() && draws < needed; ++b) {
    for (std::size_t a = 0; a < b && draws < needed; ++a, ++draws) {
      Fit fit;
      fit.add(around.in_template[a], around.in_image[a]);
      fit.add(around.in_template[b], around.in_image[b]);
      const auto map = fit.map(settings.most_stretch);
      worked(static_cast<std::int64_t>(around.size()));
      if (!map) continue;
      const std::size_t agreeing = judge.agreeing(*map);
      if (best && agreeing <= most) continue;
      best = map;
      most = agreeing;
      const double share = static_cast<double>(most) / static_cast<double>(around.size());
      needed = std::min<double>(settings.most_draws, draws_for(share));
    }
  }
  if (!best) return {std::vector<double>(around.size(), 0.0)};
  return judge.agreement(judge.refitted(*best, settings.most_stretch));
}

}  // namespace weft::adalam
