// SPDX-License-Identifier: Apache-2.0
#include "pattern.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <opencv2/features2d.hpp>
#include <stdexcept>
#include <vector>
#include <weft/core/index.hpp>

namespace weft::orb {
namespace {

constexpr int kMiddle = 32, kSide = 2 * kMiddle + 1;
constexpr int kReach = 17;  // edges farther away along x or y, blurred, leave all points alike

/// Across which way an edge is seen: a point lies at dx x + dy y.
struct Axis {
  int dx, dy;
};

/// What edges across one axis tell of the points of each bit.
struct Seen {
  std::array<int, kBits> sum{};         ///< of the places of both points
  std::array<int, kBits> difference{};  ///< second less first; 0 where that is not known
};

/// The descriptor of a patch that is white from `edge` on, or up to there.
cv::Mat descriptor_of_edge(cv::ORB& orb, Axis axis, int edge, bool rising) {
  cv::Mat image(kSide, kSide, CV_8U);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const bool beyond = axis.dx * (x - kMiddle) + axis.dy * (y - kMiddle) >= edge;
      image.at<std::uint8_t>(y, x) = beyond == rising ? 255 : 0;
    }
  }
  std::vector<cv::KeyPoint> keypoint{{kMiddle, kMiddle, kPatchPx, 0.0F}};
  cv::Mat descriptor;
  orb.compute(image, keypoint, descriptor);
  if (descriptor.rows != 1 || descriptor.cols != kBytes) {
    throw std::runtime_error("cv::ORB gave no descriptor of 256 bits for a known patch");
  }
  return descriptor;
}

/// Moves an edge over the patch. Two points differ from the position on at which one of them is no
/// more wholly beyond the blurred edge until the other one is before it: the middle of these
/// positions is that of the points, less half a pixel, whatever the blur.
Seen look_along(cv::ORB& orb, Axis axis) {
  const int reach = kReach * (axis.dx + axis.dy);
  Seen seen;
  for (const bool rising : {true, false}) {
    std::array<int, kBits> from{}, to{};
    from.fill(std::numeric_limits<int>::max());
    for (int edge = -reach; edge <= reach; ++edge) {
      const cv::Mat descriptor = descriptor_of_edge(orb, axis, edge, rising);
      for (int bit = 0; bit < kBits; ++bit) {
        if ((descriptor.at<std::uint8_t>(0, bit / 8) >> bit % 8 & 1) == 0) continue;
        from[to_index(bit)] = std::min(from[to_index(bit)], edge);
        to[to_index(bit)] = edge;
      }
    }
    // Positions at which an edge between neighbours parts them, less one.
    constexpr int kBlurred = 5;
    for (std::size_t bit = 0; bit < kBits; ++bit) {
      if (from[bit] > to[bit]) continue;
      seen.sum[bit] = from[bit] + to[bit] - 1;
      seen.difference[bit] = (to[bit] - from[bit] - kBlurred) * (rising ? 1 : -1);
    }
  }
  return seen;
}

}  // namespace

Pattern pattern_of_opencv() {
  const cv::Ptr<cv::ORB> orb =
      cv::ORB::create(1, 1.2F, 1, kMiddle - 1, 0, 2, cv::ORB::HARRIS_SCORE, kPatchPx);
  const Seen along_x = look_along(*orb, {1, 0}), along_y = look_along(*orb, {0, 1});
  const Seen along_both = look_along(*orb, {1, 1});
  Pattern pattern;
  for (std::size_t bit = 0; bit < kBits; ++bit) {
    const int dx = along_x.difference[bit], dy = along_y.difference[bit];
    if (dx == 0 && dy == 0) {
      throw std::runtime_error("cv::ORB compares points that edges do not tell apart");
    }
    // Where two points have the same x or y, only an oblique edge tells which.
    const int x = dx != 0 ? along_x.sum[bit] : along_both.sum[bit] - along_y.sum[bit];
    const int y = dy != 0 ? along_y.sum[bit] : along_both.sum[bit] - along_x.sum[bit];
    pattern.first.x[bit] = 0.5F * static_cast<float>(x - dx);
    pattern.second.x[bit] = 0.5F * static_cast<float>(x + dx);
    pattern.first.y[bit] = 0.5F * static_cast<float>(y - dy);
    pattern.second.y[bit] = 0.5F * static_cast<float>(y + dy);
  }
  return pattern;
}

}  // namespace weft::orb
