// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

#include "common/view/blur.hpp"

namespace weft::view {

/// A grey image out of focus by `sigma_px`, with its grey levels changed by `light`.
template <class Light>
Image blurred(Image image, double sigma_px, const Light& light) {
  ViewLevel level;
  level.grey.resize(static_cast<int>(image.pixels.dim(1)), static_cast<int>(image.pixels.dim(0)));
  level.drawn.assign(to_index(image.pixels.size()), 1);
  std::copy_n(image.pixels.data(), image.pixels.size(), level.grey.values.begin());
  blur_drawn(sigma_px, level);
  for (std::int64_t i = 0; i < image.pixels.size(); ++i) {
    const double value = light(static_cast<double>(level.grey.values[to_index(i)]));
    image.pixels.data()[i] = static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  }
  return image;
}

/// A textured surface in front of a camera, rendered by formula.
struct PrintedScene {
  testing::SheetSpec sheet{.columns = 13, .rows = 9, .width_px = 900, .height_px = 539};
  Camera camera = testing::make_camera();
  Template templ = printed();

  /// Blots of many sizes: a texture without repetition.
  Template printed(std::uint64_t seed = 5) const {
    Template made = testing::make_template(sheet);
    made.revision = 11;
    Rng rng(seed);
    Array<std::uint8_t>& texture = made.texture;
    std::vector<double> grey(to_index(texture.size()), 128.0);
    const std::int64_t width = texture.dim(1), height = texture.dim(0);
    for (int blot = 0; blot < 1500; ++blot) {
      const double u = rng.uniform(0.0, static_cast<double>(width));
      const double v = rng.uniform(0.0, static_cast<double>(height));
      const double radius = rng.uniform(4.0, 16.0), level = rng.uniform(20.0, 235.0);
      for (std::int64_t y = 0; y < height; ++y) {
        if (std::abs(static_cast<double>(y) - v) > radius) continue;
        for (std::int64_t x = 0; x < width; ++x) {
          if (std::hypot(static_cast<double>(x) - u, static_cast<double>(y) - v) > radius) continue;
          grey[to_index(y * width + x)] = level;
        }
      }
    }
    for (std::size_t i = 0; i < grey.size(); ++i) {
      texture.data()[i] = static_cast<std::uint8_t>(std::lround(grey[i]));
    }
    return made;
  }

  DevelopableSheet bent(double radius_m, const testing::PoseSpec& pose) const {
    return testing::make_cylinder(sheet, radius_m, 0.4, pose);
  }

  /// Each texel is spread over the four pixels around its place, with bilinear weights: the surface
  /// is seen at about half the size of its texture. Noise of 1.5 grey levels.
  Image image_of(const DevelopableSheet& bent_sheet, Rng& rng) const {
    const std::int64_t width = camera.width_px, height = camera.height_px;
    std::vector<double> sum(to_index(width * height)), weights(sum.size());
    for (std::int64_t v = 0; v < templ.texture.dim(0); ++v) {
      for (std::int64_t u = 0; u < templ.texture.dim(1); ++u) {
        const Eigen::Vector2d px =
            place_of({static_cast<double>(u), static_cast<double>(v)}, bent_sheet);
        const double x = std::floor(px.x()), y = std::floor(px.y());
        if (!(x >= 0 && y >= 0 && x + 1 < static_cast<double>(width) &&
              y + 1 < static_cast<double>(height)))
          continue;
        for (int k = 0; k < 4; ++k) {
          const int i = k % 2, j = k / 2;
          const double weight = (1.0 - std::abs(px.x() - x - i)) * (1.0 - std::abs(px.y() - y - j));
          const auto at = to_index((std::llround(y) + j) * width + std::llround(x) + i);
          sum[at] += weight * templ.texture(v, u);
          weights[at] += weight;
        }
      }
    }
    Image image;
    image.pixels = Array<std::uint8_t>({height, width}, 0);
    for (std::size_t i = 0; i < sum.size(); ++i) {
      const double ground = 90.0 + 20.0 * std::sin(0.05 * static_cast<double>(i % 640));
      const double grey = weights[i] > 0.2 ? sum[i] / weights[i] : ground;
      image.pixels.data()[i] =
          static_cast<std::uint8_t>(std::lround(std::clamp(grey + 1.5 * rng.normal(), 0.0, 255.0)));
    }
    return image;
  }

  /// The image under another light: contrast times `gain`, with a gradient from left to right of
  /// 40 %.
  static Image unevenly_lit(const Image& image, double gain) {
    Image lit = image;
    lit.pixels = Array<std::uint8_t>({image.pixels.dim(0), image.pixels.dim(1)});
    for (std::int64_t y = 0; y < image.pixels.dim(0); ++y) {
      for (std::int64_t x = 0; x < image.pixels.dim(1); ++x) {
        const double light = gain * (0.8 + 0.4 * static_cast<double>(x) / 640.0);
        lit.pixels(y, x) = static_cast<std::uint8_t>(
            std::lround(std::clamp(light * 0.7 * image.pixels(y, x) + 10.0, 0.0, 255.0)));
      }
    }
    return lit;
  }

  Eigen::Vector2d place_of(const Eigen::Vector2d& texel, const DevelopableSheet& bent_sheet) const {
    return project(testing::pinhole(camera),
                   bent_sheet.at(templ.m_per_px(0) * texel.x(), templ.m_per_px(1) * texel.y()));
  }

  /// d(x,y)/d(u,v), px/px.
  Eigen::Matrix2d jacobian_at(const Eigen::Vector2d& texel,
                              const DevelopableSheet& sheet_there) const {
    Eigen::Matrix2d jacobian;
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector2d step = Eigen::Vector2d::Unit(k);
      jacobian.col(k) =
          0.5 * (place_of(texel + step, sheet_there) - place_of(texel - step, sheet_there));
    }
    return jacobian;
  }

  Shape shape_of(const DevelopableSheet& bent_sheet) const {
    Shape shape;
    shape.vertices_m = make_array<double>(testing::bent_vertices(templ, bent_sheet));
    shape.source = Array<std::uint8_t>({templ.vertices_m.rows()}, 0);
    return shape;
  }

  /// [px] of each match from where it belongs.
  std::vector<double> errors_px(const Correspondences& matches,
                                const DevelopableSheet& truth) const {
    std::vector<double> errors;
    for (std::int64_t i = 0; i < matches.count(); ++i) {
      const Eigen::Vector2d texel = matches.template_px.matrix<2>().row(i);
      const Eigen::Vector2d px = matches.image_px.matrix<2>().row(i);
      errors.push_back((px - place_of(texel, truth)).norm());
    }
    return errors;
  }
};

}  // namespace weft::view
