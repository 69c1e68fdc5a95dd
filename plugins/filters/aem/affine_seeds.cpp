// SPDX-License-Identifier: Apache-2.0
#include "affine_seeds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::aem {
namespace {

constexpr std::size_t kSeeds = 3;
constexpr int kScored = 1024;               // matches on which maps are compared
constexpr Eigen::Index kFirstScored = 256;  // those that are looked at first
constexpr double kHopeless = 0.7;     // share of a seed's score, below which the others are skipped
constexpr double kThreshold = 0.08;   // share of the template's diagonal in the image
constexpr double kWiderForOne = 1.5;  // a similarity through one match is less exact
constexpr double kThinTriple = 0.02;  // share of the template's area
constexpr double kSmallest = 0.05;    // share of the largest stretch
constexpr double kLargestAspect = 4.0;
constexpr int kFewestDraws = 200;
constexpr double kMissed = 0.01;  // probability to miss the best map

class SeedSearch {
 public:
  SeedSearch(const Matches& matches, const std::vector<Eigen::Index>& rows, Rng& rng)
      : matches_(matches),
        rows_(rows),
        rng_(rng),
        largest_stretch_(2.0 * std::sqrt(matches.image_area_px2 / matches.area_px2())) {
    const int n = static_cast<int>(rows.size());
    for (const int k : rng.sample(n, std::min(n, kScored))) {
      scored_.push_back(rows[to_index(k)]);
    }
    for (Eigen::ArrayXf* axis : {&px_, &py_, &qx_, &qy_}) {
      axis->resize(static_cast<Eigen::Index>(scored_.size()));
    }
    for (Eigen::Index k = 0; k < px_.size(); ++k) {
      const Eigen::Index i = scored_[to_index(k)];
      px_[k] = static_cast<float>(matches.template_px(i, 0));
      py_[k] = static_cast<float>(matches.template_px(i, 1));
      qx_[k] = static_cast<float>(matches.image_px(i, 0));
      qy_[k] = static_cast<float>(matches.image_px(i, 1));
    }
  }

  Seeds run(int most_draws) {
    const int most_similarities = matches_.oriented() ? static_cast<int>(scored_.size()) : 0;
    for (int k = 0; k < std::min(most_similarities, wanted_draws(1)); ++k) {
      consider(similarity(scored_[to_index(k)]), kWiderForOne);
    }
    Seeds seeds;
    while (seeds.draws < std::min(most_draws, wanted_draws(3))) {
      ++seeds.draws;
      const Eigen::Index i = draw(), j = draw(), k = draw();
      consider(triple(i, j, k), 1.0);
    }
    seeds.best = std::move(best_);
    return seeds;
  }

 private:
  /// Uniform but for a bias of n / 2^32.
  Eigen::Index draw() { return rows_[to_index((rows_.size() * rng_.next_u32()) >> 32U)]; }

  std::optional<Affine> triple(Eigen::Index i, Eigen::Index j, Eigen::Index k) const {
    Eigen::Matrix2d from, to;
    from << (matches_.template_px.row(j) - matches_.template_px.row(i)).transpose(),
        (matches_.template_px.row(k) - matches_.template_px.row(i)).transpose();
    const double area_px2 = from.determinant();
    if (!(std::abs(area_px2) >= kThinTriple * matches_.area_px2())) return {};
    to << (matches_.image_px.row(j) - matches_.image_px.row(i)).transpose(),
        (matches_.image_px.row(k) - matches_.image_px.row(i)).transpose();
    const double area_ratio = to.determinant() / area_px2;
    if (!(area_ratio > 0.0)) return {};
    Affine map;
    map.slope = to * from.inverse();
    map.offset_px =
        matches_.image_px.row(i).transpose() - map.slope * matches_.template_px.row(i).transpose();
    return map;
  }

  std::optional<Affine> similarity(Eigen::Index i) const {
    const double scale = std::exp(matches_.log_scale[i]), turn = matches_.turn_rad[i];
    Affine map;
    map.slope << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
    map.slope *= scale;
    map.offset_px =
        matches_.image_px.row(i).transpose() - map.slope * matches_.template_px.row(i).transpose();
    return map;
  }

