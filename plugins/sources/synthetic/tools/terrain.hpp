// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>
#include <weft/core/rng.hpp>

#include "canvas.hpp"
#include "common/scene/value_noise.hpp"

namespace weft::texture {

constexpr double kInk = 0.16;

/// Heights in about [-1,1]; the sea is below 0.
class Terrain {
 public:
  Terrain(int width, int height, Rng& rng) : width_(width), height_(height) {
    double cell = 260.0;
    for (int octave = 0; octave < 6; ++octave) {
      layers_.emplace_back(width, height, cell, rng);
      cell *= 0.47;
    }
    std::vector<double> samples;
    for (int y = 0; y < height; y += 4) {
      for (int x = 0; x < width; x += 4) samples.push_back(raw(x, y));
    }
    const auto sea = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 5);
    std::nth_element(samples.begin(), sea, samples.end());
    sea_level_ = *sea;
    highest_ = *std::max_element(samples.begin(), samples.end());
  }

  double operator()(double x, double y) const {
    return (raw(std::clamp(x, 0.0, width_ - 1.0), std::clamp(y, 0.0, height_ - 1.0)) - sea_level_) /
           (highest_ - sea_level_);
  }
  double operator()(const Point& p) const { return (*this)(p.x(), p.y()); }

  Point slope(double x, double y) const {
    return {0.5 * ((*this)(x + 1, y) - (*this)(x - 1, y)),
            0.5 * ((*this)(x, y + 1) - (*this)(x, y - 1))};
  }

 private:
  double raw(double x, double y) const {
    double sum = 0.0, weight = 1.0;
    for (const auto& layer : layers_) {
      sum += weight * layer(x, y);
      weight *= 0.5;
    }
    return sum;
  }

  double width_, height_;
  std::vector<scene::ValueNoise> layers_;
  double sea_level_ = 0.0;
  double highest_ = 1.0;
};

/// How much of a pixel a contour line of this thickness covers.
inline double on_contour(double level_offset, double slope, double thickness) {
  return 0.5 + 0.5 * thickness - level_offset / std::max(slope, 1e-4);
}

inline void draw_relief(const Terrain& terrain, Canvas& canvas) {
  constexpr double kInterval = 0.055;
  for (int y = 0; y < canvas.height(); ++y) {
    for (int x = 0; x < canvas.width(); ++x) {
      const double height = terrain(x, y);
      const Point slope = terrain.slope(x, y);
      if (height < 0.0) {
        canvas.at(x, y) = 0.82;
        for (const double depth : {0.03, 0.075, 0.14}) {
          canvas.blend(x, y, 0.55, 0.7 * on_contour(std::abs(height + depth), slope.norm(), 0.7));
        }
      } else {
        const double tint = 0.9 - 0.07 * std::floor(height * 5.0);
        const double light = std::round(8.0 * (slope.x() + slope.y()) * 6.0) / 8.0;
        canvas.at(x, y) = tint - std::clamp(light, -0.12, 0.32);
        const double step = std::round(height / kInterval);
        const bool index_line = std::fmod(step, 4.0) == 0.0;
        const double offset = std::abs(height - step * kInterval);
        canvas.blend(
            x, y, 0.28,
            (index_line ? 0.85 : 0.5) * on_contour(offset, slope.norm(), index_line ? 1.1 : 0.5));
      }
      canvas.blend(x, y, kInk, on_contour(std::abs(height), slope.norm(), 1.8));
    }
  }
}

}  // namespace weft::texture
