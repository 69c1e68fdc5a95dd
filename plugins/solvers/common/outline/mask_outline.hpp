// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>
#include <weft/core/result.hpp>
#include <weft/data/camera.hpp>
#include <weft/data/image.hpp>

namespace weft::solvers {

/// A point of the outline in the image.
struct ContourPoint {
  Eigen::Vector2d place_px;
  Eigen::Vector2d outwards;  ///< unit normal, from the object to the background
};

/// The outline of an object mask: where the foreground, interpolated linearly, is 128.
class MaskOutline {
 public:
  /// Reads a mask, which must outlive this. Fails if its size is not that of the camera's images.
  Result<void> read(const ObjectMask& mask, const Camera& camera);
  void clear() { *this = {}; }

  bool present() const { return foreground_ != nullptr; }
  double width_px() const { return static_cast<double>(width_); }
  double height_px() const { return static_cast<double>(height_); }

  /// Points of the outline at distances of 8 px, or more in large images. Parts next to unknown
  /// pixels and on the border of the image are omitted.
  const std::vector<ContourPoint>& contour() const { return contour_; }

  enum class Found { crossing, none, unknown };
  struct Crossing {
    Found found = Found::none;
    double distance_px = 0.0;  ///< [] along the direction, negative against it
  };
  /// Distance from a place to the outline along the unit vector `outwards`, up to `reach_px`. The
  /// object must end there in that direction, to 45 degrees. `unknown` if unknown pixels or the
  /// border of the image come first.
  Crossing cross(const Eigen::Vector2d& place_px, const Eigen::Vector2d& outwards,
                 double reach_px) const;

 private:
  std::uint8_t at(std::int64_t x, std::int64_t y) const { return foreground_[y * width_ + x]; }
  /// -1 where that is not known.
  double level(const Eigen::Vector2d& place_px) const;
  /// False where the mask has no slope or is not known around the place.
  bool normal_at(const Eigen::Vector2d& place_px, Eigen::Vector2d& outwards) const;
  void find_contour();
  void add_crossing(const Eigen::Vector2d& place_px, std::vector<std::uint8_t>& taken);

  const std::uint8_t* foreground_ = nullptr;
  const std::uint8_t* known_ = nullptr;
  std::int64_t width_ = 0, height_ = 0, step_px_ = 0;
  std::vector<std::uint8_t> copy_;  ///< a mask with another order in memory
  std::vector<ContourPoint> contour_;
};

}  // namespace weft::solvers