  /// True if a surface may look like this: not too large, too small or too oblique.
  bool plausible(const Affine& map) const {
    const double area_ratio = map.slope.determinant(), square = map.slope.squaredNorm();
    const double root = std::sqrt(std::max(0.0, square * square - 4.0 * area_ratio * area_ratio));
    const double larger = std::sqrt(0.5 * (square + root));
    const double smaller = area_ratio / larger;
    return larger <= largest_stretch_ && smaller >= kSmallest * largest_stretch_ &&
           larger <= kLargestAspect * smaller;
  }

  void consider(const std::optional<Affine>& map, double widen) {
    if (!map || !plausible(*map)) return;
    worked(kScored);
    Seed seed{*map, widen * kThreshold * map->scale() * matches_.diagonal_px(), 0.0, 0.0};
    const double area_px2 = std::numbers::pi * seed.threshold_px * seed.threshold_px;
    const double rare = std::log(std::max(1.5, matches_.image_area_px2 / area_px2));
    const Eigen::Index n = px_.size(), first = std::min(n, kFirstScored);
    double fits = sum_of_fits(seed, 0, first);
    const double part = static_cast<double>(first) / static_cast<double>(n);
    if (best_.size() == kSeeds && rare * fits < kHopeless * part * best_.back().score) return;
    fits += sum_of_fits(seed, first, n - first);
    seed.share = fits / static_cast<double>(n);
    seed.score = rare * fits;
    keep(seed);
  }

  /// sum max(0, 1 - r^2 / threshold^2) over some of the scored matches.
  double sum_of_fits(const Seed& seed, Eigen::Index first, Eigen::Index count) const {
    const Eigen::Matrix2f a = seed.map.slope.cast<float>();
    const Eigen::Vector2f t = seed.map.offset_px.cast<float>();
    const auto weight = static_cast<float>(1.0 / (seed.threshold_px * seed.threshold_px));
    const auto px = px_.segment(first, count), py = py_.segment(first, count);
    const auto qx = qx_.segment(first, count), qy = qy_.segment(first, count);
    return static_cast<double>(
        (1.0F - weight * ((a(0, 0) * px + a(0, 1) * py + t.x() - qx).square() +
                          (a(1, 0) * px + a(1, 1) * py + t.y() - qy).square()))
            .max(0.0F)
            .sum());
  }

  /// Inserts a seed into the list of the best, which contains no two similar ones.
  void keep(const Seed& seed) {
    if (best_.size() == kSeeds && seed.score <= best_.back().score) return;
    for (auto other = best_.begin(); other != best_.end(); ++other) {
      if (!alike(*other, seed)) continue;
      if (other->score >= seed.score) return;
      other = best_.erase(other) - 1;
    }
    const auto place = std::find_if(best_.begin(), best_.end(),
                                    [&](const Seed& other) { return other.score < seed.score; });
    best_.insert(place, seed);
    if (best_.size() > kSeeds) best_.pop_back();
  }

  bool alike(const Seed& a, const Seed& b) const {
    const TextureBox& box = matches_.box;
    double gap_px = 0.0;
    for (const Eigen::Vector2d& corner :
         {Eigen::Vector2d(box.u0, box.v0), Eigen::Vector2d(box.u1, box.v0),
          Eigen::Vector2d(0.5 * (box.u0 + box.u1), box.v1)}) {
      gap_px += (a.map(corner) - b.map(corner)).norm() / 3.0;
    }
    return gap_px <= std::max(a.threshold_px, b.threshold_px);
  }

  /// Number of samples, with `matches` matches each, after which a better map is unlikely.
  int wanted_draws(int matches) const {
    const double share = std::clamp(best_.empty() ? 0.0 : best_.front().share, 0.05, 0.95);
    const double wanted = 3.0 * std::log(kMissed) / std::log1p(-0.5 * std::pow(share, matches));
    return std::max(kFewestDraws, static_cast<int>(std::ceil(wanted)));
  }

  const Matches& matches_;
  const std::vector<Eigen::Index>& rows_;
  Rng& rng_;
  double largest_stretch_;
  std::vector<Eigen::Index> scored_;
  Eigen::ArrayXf px_, py_, qx_, qy_;
  std::vector<Seed> best_;
};

}  // namespace

Seeds draw_seeds(const Matches& matches, const std::vector<Eigen::Index>& rows, int most_draws,
                 Rng& rng) {
  return SeedSearch(matches, rows, rng).run(most_draws);
}

}  // namespace weft::aem
