// SPDX-License-Identifier: Apache-2.0
#include "nearest_search.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <span>
#include <weft/core/index.hpp>

#include "common/workers/sharing.hpp"

namespace weft::descriptor {

using matchers::CoarseDistances;
using matchers::kBlockQueries;

/// Calls visit(bench, query), whose row is open, for each query, on several threads.
bool NearestSearch::for_each_row(CoarseDistances& distances, const std::vector<int>& queries,
                                 int threads, const std::function<bool()>& cancelled,
                                 const Visit& visit) {
  distances.pack_trains();
  const int length = distances.row_length();
  const Shares shares{static_cast<int>(queries.size()), kBlockQueries, threads};
  if (benches_.size() < to_index(shares.workers())) benches_.resize(to_index(shares.workers()));
  if (cancelled()) return false;  // the caller's thread may get no block
  return share_out(workers_, shares, [&](int worker, int begin, int end) {
    if (worker == 0 && cancelled()) return false;
    Bench& bench = benches_[to_index(worker)];
    bench.codes.resize(to_index(kBlockQueries) * to_index(length));
    const std::span<const int> some(queries.data() + begin, to_index(end - begin));
    distances.fill(some, bench.scratch, bench.codes.data());
    for (std::size_t i = 0; i < some.size(); ++i) {
      bench.two.row.open(bench.codes.data() + i * to_index(length), length);
      visit(bench, some[i]);
    }
    return true;
  });
}

/// Checks for each train that is a best its nearest query.
bool NearestSearch::keep_mutual(CoarseDistances& distances, int threads,
                                const std::function<bool()>& cancelled) {
  best_query_.assign(to_index(distances.trains()), -1);
  std::vector<int> bests;
  for (const Nearest& found : nearest_) {
    if (found.second < 0 || best_query_[to_index(found.best)] == -2) continue;
    best_query_[to_index(found.best)] = -2;
    bests.push_back(found.best);
  }
  distances.swap_sides();
  const auto find = [&](Bench& bench, int train) {
    const Nearest found = bench.two.find(
        distances, train, std::numeric_limits<double>::infinity(), std::identity(),
        [](int a, int b, double) { return a == b; }, [](int, double) {});
    best_query_[to_index(train)] = found.best;
  };
  const bool done = for_each_row(distances, bests, threads, cancelled, find);
  distances.swap_sides();
  for (int query = 0; query < distances.queries(); ++query) {
    Nearest& found = nearest_[to_index(query)];
    if (found.second >= 0 && best_query_[to_index(found.best)] != query) found = {};
  }
  return done;
}

bool NearestSearch::run(CoarseDistances& distances, const Array<double>& places,
                        const Options& options, const std::function<bool()>& cancelled) {
  const auto place = [&](int i) { return Eigen::Vector2d(places(i, 0), places(i, 1)); };
  const bool elsewhere = options.elsewhere_px > 0.0;
  if (elsewhere) places_.load(distances.trains(), 2.0 * options.elsewhere_px, place);
  nearest_.assign(to_index(distances.queries()), {});
  queries_.resize(to_index(distances.queries()));
  std::iota(queries_.begin(), queries_.end(), 0);
  const auto find = [&](Bench& bench, int query) {
    const auto is_near = [&](int a, int b, double factor) {
      const double radius_px = factor * options.elsewhere_px;
      return a == b || (elsewhere && (place(a) - place(b)).squaredNorm() <= radius_px * radius_px);
    };
    const auto hide_near = [&](int position, double factor) {
      places_.for_each_within(place(position), factor * options.elsewhere_px,
                              [&](int near) { bench.two.row.hide(near); });
    };
    nearest_[to_index(query)] =
        bench.two.find(distances, query, options.ratio, std::identity(), is_near, hide_near);
  };
  if (!for_each_row(distances, queries_, options.threads, cancelled, find)) return false;
  return !options.mutual || keep_mutual(distances, options.threads, cancelled);
}

}  // namespace weft::descriptor
