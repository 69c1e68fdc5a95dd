// SPDX-License-Identifier: Apache-2.0
#include "signs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/patches.hpp"

namespace weft::bartoli_conformal {
namespace {

/// A step from a place with a sign to one without: |g . h|, then the lowest places, so that the
/// order does not depend on the queue.
struct Step {
  double product = 0.0;
  std::size_t to = 0, from = 0;

  bool operator<(const Step& other) const {
    return std::tie(product, other.to, other.from) < std::tie(other.product, to, from);
  }
};

class Spreading {
 public:
  Spreading(const solvers::GridNeighbours& neighbours, const Points2View& gradients)
      : neighbours_(neighbours), gradients_(gradients), signs_(to_index(gradients.rows()), 0.0) {}

  bool has_sign(std::size_t place) const { return signs_[place] != 0.0; }
  const std::vector<double>& signs() const { return signs_; }

  void from(std::size_t first) {
    give(first, 1.0);
    while (!open_.empty()) {
      worked(4);
      const Step step = open_.top();
      open_.pop();
      if (has_sign(step.to)) continue;
      give(step.to, product(step.from, step.to) < 0.0 ? -signs_[step.from] : signs_[step.from]);
    }
  }

 private:
  double product(std::size_t a, std::size_t b) const {
    return gradients_.row(static_cast<Eigen::Index>(a))
        .dot(gradients_.row(static_cast<Eigen::Index>(b)));
  }

  void give(std::size_t place, double sign) {
    signs_[place] = sign;
    neighbours_.each(place, [&](std::size_t next) {
      if (!has_sign(next)) open_.push({std::abs(product(place, next)), next, place});
    });
  }

  const solvers::GridNeighbours& neighbours_;
  const Points2View& gradients_;
  std::vector<double> signs_;
  std::priority_queue<Step> open_;
};

}  // namespace

std::vector<double> continuous_signs(const std::vector<solvers::WarpPlace>& places,
                                     const Points2View& gradients) {
  const solvers::GridNeighbours neighbours(places);
  Spreading spreading(neighbours, gradients);
  std::vector<Eigen::Index> longest_first(places.size());
  std::iota(longest_first.begin(), longest_first.end(), Eigen::Index{0});
  std::stable_sort(longest_first.begin(), longest_first.end(), [&](Eigen::Index a, Eigen::Index b) {
    return gradients.row(a).squaredNorm() > gradients.row(b).squaredNorm();
  });
  for (const Eigen::Index place : longest_first) {
    if (!spreading.has_sign(to_index(place))) spreading.from(to_index(place));
  }
  return spreading.signs();
}

}  // namespace weft::bartoli_conformal
