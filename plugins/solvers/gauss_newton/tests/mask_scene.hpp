// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/image.hpp>
#include <weft/generators/developable.hpp>

#include "scene.hpp"

namespace weft::gauss_newton {

/// The mask of the points that `is_inside`: the foreground is the share of 4 x 4 samples.
inline ObjectMask mask_where(const Camera& camera,
                             const std::function<bool(double, double)>& is_inside) {
  ObjectMask mask;
  mask.foreground = Array<std::uint8_t>({camera.height_px, camera.width_px}, 0);
  mask.known = Array<std::uint8_t>({camera.height_px, camera.width_px}, 1);
  for (std::int64_t y = 0; y < camera.height_px; ++y) {
    for (std::int64_t x = 0; x < camera.width_px; ++x) {
      int inside = 0;
      for (int k = 0; k < 16; ++k) {
        const double dx = (k % 4 + 0.5) / 4.0 - 0.5, dy = (k / 4 + 0.5) / 4.0 - 0.5;
        if (is_inside(static_cast<double>(x) + dx, static_cast<double>(y) + dy)) ++inside;
      }
      mask.foreground(y, x) = static_cast<std::uint8_t>(std::lround(255.0 * inside / 16.0));
    }
  }
  return mask;
}

inline ObjectMask disc_mask(const Camera& camera, double x_px, double y_px, double radius_px) {
  return mask_where(
      camera, [=](double x, double y) { return std::hypot(x - x_px, y - y_px) <= radius_px; });
}

/// The exact mask of a smooth surface whose front is seen everywhere, by the polygon of its border.
inline ObjectMask sheet_mask(const Camera& camera, const testing::SheetSpec& spec,
                             const DevelopableSheet& sheet) {
  constexpr int kPoints = 60;
  const double pitch_x = spec.width_m / spec.width_px, pitch_y = spec.height_m / spec.height_px;
  const double left = -0.5 * pitch_x, top = -0.5 * pitch_y;
  std::vector<Eigen::Vector2d> border;
  const auto add = [&](double x_m, double y_m) {
    border.push_back(project(testing::pinhole(camera), sheet.at(left + x_m, top + y_m)));
  };
  for (int k = 0; k < kPoints; ++k) add(spec.width_m * k / kPoints, 0.0);
  for (int k = 0; k < kPoints; ++k) add(spec.width_m, spec.height_m * k / kPoints);
  for (int k = kPoints; k > 0; --k) add(spec.width_m * k / kPoints, spec.height_m);
  for (int k = kPoints; k > 0; --k) add(0.0, spec.height_m * k / kPoints);
  std::vector<double> crossings;
  double row = -1.0;
  return mask_where(camera, [=](double x, double y) mutable {
    if (y != row) {
      row = y;
      crossings.clear();
      for (std::size_t k = 0; k < border.size(); ++k) {
        const Eigen::Vector2d &a = border[k], &b = border[(k + 1) % border.size()];
        if ((a.y() <= y) == (b.y() <= y)) continue;
        crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
    }
    return std::count_if(crossings.begin(), crossings.end(), [&](double at) { return at < x; }) %
               2 ==
           1;
  });
}

/// The template bent to a cylinder, and its mask.
struct MaskedSheet {
  Scene scene;
  ObjectMask mask;

  explicit MaskedSheet(double radius_m, const testing::PoseSpec& pose = {0.6})
      : scene(Scene::bent(radius_m, pose)),
        mask(sheet_mask(scene.camera, reference_sheet(),
                        testing::make_cylinder(reference_sheet(), radius_m, 0.3, pose))) {}
};

}  // namespace weft::gauss_newton
