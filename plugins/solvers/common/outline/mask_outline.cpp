// SPDX-License-Identifier: Apache-2.0
#include "mask_outline.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

namespace weft::solvers {
namespace {

constexpr double kEdge = 127.5;
constexpr std::int64_t kLeastStep_px = 8, kMostSteps = 100;
constexpr double kSameDirection = 0.7071;  // cosine
constexpr std::int64_t kSlopeReach_px = 2;

std::string size_of(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

bool is_inside(double level) { return level >= kEdge; }

}  // namespace

Result<void> MaskOutline::read(const ObjectMask& mask, const Camera& camera) {
  clear();
  const std::int64_t height = mask.foreground.dim(0), width = mask.foreground.dim(1);
  if (width != camera.width_px || height != camera.height_px) {
    return Error{Errc::invalid_data, "the object_mask has " + size_of(width, height) +
                                         " pixels, the camera " +
                                         size_of(camera.width_px, camera.height_px) +
                                         ": give a mask of the undistorted image"};
  }
  width_ = width;
  height_ = height;
  if (mask.foreground.contiguous() && mask.known.contiguous()) {
    foreground_ = mask.foreground.data();
    known_ = mask.known.data();
  } else {
    copy_.reserve(to_index(2 * width * height));
    for (const Array<std::uint8_t>* each : {&mask.foreground, &mask.known}) {
      for (std::int64_t y = 0; y < height; ++y) {
        copy_.insert(copy_.end(), each->row(y), each->row(y) + width);
      }
    }
    foreground_ = copy_.data();
    known_ = copy_.data() + width * height;
  }
  find_contour();
  return {};
}

double MaskOutline::level(const Eigen::Vector2d& place_px) const {
  const double x = std::floor(place_px.x()), y = std::floor(place_px.y());
  if (!(x >= 0.0 && y >= 0.0 && x + 1.0 < width_px() && y + 1.0 < height_px())) return -1.0;
  const auto i = static_cast<std::int64_t>(x), j = static_cast<std::int64_t>(y);
  const std::uint8_t* known = known_ + j * width_ + i;
  if ((known[0] & known[1] & known[width_] & known[width_ + 1]) == 0) return -1.0;
  const double right = place_px.x() - x, below = place_px.y() - y;
  const double above = at(i, j) + right * (at(i + 1, j) - at(i, j));
  const double under = at(i, j + 1) + right * (at(i + 1, j + 1) - at(i, j + 1));
  return above + below * (under - above);
}

bool MaskOutline::normal_at(const Eigen::Vector2d& place_px, Eigen::Vector2d& outwards) const {
  const auto x = static_cast<std::int64_t>(std::lround(place_px.x()));
  const auto y = static_cast<std::int64_t>(std::lround(place_px.y()));
  if (x < kSlopeReach_px || y < kSlopeReach_px || x + kSlopeReach_px >= width_ ||
      y + kSlopeReach_px >= height_)
    return false;
  Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  for (std::int64_t j = -kSlopeReach_px; j <= kSlopeReach_px; ++j) {
    for (std::int64_t i = -kSlopeReach_px; i <= kSlopeReach_px; ++i) {
      if (known_[(y + j) * width_ + x + i] == 0) return false;
      slope += at(x + i, y + j) * Eigen::Vector2d(static_cast<double>(i), static_cast<double>(j));
    }
  }
  const double length = slope.norm();
  if (!(length > 0.0)) return false;
  outwards = -slope / length;
  return true;
}

MaskOutline::Crossing MaskOutline::cross(const Eigen::Vector2d& place_px,
                                         const Eigen::Vector2d& outwards, double reach_px) const {
  double here = level(place_px);
  if (here < 0.0) return {Found::unknown, 0.0};
  const double sign = is_inside(here) ? 1.0 : -1.0;
  for (double step = 1.0; step <= reach_px + 1.0; step += 1.0) {
    const double there = level(place_px + sign * step * outwards);
    if (there < 0.0) return {Found::unknown, 0.0};
    if (is_inside(there) != is_inside(here)) {
      const double distance_px = sign * (step - 1.0 + (kEdge - here) / (there - here));
      if (std::abs(distance_px) > reach_px) return {};
      Eigen::Vector2d normal;
      if (!normal_at(place_px + distance_px * outwards, normal)) return {Found::unknown, 0.0};
      if (normal.dot(outwards) < kSameDirection) return {};
      return {Found::crossing, distance_px};
    }
    here = there;
  }
  return {};
}

void MaskOutline::add_crossing(const Eigen::Vector2d& place_px, std::vector<std::uint8_t>& taken) {
  const std::int64_t columns = width_ / step_px_ + 1;
  const auto cell = to_index(static_cast<std::int64_t>(place_px.y()) / step_px_ * columns +
                             static_cast<std::int64_t>(place_px.x()) / step_px_);
  if (taken[cell] != 0) return;
  ContourPoint point{place_px, {}};
  if (!normal_at(place_px, point.outwards)) return;
  taken[cell] = 1;
  contour_.push_back(point);
}

void MaskOutline::find_contour() {
  step_px_ = std::max(kLeastStep_px, std::max(width_, height_) / kMostSteps);
  const std::int64_t cells = (width_ / step_px_ + 1) * (height_ / step_px_ + 1);
  std::vector<std::uint8_t> taken(to_index(cells), 0);
  for (std::int64_t y = 0; y < height_; ++y) {
    worked(width_ / 8);
    const std::uint8_t* row = foreground_ + y * width_;
    const std::uint8_t* below = row + (y + 1 < height_ ? width_ : 0);
    for (std::int64_t x = 0; x + 1 < width_; ++x) {
      const bool inside = row[x] >= 128;
      if (inside != (row[x + 1] >= 128)) {
        const double share = (kEdge - row[x]) / (row[x + 1] - row[x]);
        add_crossing({static_cast<double>(x) + share, static_cast<double>(y)}, taken);
      }
      if (inside != (below[x] >= 128)) {
        const double share = (kEdge - row[x]) / (below[x] - row[x]);
        add_crossing({static_cast<double>(x), static_cast<double>(y) + share}, taken);
      }
    }
  }
}

}  // namespace weft::solvers
