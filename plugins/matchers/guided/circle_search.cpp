// SPDX-License-Identifier: Apache-2.0
#include "circle_search.hpp"

#include <algorithm>
#include <limits>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/workers/sharing.hpp"

namespace weft::guided {

using matchers::CoarseDistances;
using matchers::kBeyond;
using matchers::kCodeBlock;
using matchers::Nearest;

void CircleSearch::lay_out(const std::vector<Eigen::Vector2d>& in_image, double radius_px) {
  placed_.clear();
  for (int i = 0; i < static_cast<int>(in_image.size()); ++i) {
    if (in_image[to_index(i)].allFinite()) placed_.push_back(i);
  }
  grid_.load(static_cast<int>(placed_.size()), radius_px,
             [&](int i) { return in_image[to_index(placed_[to_index(i)])]; });
}

/// Calls visit(bench, query) for each query, on several threads. When the caller's thread is
/// cancelled, the others end after their current queries.
template <class Visit>
void CircleSearch::for_each_query(const Options& options, Visit&& visit) {
  constexpr int kAtOnce = 32;
  const Shares shares{static_cast<int>(nearest_.size()), kAtOnce, options.threads};
  if (benches_.size() < to_index(shares.workers())) benches_.resize(to_index(shares.workers()));
  share_out(workers_, shares, [&](int worker, int begin, int end) {
    for (int query = begin; query < end; ++query) visit(benches_[to_index(worker)], query);
    return true;
  });
}

Nearest CircleSearch::search(const CoarseDistances& distances, int query,
                             const Eigen::Vector2d& place, const SidePlaces& trains,
                             const Options& options, Bench& bench) const {
  auto& in_reach = bench.in_reach;
  auto& codes = bench.codes;
  auto& two = bench.two;
  in_reach.clear();
  if (place.allFinite()) grid_.find_within(place, options.radius_px, in_reach);
  for (int& train : in_reach) train = placed_[to_index(train)];
  if (in_reach.empty()) return {};
  worked(static_cast<std::int64_t>(in_reach.size()));
  const int length = (static_cast<int>(in_reach.size()) + kCodeBlock - 1) / kCodeBlock * kCodeBlock;
  codes.assign(to_index(length), kBeyond);
  distances.fill_some(query, in_reach, codes.data());
  two.row.open(codes.data(), length);
  const auto train_at = [&](int position) { return in_reach[to_index(position)]; };
  const auto home_of = [&](int position) -> const Eigen::Vector2d& {
    return trains.at_home[to_index(train_at(position))];
  };
  const auto is_near = [&](int a, int b, double factor) {
    const double radius_px = factor * options.elsewhere_px;
    return a == b || (options.elsewhere_px > 0.0 &&
                      (home_of(a) - home_of(b)).squaredNorm() <= radius_px * radius_px);
  };
  const auto hide_near = [&](int position, double factor) {
    for (int other = 0; other < static_cast<int>(in_reach.size()); ++other) {
      if (is_near(position, other, factor)) two.row.hide(other);
    }
  };
  return two.find(distances, query, options.ratio, train_at, is_near, hide_near);
}

/// Lets trains from all over compete for the second place.
void CircleSearch::add_rivals(const CoarseDistances& distances, int query, const SidePlaces& trains,
                              const Options& options, Bench& bench, Nearest& found) const {
  const bool are_enough = static_cast<int>(bench.in_reach.size()) >= options.least_rivals;
  if (found.best < 0 || are_enough) return;
  const Eigen::Vector2d& home = trains.at_home[to_index(found.best)];
  bench.rival_codes.resize(rivals_.size());
  distances.fill_some(query, rivals_, bench.rival_codes.data());
  for (std::size_t i = 0; i < rivals_.size(); ++i) {
    const int rival = rivals_[i];
    const bool is_elsewhere =
        rival != found.best &&
        (options.elsewhere_px == 0.0 ||
         (trains.at_home[to_index(rival)] - home).norm() > options.elsewhere_px);
    if (!is_elsewhere) continue;
    const bool may_be_second =
        found.second < 0 || distances.lower(query, bench.rival_codes[i]) < found.second_distance;
    if (!may_be_second) continue;
    const double distance = distances.distance(query, rival);
    if (found.second >= 0 && !(distance < found.second_distance)) continue;
    found.second = rival;
    found.second_distance = distance;
  }
}

/// Checks for each best its nearest query in the circle around it.
void CircleSearch::keep_mutual(CoarseDistances& distances, const SidePlaces& queries,
                               const SidePlaces& trains, const Options& options) {
  lay_out(queries.in_image, options.radius_px);
  distances.swap_sides();
  Options any = options;
  any.ratio = std::numeric_limits<double>::infinity();
  any.elsewhere_px = 0.0;
  for_each_query(options, [&](Bench& bench, int query) {
    Nearest& found = nearest_[to_index(query)];
    if (found.second < 0) return;
    const Nearest back =
        search(distances, found.best, trains.in_image[to_index(found.best)], queries, any, bench);
    if (back.best != query) found = {};
  });
  distances.swap_sides();
}

const std::vector<Nearest>& CircleSearch::run(CoarseDistances& distances, const SidePlaces& queries,
                                              const SidePlaces& trains, const Options& options) {
  nearest_.assign(to_index(distances.queries()), {});
  rivals_.clear();
  if (options.least_rivals > 0) {
    const int step = std::max(1, distances.trains() / options.least_rivals);
    for (int train = step / 2; train < distances.trains(); train += step) rivals_.push_back(train);
  }
  lay_out(trains.in_image, options.radius_px);
  for_each_query(options, [&](Bench& bench, int query) {
    Nearest& found = nearest_[to_index(query)];
    found = search(distances, query, queries.in_image[to_index(query)], trains, options, bench);
    add_rivals(distances, query, trains, options, bench, found);
  });
  if (options.mutual) keep_mutual(distances, queries, trains, options);
  return nearest_;
}

}  // namespace weft::guided
