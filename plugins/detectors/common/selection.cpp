// SPDX-License-Identifier: Apache-2.0
#include "common/selection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <weft/core/index.hpp>

namespace weft::detectors {
namespace {

/// A keypoint seen by the cap: how many of its cell are stronger, and where it stood.
struct Ranked {
  int rank;
  float response;
  int place;  ///< in the order
};

int cell_of(float coordinate, int length, int buckets) {
  const int cell = static_cast<int>(
      std::floor(coordinate * static_cast<float>(buckets) / static_cast<float>(length)));
  return std::clamp(cell, 0, buckets - 1);
}

}  // namespace

std::vector<int> canonical_order(const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const cv::KeyPoint& k = keypoints[to_index(i)];
    return std::tuple(k.pt.y, k.pt.x, k.octave, k.angle, k.response);
  };
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

void keep_inside(const std::vector<cv::KeyPoint>& keypoints, const Array<std::uint8_t>& mask,
                 std::vector<int>& order) {
  std::erase_if(order, [&](int i) {
    const cv::Point2f& at = keypoints[to_index(i)].pt;
    const auto x = static_cast<std::int64_t>(std::floor(at.x + 0.5F));
    const auto y = static_cast<std::int64_t>(std::floor(at.y + 0.5F));
    return x < 0 || y < 0 || x >= mask.dim(1) || y >= mask.dim(0) || mask(y, x) == 0;
  });
}

void keep_spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit, int buckets,
                 std::vector<int>& order) {
  if (limit == 0 || order.size() <= to_index(limit)) return;
  buckets = std::min(buckets, static_cast<int>(std::sqrt(static_cast<double>(limit))));
  const auto keypoint = [&](int place) -> const cv::KeyPoint& {
    return keypoints[to_index(order[to_index(place)])];
  };
  std::vector<int> by_response(order.size());
  std::iota(by_response.begin(), by_response.end(), 0);
  std::stable_sort(by_response.begin(), by_response.end(),
                   [&](int a, int b) { return keypoint(a).response > keypoint(b).response; });

  std::vector<int> taken(to_index(buckets * buckets), 0);
  std::vector<Ranked> ranked;
  ranked.reserve(order.size());
  for (const int place : by_response) {
    const cv::Point2f& at = keypoint(place).pt;
    const int cell =
        cell_of(at.y, image.height, buckets) * buckets + cell_of(at.x, image.width, buckets);
    ranked.push_back({taken[to_index(cell)]++, keypoint(place).response, place});
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return std::tuple(a.rank, -a.response, a.place) < std::tuple(b.rank, -b.response, b.place);
  });

  std::vector<int> places;
  for (int i = 0; i < limit; ++i) places.push_back(ranked[to_index(i)].place);
  std::sort(places.begin(), places.end());
  for (int& place : places) place = order[to_index(place)];
  order = std::move(places);
}

std::vector<int> selection(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                           const Array<std::uint8_t>* mask, int limit, int buckets) {
  std::vector<int> order = canonical_order(keypoints);
  if (mask != nullptr) keep_inside(keypoints, *mask, order);
  keep_spread(keypoints, image, limit, buckets, order);
  return order;
}

}  // namespace weft::detectors
