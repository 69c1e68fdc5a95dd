// SPDX-License-Identifier: Apache-2.0
#include "steps.hpp"

#include <algorithm>
#include <cmath>
#include <weft/core/index.hpp>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::myneighbor {
namespace {

constexpr double kEqualPercent = 1e-9;
constexpr double kMadFactor = 2.5;
constexpr double kLeastMadPx = 0.01;  // perfect data: the rule would drop one match in five

constexpr Eigen::Index kMostInPairs = 4096;  // above, points are heaped up in a grid
constexpr Eigen::Index kHeapsAlong = 64;

/// Points, or the means of the points in the cells of a grid, which then count as often.
struct Heaps {
  Eigen::ArrayXd x, y;
  Eigen::ArrayXd count;  ///< empty: each once
};

/// Replaces each point by the mean of those in its cell. A distance to it is right to first order,
/// so that the mean over all pairs is off by about 1e-4 of itself.
Heaps heaps_of(const Points2View& points) {
  const Eigen::RowVector2d low = points.colwise().minCoeff();
  const double side =
      (points.colwise().maxCoeff() - low).maxCoeff() / static_cast<double>(kHeapsAlong);
  Eigen::ArrayXd x = Eigen::ArrayXd::Zero(kHeapsAlong * kHeapsAlong), y = x, count = x;
  const auto along = [&](double offset) {
    const auto cell = static_cast<Eigen::Index>(side > 0.0 ? offset / side : 0.0);
    return std::min(cell, kHeapsAlong - 1);
  };
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    worked_in_loop(i);
    const Eigen::Index cell =
        along(points(i, 1) - low.y()) * kHeapsAlong + along(points(i, 0) - low.x());
    x[cell] += points(i, 0);
    y[cell] += points(i, 1);
    count[cell] += 1.0;
  }
  std::vector<Eigen::Index> filled;
  for (Eigen::Index cell = 0; cell < count.size(); ++cell) {
    if (count[cell] > 0.0) filled.push_back(cell);
  }
  return {x(filled) / count(filled), y(filled) / count(filled), count(filled)};
}

double sum_over_pairs(const Heaps& heaps) {
  const Eigen::Index n = heaps.x.size();
  double sum = 0.0;
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    const Eigen::Index rest = n - 1 - i;
    worked(rest / 4);
    const auto lengths =
        ((heaps.x.tail(rest) - heaps.x[i]).square() + (heaps.y.tail(rest) - heaps.y[i]).square())
            .sqrt();
    sum += heaps.count.size() == 0 ? lengths.sum()
                                   : heaps.count[i] * (heaps.count.tail(rest) * lengths).sum();
  }
  return sum;
}

void select_up_to(const std::vector<double>& factors, double limit, Selection& selection) {
  selection.count = 0;
  for (std::size_t i = 0; i < factors.size(); ++i) {
    selection.selected[i] = factors[i] <= limit ? 1 : 0;
    selection.count += selection.selected[i];
  }
}

}  // namespace

void select_small(const std::vector<double>& factors, double scale, std::int64_t least,
                  Selection& selection) {
  selection.selected.assign(factors.size(), 0);
  selection.count = 0;
  selection.fallback = false;
  if (factors.empty()) return;
  selection.mean_percent = mean(factors);
  selection.threshold_percent = scale * selection.mean_percent;
  const auto [smallest, largest] = std::minmax_element(factors.begin(), factors.end());
  if (*largest - *smallest < kEqualPercent) return select_up_to(factors, *largest, selection);
  for (std::size_t i = 0; i < factors.size(); ++i) {
    selection.selected[i] = factors[i] < selection.threshold_percent ? 1 : 0;
    selection.count += selection.selected[i];
  }
  if (selection.count >= least) return;
  selection.fallback = true;
  std::vector<double> sorted = factors;
  const double wanted = std::ceil(std::max(8.0, 0.2 * static_cast<double>(factors.size())));
  const auto last = std::min(to_index(wanted), sorted.size()) - 1;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(last),
                   sorted.end());
  select_up_to(factors, sorted[last], selection);
}

void trim_by_distance(const std::vector<double>& distance_px,
                      const std::vector<std::uint8_t>& selected, Trim& trim) {
  std::vector<double> distances;
  distances.reserve(distance_px.size());
  for (std::size_t i = 0; i < distance_px.size(); ++i) {
    if (selected[i] != 0) distances.push_back(distance_px[i]);
  }
  trim.median_px = median_in_place(distances);
  for (double& distance : distances) distance = std::abs(distance - trim.median_px);
  trim.mad_px = std::max(kSigmaPerMad * median_in_place(distances), kLeastMadPx);
  trim.kept.assign(selected.size(), 0);
  trim.count = 0;
  for (std::size_t i = 0; i < selected.size(); ++i) {
    const double deviation = std::abs(distance_px[i] - trim.median_px);
    trim.kept[i] = selected[i] != 0 && deviation < kMadFactor * trim.mad_px ? 1 : 0;
    trim.count += trim.kept[i];
  }
}

double mean_pair_distance(const Points2View& points) {
  const Eigen::Index n = points.rows();
  if (n < 2) return 0.0;
  if (n <= kMostInPairs) {
    const Heaps single{points.col(0), points.col(1), Eigen::ArrayXd()};
    return sum_over_pairs(single) / (0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
  }
  const Heaps heaps = heaps_of(points);
  return sum_over_pairs(heaps) / (0.5 * static_cast<double>(n) * static_cast<double>(n - 1));
}

double folded_share(const Points2View& vertices, const FacesView& faces) {
  Eigen::Index positive = 0, negative = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    worked_in_loop(f);
    const Eigen::RowVector2d a = vertices.row(faces(f, 1)) - vertices.row(faces(f, 0));
    const Eigen::RowVector2d b = vertices.row(faces(f, 2)) - vertices.row(faces(f, 0));
    const double area = a.x() * b.y() - a.y() * b.x();
    positive += area > 0.0 ? 1 : 0;
    negative += area < 0.0 ? 1 : 0;
  }
  if (positive + negative == 0) return 0.0;
  return static_cast<double>(std::min(positive, negative)) /
         static_cast<double>(positive + negative);
}

}  // namespace weft::myneighbor
