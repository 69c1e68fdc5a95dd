// SPDX-License-Identifier: Apache-2.0
#include "motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>

namespace weft::track {
namespace {

constexpr std::size_t kFewest = 6;
constexpr int kRounds = 5;

Eigen::Vector2d median_of(const std::vector<Moved>& points, std::vector<double>& values) {
  Eigen::Vector2d middle;
  values.resize(points.size());
  for (int axis = 0; axis < 2; ++axis) {
    for (std::size_t i = 0; i < points.size(); ++i) values[i] = points[i].by_px[axis];
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), half, values.end());
    middle[axis] = *half;
  }
  return middle;
}

}  // namespace

Motion Motion::fit(const std::vector<Moved>& points, double scale_px,
                   std::vector<double>& scratch) {
  if (points.empty()) return {};
  Motion motion(median_of(points, scratch));
  for (const Moved& point : points) motion.centre_px_ += point.place_px;
  motion.centre_px_ /= static_cast<double>(points.size());
  if (points.size() < kFewest) return motion;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    for (const Moved& point : points) {
      const Eigen::Vector2d offset = (point.place_px - motion.centre_px_) / kUnit_px;
      const Eigen::Vector3d row(1.0, offset.x(), offset.y());
      const double off = (point.by_px - motion.at(point.place_px)).squaredNorm();
      const double weight = 1.0 / (1.0 + off / (scale_px * scale_px));
      normal += weight * row * row.transpose();
      right += weight * row * point.by_px.transpose();
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(normal);
    const Eigen::Vector3d pivots = solver.vectorD();
    if (!(pivots.minCoeff() > 1e-6 * pivots.maxCoeff())) return Motion(median_of(points, scratch));
    motion.by_ = solver.solve(right).transpose();
  }
  return motion;
}

}  // namespace weft::track
