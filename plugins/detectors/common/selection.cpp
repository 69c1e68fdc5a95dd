// SPDX-License-Identifier: Apache-2.0
#include "common/selection.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <weft/core/index.hpp>

namespace weft::detectors {
namespace {

int cell_of(float coordinate, int length, int buckets) {
  const int cell = static_cast<int>(
      std::floor(coordinate * static_cast<float>(buckets) / static_cast<float>(length)));
  return std::clamp(cell, 0, buckets - 1);
}

}  // namespace

void keep_inside(const std::vector<cv::KeyPoint>& keypoints, const Array<std::uint8_t>& mask,
                 std::vector<int>& order) {
  std::erase_if(order, [&](int i) {
    const cv::Point2f& at = keypoints[to_index(i)].pt;
    const auto x = static_cast<std::int64_t>(std::floor(at.x + 0.5F));
    const auto y = static_cast<std::int64_t>(std::floor(at.y + 0.5F));
    return x < 0 || y < 0 || x >= mask.dim(1) || y >= mask.dim(0) || mask(y, x) == 0;
  });
}

void Selector::put_in_order(const std::vector<cv::KeyPoint>& keypoints, std::vector<int>& order) {
  order.resize(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const cv::KeyPoint& k = keypoints[to_index(i)];
    return std::tuple(k.pt.y, k.pt.x, k.octave, k.angle, k.response, i);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
}

void Selector::spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit,
                      int buckets, std::vector<int>& order) {
  if (limit == 0 || order.size() <= to_index(limit)) return;
  buckets = std::min(buckets, static_cast<int>(std::sqrt(static_cast<double>(limit))));
  ranked_.clear();
  for (std::size_t place = 0; place < order.size(); ++place) {
    ranked_.push_back({0, keypoints[to_index(order[place])].response, static_cast<int>(place)});
  }
  const auto before = [](const Ranked& a, const Ranked& b) {
    return std::tuple(a.rank, -a.response, a.place) < std::tuple(b.rank, -b.response, b.place);
  };
  std::sort(ranked_.begin(), ranked_.end(), before);

  taken_.assign(to_index(buckets * buckets), 0);
  for (Ranked& one : ranked_) {
    const cv::Point2f& at = keypoints[to_index(order[to_index(one.place)])].pt;
    const int cell =
        cell_of(at.y, image.height, buckets) * buckets + cell_of(at.x, image.width, buckets);
    one.rank = taken_[to_index(cell)]++;
  }
  const auto end = ranked_.begin() + limit;
  std::nth_element(ranked_.begin(), end, ranked_.end(), before);
  std::sort(ranked_.begin(), end,
            [](const Ranked& a, const Ranked& b) { return a.place < b.place; });
  for (std::size_t i = 0; i < to_index(limit); ++i) order[i] = order[to_index(ranked_[i].place)];
  order.resize(to_index(limit));
}

const std::vector<int>& Selector::choose(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                                         const Array<std::uint8_t>* mask, int limit, int buckets) {
  put_in_order(keypoints, order_);
  if (mask != nullptr) keep_inside(keypoints, *mask, order_);
  spread(keypoints, image, limit, buckets, order_);
  return order_;
}

std::vector<int> canonical_order(const std::vector<cv::KeyPoint>& keypoints) {
  std::vector<int> order;
  Selector::put_in_order(keypoints, order);
  return order;
}

void keep_spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit, int buckets,
                 std::vector<int>& order) {
  Selector().spread(keypoints, image, limit, buckets, order);
}

std::vector<int> selection(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                           const Array<std::uint8_t>* mask, int limit, int buckets) {
  return Selector().choose(keypoints, image, mask, limit, buckets);
}

}  // namespace weft::detectors
