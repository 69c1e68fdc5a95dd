// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>

#include "reference.hpp"

/// The search for nearest descriptors by its definition, in doubles, and descriptors to try it on.
namespace weft::sift_gpu::reference {

/// Descriptors, one a row.
using Rows = Plane;

/// Whole numbers 0, 1 ... `levels` - 1, each drawn uniformly. With two levels most distances are
/// tied.
inline Rows whole_numbers(int count, int length, std::uint32_t levels, Rng& rng) {
  return Rows::NullaryExpr(count, length, [&] { return static_cast<double>(rng.below(levels)); });
}

/// sqrt(d / |d|_1) for each row d, which is not negative; a row of zeros stays one.
inline Rows rooted(const Rows& rows) {
  Rows roots = rows;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double sum = rows.row(i).sum();
    if (sum > 0.0) roots.row(i) = (rows.row(i) / sum).cwiseSqrt();
  }
  return roots;
}

/// |a - b|^2 for each query a, one a row, and each train b. Exact for small whole numbers.
inline Plane squared_distances(const Rows& queries, const Rows& trains) {
  return Plane::NullaryExpr(queries.rows(), trains.rows(), [&](auto i, auto j) {
    return (queries.row(i) - trains.row(j)).squaredNorm();
  });
}

/// The index of the smallest of the values that count, the lowest of equal ones; -1 if none does.
template <class Counts>
int smallest(const Eigen::VectorXd& values, Counts&& counts) {
  int best = -1;
  for (int i = 0; i < values.size(); ++i) {
    if (counts(i) && (best < 0 || values[i] < values[best])) best = i;
  }
  return best;
}

inline int smallest(const Eigen::VectorXd& values) {
  return smallest(values, [](int) { return true; });
}

/// The second is the nearest train farther than `elsewhere_px` from the best; any other for 0.
struct Nearest {
  int best, second;
};

/// From the squared distances of a query; `places` [trains,2] px.
inline Nearest nearest(const Eigen::VectorXd& squares, const std::vector<float>& places,
                       double elsewhere_px) {
  const int best = smallest(squares);
  const auto place = [&](int i) {
    const auto at = to_index(2 * i);
    return Eigen::Vector2d(places[at], places[at + 1]);
  };
  return {best, smallest(squares, [&](int i) {
            return i != best &&
                   (elsewhere_px <= 0.0 || (place(i) - place(best)).norm() > elsewhere_px);
          })};
}

}  // namespace weft::sift_gpu::reference
