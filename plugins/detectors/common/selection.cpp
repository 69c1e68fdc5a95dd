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

/// Groups keypoints by cells, each in the order given.
void Selector::sort_into_cells(const std::vector<cv::KeyPoint>& keypoints, cv::Size image,
                               int buckets, const std::vector<int>& order) {
  cells_.clear();
  first_.assign(to_index(buckets * buckets) + 2, 0);
  for (const int i : order) {
    const cv::Point2f& at = keypoints[to_index(i)].pt;
    cells_.push_back(cell_of(at.y, image.height, buckets) * buckets +
                     cell_of(at.x, image.width, buckets));
    ++first_[to_index(cells_.back()) + 2];
  }
  for (std::size_t cell = 2; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
  ranked_.resize(order.size());
  for (std::size_t place = 0; place < order.size(); ++place) {
    const int to = first_[to_index(cells_[place]) + 1]++;
    ranked_[to_index(to)] = {keypoints[to_index(order[place])].response, static_cast<int>(place)};
  }
}

/// The number of rounds that stay within the limit, where every cell gives one keypoint a round,
/// and the rest of the limit then.
Selector::Rounds Selector::rounds_within(int limit) {
  counts_.clear();
  for (std::size_t cell = 0; cell + 2 < first_.size(); ++cell) {
    counts_.push_back(first_[cell + 1] - first_[cell]);
  }
  std::sort(counts_.begin(), counts_.end());
  Rounds rounds{0, limit};
  for (std::size_t i = 0; i < counts_.size(); ++i) {
    const int giving = static_cast<int>(counts_.size() - i), more = counts_[i] - rounds.all;
    if (static_cast<std::int64_t>(more) * giving > rounds.left) {
      rounds.all += rounds.left / giving;
      rounds.left %= giving;
      break;
    }
    rounds.all += more;
    rounds.left -= more * giving;
  }
  return rounds;
}

void Selector::spread(const std::vector<cv::KeyPoint>& keypoints, cv::Size image, int limit,
                      int buckets, std::vector<int>& order) {
  if (limit == 0 || order.size() <= to_index(limit)) return;
  buckets = std::min(buckets, static_cast<int>(std::sqrt(static_cast<double>(limit))));
  sort_into_cells(keypoints, image, buckets, order);
  const Rounds rounds = rounds_within(limit);
  const auto before = [](const Ranked& a, const Ranked& b) {
    return std::tuple(-a.response, a.place) < std::tuple(-b.response, b.place);
  };
  keep_.assign(order.size(), 0);
  last_.clear();
  for (std::size_t cell = 0; cell + 2 < first_.size(); ++cell) {
    const auto begin = ranked_.begin() + first_[cell], end = ranked_.begin() + first_[cell + 1];
    auto kept = end;
    if (end - begin > rounds.all) {
      kept = begin + rounds.all;
      std::nth_element(begin, kept, end, before);
      last_.push_back(*kept);  // may be the cell's one of the last round
    }
    for (auto each = begin; each != kept; ++each) keep_[to_index(each->place)] = 1;
  }
  const auto enough = last_.begin() + rounds.left;
  std::nth_element(last_.begin(), enough, last_.end(), before);
  for (auto each = last_.begin(); each != enough; ++each) keep_[to_index(each->place)] = 1;
  std::size_t count = 0;
  for (std::size_t place = 0; place < order.size(); ++place) {
    if (keep_[place] != 0) order[count++] = order[place];
  }
  order.resize(count);
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
