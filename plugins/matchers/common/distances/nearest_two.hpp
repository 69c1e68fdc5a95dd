// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "common/distances/coarse_distances.hpp"
#include "common/distances/code_row.hpp"

namespace weft::matchers {

/// The nearest train of a query and the nearest one that lies elsewhere; -1 where there is none.
struct Nearest {
  int best = -1;
  int second = -1;
  double distance = 0.0;
  double second_distance = 0.0;
};

/// Takes the nearest two from a row of codes, exactly. Bounds exclude most trains, fine distances
/// most of the rest, and distances decide. The lowest train wins a tie.
class NearestTwo {
 public:
  /// To be opened before each search.
  CodeRow row;

  /// The codes are those of the trains train_at(position). `is_near(p, q, factor)` is true if two
  /// positions are the same or their trains are close to each other. Close means within `factor`
  /// times the radius beyond which trains count as elsewhere. `hide_near(p, factor)` hides all
  /// positions for which it is true. The search gives up early on a query, which then has no best,
  /// when it is certain that distance >= ratio * second_distance. With ratio infinity it gives up
  /// on none.
  template <class TrainAt, class IsNear, class HideNear>
  Nearest find(const CoarseDistances& distances, int query, double ratio, TrainAt&& train_at,
               IsNear&& is_near, HideNear&& hide_near);

 private:
  struct Contender {
    int position, train;
    double fine_distance;
  };
  struct Found {
    int position, train;
    double distance;
  };

  /// The nearest of those that counts(position), from the position on that has the smallest code.
  template <class TrainAt, class Counts>
  Found nearest(const CoarseDistances& distances, int query, int start, TrainAt&& train_at,
                Counts&& counts);

  std::vector<Contender> contenders_;
};

template <class TrainAt, class Counts>
NearestTwo::Found NearestTwo::nearest(const CoarseDistances& distances, int query, int start,
                                      TrainAt&& train_at, Counts&& counts) {
  const double slack = distances.fine_slack(query);
  double least = distances.fine_distance(query, train_at(start));
  contenders_.assign(1, {start, train_at(start), least});
  row.for_each_up_to(distances.last_code(query, least + slack), [&](int position, int code) {
    // A train farther than `least` by twice the slack is farther than that one.
    if (position == start || distances.lower(query, code) > least + slack) return;
    if (!counts(position)) return;
    const int train = train_at(position);
    const double fine_distance = distances.fine_distance(query, train);
    if (fine_distance > least + 2.0 * slack) return;
    contenders_.push_back({position, train, fine_distance});
    least = std::min(least, fine_distance);
  });
  Found found{-1, -1, 0.0};
  for (const Contender& each : contenders_) {
    if (each.fine_distance > least + 2.0 * slack) continue;
    const double distance = distances.distance(query, each.train);
    const bool closer = found.train < 0 || distance < found.distance ||
                        (distance == found.distance && each.train < found.train);
    if (closer) found = {each.position, each.train, distance};
  }
  return found;
}

template <class TrainAt, class IsNear, class HideNear>
Nearest NearestTwo::find(const CoarseDistances& distances, int query, double ratio,
                         TrainAt&& train_at, IsNear&& is_near, HideNear&& hide_near) {
  /// The position with the smallest code of those not near `place`, -1 if there is none.
  const auto smallest_elsewhere = [&](int place, double factor) {
    constexpr int kMostOneByOne = 4;
    row.hide(place);
    for (int hidden = 0;; ++hidden) {
      const int minimum = row.minimum();
      if (minimum == kBeyond) return -1;
      const int position = row.first_with(minimum);
      if (!is_near(place, position, factor)) return position;
      if (hidden < kMostOneByOne) {
        row.hide(position);
      } else {
        hide_near(place, factor);
      }
    }
  };

  const int minimum = row.minimum();
  if (minimum == kBeyond) return {};
  const int start = row.first_with(minimum);
  if (ratio < std::numeric_limits<double>::infinity()) {
    // Trains beyond twice the radius of the coarse best are elsewhere for any best within the
    // radius. If the best itself is elsewhere, so is the coarse best.
    const int beyond = smallest_elsewhere(start, 2.0);
    const bool hopeless = beyond >= 0 && distances.lower(query, minimum) >=
                                             ratio * distances.upper(query, row.code_at(beyond));
    if (hopeless) return {};
    row.show_all();
  }
  const Found best = nearest(distances, query, start, train_at, [](int) { return true; });
  const int other = smallest_elsewhere(best.position, 1.0);
  if (other < 0) return {best.train, -1, best.distance, 0.0};
  if (best.distance >= ratio * distances.upper(query, row.code_at(other))) return {};
  const Found second = nearest(distances, query, other, train_at, [&](int position) {
    return !is_near(best.position, position, 1.0);
  });
  return {best.train, second.train, best.distance, second.distance};
}

}  // namespace weft::matchers
