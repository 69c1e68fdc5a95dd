// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/data/correspondences.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>
#include <weft/data/shape.hpp>
#include <weft/testing/plugin_under_test.hpp>
#include <weft/testing/synthetic.hpp>

namespace weft::collins_integrated {

inline constexpr const char* kId = "solvers/collins_integrated";
inline constexpr std::uint64_t kSeed = 20150929;

/// A textured surface of 297 x 178 mm in front of a camera, rendered by formula, with exact ground
/// truth.
struct PrintedScene {
  testing::SheetSpec sheet{.columns = 13, .rows = 9, .width_px = 900, .height_px = 539};
  Camera camera = testing::make_camera();
  Template templ = printed(5);

  /// Blots of many sizes: a texture without repetition.
  Template printed(std::uint64_t seed) const {
    Template made = testing::make_template(sheet);
    made.revision = 11 + seed;
    Rng rng(seed);
    const std::int64_t width = made.texture.dim(1), height = made.texture.dim(0);
    for (int blot = 0; blot < 1500; ++blot) {
      const double u = rng.uniform(0.0, static_cast<double>(width));
      const double v = rng.uniform(0.0, static_cast<double>(height));
      const double radius = rng.uniform(4.0, 16.0);
      const auto grey = static_cast<std::uint8_t>(rng.uniform(20.0, 235.0));
      const auto first = [](double place) {
        return std::max<std::int64_t>(std::llround(place), 0);
      };
      for (std::int64_t y = first(v - radius);
           y < std::min<std::int64_t>(height, std::llround(v + radius)); ++y) {
        for (std::int64_t x = first(u - radius);
             x < std::min<std::int64_t>(width, std::llround(u + radius)); ++x) {
          if (std::hypot(static_cast<double>(x) - u, static_cast<double>(y) - v) > radius) continue;
          made.texture(y, x) = grey;
        }
      }
    }
    return made;
  }

  DevelopableSheet bent(double radius_m, const testing::PoseSpec& pose) const {
    return testing::make_cylinder(sheet, radius_m, 0.4, pose);
  }

  /// Each texel is spread over the four pixels around its place: the surface is seen at about half
  /// the size of its texture. Noise of 1.5 grey levels.
  Image image_of(const DevelopableSheet& bent_sheet, Rng& rng) const {
    const std::int64_t width = camera.width_px, height = camera.height_px;
    std::vector<double> sum(to_index(width * height)), weights(sum.size());
    for (std::int64_t v = 0; v < templ.texture.dim(0); ++v) {
      for (std::int64_t u = 0; u < templ.texture.dim(1); ++u) {
        const Eigen::Vector3d place = bent_sheet.at(templ.m_per_px(0) * static_cast<double>(u),
                                                    templ.m_per_px(1) * static_cast<double>(v));
        const Eigen::Vector2d px = project(testing::pinhole(camera), place);
        const double x = std::floor(px.x()), y = std::floor(px.y());
        if (!(x >= 0.0 && y >= 0.0 && x + 1.0 < static_cast<double>(width) &&
              y + 1.0 < static_cast<double>(height)))
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
      const double grey = weights[i] > 0.2 ? sum[i] / weights[i] : 90.0;
      image.pixels.data()[i] =
          static_cast<std::uint8_t>(std::lround(std::clamp(grey + 1.5 * rng.normal(), 0.0, 255.0)));
    }
    return image;
  }

  Image blank() const {
    Image image;
    image.pixels = Array<std::uint8_t>({camera.height_px, camera.width_px}, 128);
    return image;
  }

  Correspondences matches_of(const DevelopableSheet& bent_sheet, const testing::MatchSpec& spec,
                             Rng& rng) const {
    return testing::draw_matches(templ, camera, bent_sheet, spec, rng).matches;
  }

  Shape shape_of(const DevelopableSheet& bent_sheet,
                 ShapeState state = ShapeState::estimated) const {
    Shape shape;
    shape.vertices_m = make_array<double>(testing::bent_vertices(templ, bent_sheet));
    shape.state = static_cast<std::int32_t>(state);
    shape.source = Array<std::uint8_t>({templ.vertices_m.rows()}, 0);
    return shape;
  }

  double mean_error_mm(const Shape& shape, const DevelopableSheet& truth) const {
    const Points3 off_m = shape.vertices_m.matrix<3>() - testing::bent_vertices(templ, truth);
    return 1e3 * off_m.rowwise().norm().mean();
  }

  testing::PluginAnswer solve(testing::PluginUnderTest& plugin, const Image& image,
                              const Correspondences* matches,
                              const Shape* previous = nullptr) const {
    std::vector<testing::Input> inputs{testing::input("template", templ),
                                       testing::input("camera", camera),
                                       testing::input("image", image)};
    if (matches != nullptr) inputs.push_back(testing::input("correspondences", *matches));
    if (previous != nullptr) inputs.push_back(testing::input("previous.shape", *previous));
    return plugin.process(0, inputs);
  }
};

}  // namespace weft::collins_integrated
