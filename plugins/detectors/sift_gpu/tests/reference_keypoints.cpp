// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <weft/core/index.hpp>

#include "reference.hpp"

namespace weft::sift_gpu::reference {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Length and direction, from +x towards +y, of the gradient at a pixel that is not on the border.
struct Gradient {
  Gradient(const Plane& layer, int x, int y) {
    const double dx = layer(y, x + 1) - layer(y, x - 1), dy = layer(y + 1, x) - layer(y - 1, x);
    length = std::hypot(dx, dy);
    angle_rad = std::atan2(dy, dx);
  }
  double length, angle_rad;
};

}  // namespace

std::vector<double> orientations(const Plane& layer, double x, double y, double scale) {
  constexpr int kBins = 36;
  const double sigma = 1.5 * scale;
  const int radius = static_cast<int>(std::rint(3.0 * sigma));
  const auto centre_x = static_cast<int>(std::rint(x)), centre_y = static_cast<int>(std::rint(y));
  std::array<double, kBins> sums{}, smooth{};
  for (int v = 1; v < layer.rows() - 1; ++v) {
    for (int u = 1; u < layer.cols() - 1; ++u) {
      const int dx = u - centre_x, dy = v - centre_y;
      if (std::max(std::abs(dx), std::abs(dy)) > radius) continue;
      const Gradient gradient(layer, u, v);
      const auto bin = static_cast<int>(std::rint(gradient.angle_rad / kTurn * kBins));
      sums[to_index((bin + kBins) % kBins)] +=
          gradient.length * std::exp(-(dx * dx + dy * dy) / (2.0 * sigma * sigma));
    }
  }
  const auto around = [](const std::array<double, kBins>& bins, int i) {
    return bins[to_index((i + kBins) % kBins)];
  };
  for (int i = 0; i < kBins; ++i) {
    constexpr std::array<double, 5> kBinomial{1.0, 4.0, 6.0, 4.0, 1.0};
    for (int j = 0; j < 5; ++j) {
      smooth[to_index(i)] += kBinomial[to_index(j)] / 16.0 * around(sums, i + j - 2);
    }
  }
  const double highest = *std::max_element(smooth.begin(), smooth.end());
  std::vector<double> angles;
  for (int i = 0; i < kBins; ++i) {
    const double left = around(smooth, i - 1), here = around(smooth, i),
                 right = around(smooth, i + 1);
    if (here <= left || here <= right || here < 0.8 * highest) continue;
    const double top = i + (right - left) / (2.0 * (2.0 * here - left - right));
    angles.push_back(std::fmod(top + kBins, kBins) * kTurn / kBins);
  }
  std::sort(angles.begin(), angles.end());
  return angles;
}

std::array<double, 128> descriptor(const Plane& layer, double x, double y, double scale,
                                   double angle_rad) {
  const double cell_px = 3.0 * scale;
  const Eigen::Matrix2d cells_from_px = Eigen::Rotation2Dd(-angle_rad).toRotationMatrix() / cell_px;
  Eigen::Matrix<double, 128, 1> bins = Eigen::Matrix<double, 128, 1>::Zero();
  for (int v = 1; v < layer.rows() - 1; ++v) {
    for (int u = 1; u < layer.cols() - 1; ++u) {
      // Place and direction in the keypoint's frame, cells and eighths of a turn.
      const Eigen::Vector2d place =
          cells_from_px * Eigen::Vector2d(u - std::rint(x), v - std::rint(y));
      if (place.cwiseAbs().maxCoeff() >= 2.5) continue;
      const Gradient gradient(layer, u, v);
      const double direction = (angle_rad - gradient.angle_rad) / kTurn * 8.0;
      const double weight = gradient.length * std::exp(-place.squaredNorm() / 8.0);
      for (int bin = 0; bin < 128; ++bin) {
        const double row = bin / 32 - 1.5, column = bin / 8 % 4 - 1.5;
        bins[bin] += weight * share(place.y() - row) * share(place.x() - column) *
                     share(std::remainder(direction - bin % 8, 8.0));
      }
    }
  }
  const double largest = 0.2 * bins.norm();
  bins = bins.cwiseMin(largest);
  if (largest > 0.0) bins *= 512.0 / bins.norm();
  bins = bins.cwiseMin(255.0);
  std::array<double, 128> result{};
  std::copy(bins.begin(), bins.end(), result.begin());
  return result;
}

}  // namespace weft::sift_gpu::reference
