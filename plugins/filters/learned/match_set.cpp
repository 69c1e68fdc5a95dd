// SPDX-License-Identifier: Apache-2.0
#include "match_set.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/nearest.hpp"

namespace weft::learned {
namespace {

using filters::Nearest;

constexpr int kNeighbours = 16, kShared = 8;
constexpr double kLeastReach2Px2 = 4.0;  // keypoints are not placed more exactly
constexpr double kAgrees2 = 0.16;        // relative error of a predicted offset, squared

Nearest nearest_to_all(const Points2& points, int count) {
  std::vector<int> all(to_index(points.rows()));
  std::iota(all.begin(), all.end(), 0);
  return filters::nearest_of(points, all, std::min(count, static_cast<int>(points.rows()) - 1));
}

/// Shares of the neighbours that are where scale and angle of the match put them.
std::vector<double> votes(const MatchSet& matches, const Nearest& near) {
  std::vector<double> share;
  for (Eigen::Index i = 0; i < matches.count(); ++i) {
    worked(20 * near.cols());
    const double size = std::exp(std::clamp(matches.log_scale[to_index(i)], -6.0, 6.0));
    const double c = size * std::cos(matches.angle_rad[to_index(i)]);
    const double s = size * std::sin(matches.angle_rad[to_index(i)]);
    double sum = 0.0;
    for (const int j : near.row(i)) {
      const Eigen::RowVector2d away = matches.template_px.row(j) - matches.template_px.row(i);
      const Eigen::RowVector2d moved = matches.image_px.row(j) - matches.image_px.row(i);
      const double du = moved.x() - (c * away.x() - s * away.y());
      const double dv = moved.y() - (s * away.x() + c * away.y());
      const double reach2 = size * size * away.squaredNorm() + kLeastReach2Px2;
      sum += std::exp(-(du * du + dv * dv) / (kAgrees2 * reach2));
    }
    share.push_back(sum / static_cast<double>(near.cols()));
  }
  return share;
}

/// Shares of the nearest neighbours in the template that are among the nearest in the image.
std::vector<double> shared_neighbours(const Nearest& in_template, const Nearest& in_image) {
  std::vector<double> share;
  for (Eigen::Index i = 0; i < in_template.rows(); ++i) {
    double count = 0.0;
    for (const int j : in_template.row(i))
      count += (in_image.row(i).array() == j).any() ? 1.0 : 0.0;
    share.push_back(count / static_cast<double>(in_template.cols()));
  }
  return share;
}

}  // namespace

Normalised normalised(const MatchSet& matches) {
  Normalised found;
  const auto n = static_cast<double>(matches.count());
  found.p = (matches.template_px.rowwise() - matches.template_px.colwise().mean()) /
            matches.half_diagonal_px;
  found.q = matches.image_px.rowwise() - matches.image_px.colwise().mean();
  found.rms_px = std::max(std::sqrt(found.q.squaredNorm() / n), 1e-6);
  found.q /= found.rms_px;
  const Eigen::Matrix2d cross = found.q.transpose() * found.p;
  found.turn_rad = std::atan2(cross(1, 0) - cross(0, 1), cross(0, 0) + cross(1, 1));
  const double c = std::cos(found.turn_rad), s = std::sin(found.turn_rad);
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  found.q = (found.q * turn).eval();
  const double mean = std::accumulate(matches.log_scale.begin(), matches.log_scale.end(), 0.0) / n;
  for (const double each : matches.log_scale) {
    found.scale.push_back(std::clamp(each - mean, -3.0, 3.0));
  }
  for (const double each : matches.angle_rad) found.angle_rad.push_back(each - found.turn_rad);
  return found;
}

Eigen::MatrixXf inputs_of(const MatchSet& matches, const Normalised& places) {
  const Eigen::Index n = matches.count();
  const bool has_scale = !matches.log_scale.empty(), has_angle = !matches.angle_rad.empty();
  const bool has_ratio = !matches.ratio.empty();
  const Nearest near = nearest_to_all(places.p, kNeighbours);
  const Eigen::Index shared_count = std::min<Eigen::Index>(kShared, near.cols());
  const std::vector<double> shared =
      shared_neighbours(near.leftCols(shared_count), nearest_to_all(places.q, kShared));
  const std::vector<double> vote =
      has_scale && has_angle ? votes(matches, near) : std::vector<double>(to_index(n), 0.0);
  Eigen::MatrixXf columns(kInputs, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = to_index(i);
    const std::array<double, kInputs> values{places.p(i, 0),
                                             places.p(i, 1),
                                             places.q(i, 0),
                                             places.q(i, 1),
                                             has_scale ? places.scale[k] : 0.0,
                                             has_angle ? std::sin(places.angle_rad[k]) : 0.0,
                                             has_angle ? std::cos(places.angle_rad[k]) : 0.0,
                                             has_ratio ? matches.ratio[k] : 0.0,
                                             has_scale ? 1.0 : 0.0,
                                             has_angle ? 1.0 : 0.0,
                                             has_ratio ? 1.0 : 0.0,
                                             std::log(static_cast<double>(n)) / 5.0 - 1.0,
                                             vote[k],
                                             shared[k],
                                             std::log(places.rms_px / 100.0)};
    for (int row = 0; row < kInputs; ++row) {
      columns(row, i) = static_cast<float>(values[to_index(row)]);
    }
  }
  return columns;
}

}  // namespace weft::learned
