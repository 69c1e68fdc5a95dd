// SPDX-License-Identifier: Apache-2.0
#include "patches.hpp"

#include <algorithm>
#include <weft/core/statistics.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

/// The result of `summary` for the values of its patch, for each place.
template <class Summary>
Eigen::VectorXd of_patches(const std::vector<int>& patches, const Eigen::VectorXd& values,
                           Summary&& summary) {
  std::vector<std::vector<double>> own;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    own.resize(std::max(own.size(), to_index(patches[p]) + 1));
    own[to_index(patches[p])].push_back(values(static_cast<Eigen::Index>(p)));
  }
  std::vector<double> summaries;
  summaries.reserve(own.size());
  for (std::vector<double>& of_one : own) summaries.push_back(summary(of_one));
  Eigen::VectorXd result(values.size());
  for (std::size_t p = 0; p < patches.size(); ++p) {
    result(static_cast<Eigen::Index>(p)) = summaries[to_index(patches[p])];
  }
  return result;
}

}  // namespace

GridNeighbours::GridNeighbours(const std::vector<WarpPlace>& places) : places_(places) {
  for (const WarpPlace& place : places) {
    columns_ = std::max(columns_, place.i + 1);
    rows_ = std::max(rows_, place.j + 1);
  }
  at_.assign(to_index(columns_) * to_index(rows_), kNoVertex);
  for (std::size_t p = 0; p < places.size(); ++p) at_[cell(places[p].i, places[p].j)] = p;
}

std::vector<int> patches_of(const std::vector<WarpPlace>& places) {
  const GridNeighbours neighbours(places);
  std::vector<int> patches(places.size(), -1);
  std::vector<std::size_t> open;
  int count = 0;
  for (std::size_t first = 0; first < places.size(); ++first) {
    if (patches[first] >= 0) continue;
    patches[first] = count;
    open.assign(1, first);
    while (!open.empty()) {
      worked();
      const std::size_t place = open.back();
      open.pop_back();
      neighbours.each(place, [&](std::size_t next) {
        if (patches[next] >= 0) return;
        patches[next] = count;
        open.push_back(next);
      });
    }
    ++count;
  }
  return patches;
}

Eigen::VectorXd medians_of_patches(const std::vector<int>& patches, const Eigen::VectorXd& values) {
  return of_patches(patches, values, [](std::vector<double>& own) { return median_in_place(own); });
}

Eigen::VectorXd means_of_patches(const std::vector<int>& patches, const Eigen::VectorXd& values) {
  return of_patches(patches, values, [](std::vector<double>& own) { return mean(own); });
}

}  // namespace weft::solvers
