// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "common/cameras/camera_file.hpp"

namespace weft::cameras {
namespace {

constexpr int kProbes = 16;

/// Where the lens puts a point of the ideal image.
Eigen::Vector2d distorted(const CameraFile& file, const Eigen::Vector2d& p) {
  const std::vector<double>& k = file.coefficients;
  const double r2 = p.squaredNorm(), r = std::sqrt(r2);
  if (file.model == Distortion::fisheye) {
    const double theta = std::atan(r), t2 = theta * theta;
    const double scale = 1.0 + t2 * (k[0] + t2 * (k[1] + t2 * (k[2] + t2 * k[3])));
    return r > 0.0 ? Eigen::Vector2d(theta * scale / r * p) : p;
  }
  const double over = 1.0 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double under = k.size() == 8 ? 1.0 + r2 * (k[5] + r2 * (k[6] + r2 * k[7])) : 1.0;
  const double both = 2.0 * p.x() * p.y();
  return over / under * p + Eigen::Vector2d(k[2] * both + k[3] * (r2 + 2.0 * p.x() * p.x()),
                                            k[3] * both + k[2] * (r2 + 2.0 * p.y() * p.y()));
}

}  // namespace

Eigen::Vector2d seen_px(const CameraFile& file, const Eigen::Vector2d& ideal_px) {
  if (file.model == Distortion::none) return ideal_px;
  const Camera& c = file.camera;
  const Eigen::Vector2d seen =
      distorted(file, {(ideal_px.x() - c.cx) / c.fx, (ideal_px.y() - c.cy) / c.fy});
  return {c.fx * seen.x() + c.cx, c.fy * seen.y() + c.cy};
}

double shown_share(const CameraFile& file) {
  if (file.coefficients.empty()) return 1.0;
  const Camera& camera = file.camera;
  int shown = 0;
  for (int i = 0; i < kProbes * kProbes; ++i) {
    const int column = i % kProbes, row = i / kProbes;
    const double x_px = (column + 0.5) / kProbes * static_cast<double>(camera.width_px) - 0.5;
    const double y_px = (row + 0.5) / kProbes * static_cast<double>(camera.height_px) - 0.5;
    const Eigen::Vector2d seen = seen_px(file, {x_px, y_px});
    shown += camera.shows(seen.x(), seen.y());
  }
  return static_cast<double>(shown) / (kProbes * kProbes);
}

}  // namespace weft::cameras
