// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/rng.hpp>
#include <weft/data/ground_truth.hpp>
#include <weft/data/image.hpp>
#include <weft/data/matrix.hpp>

namespace weft::true_matches {

/// Something that lies over a part of the object: the template points x with n . x below a
/// threshold, where n has a random direction. It moves with the object.
class Cover {
 public:
  /// Over the given share of the true points.
  Cover(const GroundTruth& truth, double share, Rng& rng) {
    const double turn_rad = rng.uniform(0.0, 2.0 * std::numbers::pi);
    normal_ = {std::cos(turn_rad), std::sin(turn_rad)};
    const Eigen::VectorXd along_m = truth.template_xy_m.matrix<2>() * normal_;
    std::vector<double> sorted_m(along_m.data(), along_m.data() + along_m.size());
    const auto number = static_cast<std::ptrdiff_t>(std::lround(share * double(sorted_m.size())));
    if (number == std::ssize(sorted_m)) {
      threshold_m_ = std::numeric_limits<double>::infinity();
    } else if (number > 0) {
      std::nth_element(sorted_m.begin(), sorted_m.begin() + number, sorted_m.end());
      threshold_m_ = sorted_m[to_index(number)];
    }
  }

  /// True if it covers the template point, [2] m. It covers no other place: NaN is not covered.
  bool over(const Eigen::Vector2d& xy_m) const { return normal_.dot(xy_m) < threshold_m_; }

  /// The true points below it are not visible, and the pixels that show them are grey. Which they
  /// are is known where the truth has uv_m; depth_m and uv_m are those of the object still.
  void hide(GroundTruth& truth, std::optional<Image>& image) const {
    Array<std::uint8_t> visible({truth.count()}, std::uint8_t{1});
    for (std::int64_t t = 0; t < truth.count(); ++t) {
      const bool seen = !truth.visible.present() || truth.visible(t) != 0;
      visible(t) = seen && !over(truth.template_xy_m.matrix<2>().row(t)) ? 1 : 0;
    }
    truth.visible = visible;
    if (!image || !truth.uv_m.present()) return;
    const Array<std::uint8_t>& pixels = image->pixels;
    const bool fits = truth.uv_m.dim(0) == pixels.dim(0) && truth.uv_m.dim(1) == pixels.dim(1);
    if (fits) image->pixels = painted(pixels, truth.uv_m);
  }

 private:
  static constexpr std::uint8_t kGrey = 110;

  Array<std::uint8_t> painted(const Array<std::uint8_t>& pixels, const Array<float>& uv_m) const {
    const std::int64_t height = pixels.dim(0), width = pixels.dim(1), channels = pixels.dim(2);
    Array<std::uint8_t> copy = pixels.ndim() == 3 ? Array<std::uint8_t>({height, width, channels})
                                                  : Array<std::uint8_t>({height, width});
    for (std::int64_t v = 0; v < height; ++v) {
      std::copy_n(pixels.row(v), width * channels, copy.row(v));
      for (std::int64_t u = 0; u < width; ++u) {
        const float* const xy_m = uv_m.row(v) + 2 * u;
        if (over({xy_m[0], xy_m[1]})) std::fill_n(copy.row(v) + channels * u, channels, kGrey);
      }
    }
    return copy;
  }

  Eigen::Vector2d normal_;
  double threshold_m_ = -std::numeric_limits<double>::infinity();  ///< [] m
};

}  // namespace weft::true_matches
