// SPDX-License-Identifier: Apache-2.0
#include "search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <thread>
#include <tuple>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>

#include "common/workers/sharing.hpp"
#include "patches.hpp"

namespace weft::orb {
namespace {

constexpr int kNeverMade = -1;
constexpr int kRowsOfStrip = 32;
/// Passes of ten nanoseconds or so in a pixel of a level and in the description of a keypoint.
constexpr double kPassesOfPixel = 0.5;
constexpr int kPassesOfKeypoint = 40;

}  // namespace

Search::Search(const Settings& settings)
    : settings_(settings),
      pattern_(pattern_of_opencv()),
      pyramid_(settings.scale_factor, settings.levels, settings.border_px) {}

void Search::lay_out(cv::Size image) {
  if (image == image_) return;
  image_ = {};
  pyramid_.lay_out(image);
  found_.resize(pyramid_.levels().size());
  strips_.clear();
  for (int l = 0; l < static_cast<int>(found_.size()); ++l) {
    const int height = pyramid_.levels()[to_index(l)].height();
    for (int begin = 0; begin < height; begin += kRowsOfStrip) {
      strips_.push_back({l, begin, std::min(begin + kRowsOfStrip, height), {}, {}});
    }
  }
  image_ = image;
}

/// Level after level, for the strips that wait for them.
void Search::make_levels(const cv::Mat& grey) {
  try {
    for (int l = 0; l < static_cast<int>(found_.size()); ++l) {
      ask_to_go_on();
      pyramid_.make(l, grey);
      made_.store(l + 1, std::memory_order_release);
    }
  } catch (...) {
    made_ = kNeverMade;
    throw;
  }
}

/// Whether a level is made; false when it will never be.
bool Search::wait_for(int level) const {
  while (true) {
    const int made = made_.load(std::memory_order_acquire);
    if (made == kNeverMade) return false;
    if (made > level) return true;
    std::this_thread::yield();
  }
}

/// Levels are resampled with pixel edges aligned: x + 1/2 = (x_level + 1/2) * width / width_level.
cv::KeyPoint Search::keypoint_at(const Corner& corner, int level) const {
  const Level& at = pyramid_.levels()[to_index(level)];
  return {static_cast<float>((corner.x + 0.5) * image_.width / at.width() - 0.5),
          static_cast<float>((corner.y + 0.5) * image_.height / at.height() - 0.5),
          kPatchPx * static_cast<float>(at.scale),
          -1.0F,
          0.0F,
          level};
}

void Search::search(Strip& strip, const Array<std::uint8_t>* mask, Bench& bench) {
  pyramid_.blur_rows(strip.level, strip.begin, strip.end);
  const Level& level = pyramid_.levels()[to_index(strip.level)];
  const int border = settings_.border_px;
  const Part part{border, level.width() - border, std::max(strip.begin, border),
                  std::min(strip.end, level.height() - border)};
  strip.corners.clear();
  strip.keypoints.clear();
  find_corners(level.sharp.ptr(), level.stride(), part, settings_.fast_threshold, bench.scratch,
               strip.corners);
  for (const Corner& corner : strip.corners) {
    strip.keypoints.push_back(keypoint_at(corner, strip.level));
  }
  bench.inside.resize(strip.corners.size());
  std::iota(bench.inside.begin(), bench.inside.end(), 0);
  if (mask != nullptr) detectors::keep_inside(strip.keypoints, *mask, bench.inside);
  std::size_t kept = 0;
  for (const int i : bench.inside) {
    const Corner corner = strip.corners[to_index(i)];
    strip.corners[kept] = corner;
    strip.keypoints[kept] = strip.keypoints[to_index(i)];
    strip.keypoints[kept].response =
        corner_response(level.sharp.ptr(corner.y) + corner.x, level.stride());
    ++kept;
  }
  strip.corners.resize(kept);
  strip.keypoints.resize(kept);
}

/// What strips found, level by level. It stands by y and x: that order is the same on the image.
void Search::gather() {
  for (Found& found : found_) {
    found.corners.clear();
    found.keypoints.clear();
  }
  for (const Strip& strip : strips_) {
    Found& found = found_[to_index(strip.level)];
    found.corners.insert(found.corners.end(), strip.corners.begin(), strip.corners.end());
    found.keypoints.insert(found.keypoints.end(), strip.keypoints.begin(), strip.keypoints.end());
  }
  for (Found& found : found_) {
    found.order.resize(found.keypoints.size());
    std::iota(found.order.begin(), found.order.end(), 0);
  }
}

/// Each level has a share of the cap that is proportional to its width, as published: else the fine
/// levels, which have most corners, would leave nothing to those at which an image and a larger
/// texture look alike. What a level leaves goes to finer ones.
void Search::share_cap() {
  for (Found& found : found_) found.limit = 0;
  if (settings_.max_keypoints == 0) return;
  int left = settings_.max_keypoints;
  for (std::size_t l = found_.size(); l-- > 0;) {
    double widths = 0.0;  // of this level and the finer ones, relative to this one
    for (std::size_t finer = 0; finer <= l; ++finer) {
      widths += std::pow(settings_.scale_factor, static_cast<double>(l - finer));
    }
    Found& found = found_[l];
    found.limit = static_cast<int>(std::ceil(left / widths));
    if (found.limit == 0) found.order.clear();
    left -= std::min(found.limit, static_cast<int>(found.order.size()));
  }
}

/// All that the levels keep, by y, x and octave.
void Search::choose() {
  const auto before = [](const Chosen& a, const Chosen& b) {
    return std::tuple(a.place.y, a.place.x, a.level) < std::tuple(b.place.y, b.place.x, b.level);
  };
  chosen_.clear();
  for (int l = 0; l < static_cast<int>(found_.size()); ++l) {
    const Found& found = found_[to_index(l)];
    const auto end = static_cast<std::ptrdiff_t>(chosen_.size());
    for (const int i : found.order) chosen_.push_back({found.keypoints[to_index(i)].pt, l, i});
    std::inplace_merge(chosen_.begin(), chosen_.begin() + end, chosen_.end(), before);
  }
  by_level_.resize(chosen_.size());
  std::iota(by_level_.begin(), by_level_.end(), 0);
  std::stable_sort(by_level_.begin(), by_level_.end(), [&](int a, int b) {
    return chosen_[to_index(a)].level < chosen_[to_index(b)].level;
  });
  keypoints_.resize(chosen_.size());
  descriptors_.create(static_cast<int>(chosen_.size()), kBytes, CV_8U);
}

/// Asks for the pixels of a keypoint.
void Search::fetch(int index) const {
  const Chosen& chosen = chosen_[to_index(index)];
  const Level& level = pyramid_.levels()[to_index(chosen.level)];
  const Corner corner = found_[to_index(chosen.level)].corners[to_index(chosen.index)];
  for (const cv::Mat* plane : {&level.sharp, &level.blurred}) {
    fetch_patch(plane->ptr(corner.y) + corner.x, level.stride());
  }
}

void Search::describe(int index) {
  const Chosen& chosen = chosen_[to_index(index)];
  const Found& found = found_[to_index(chosen.level)];
  const Level& level = pyramid_.levels()[to_index(chosen.level)];
  const Corner corner = found.corners[to_index(chosen.index)];
  cv::KeyPoint& keypoint = keypoints_[to_index(index)];
  keypoint = found.keypoints[to_index(chosen.index)];
  keypoint.angle = centroid_angle_deg(level.sharp.ptr(corner.y) + corner.x, level.stride());
  orb::describe(level.blurred.ptr(corner.y) + corner.x, level.stride(), keypoint.angle, pattern_,
                descriptors_.ptr(index));
}

void Search::run(const cv::Mat& grey, const Array<std::uint8_t>* mask, int threads) {
  lay_out(grey.size());
  // The first piece makes the levels, while others look at those that are there.
  const Shares shares{static_cast<int>(strips_.size()) + 1, 1, threads};
  if (benches_.size() < to_index(shares.workers())) benches_.resize(to_index(shares.workers()));
  made_ = 0;
  share_out(workers_, shares, [&](int worker, int piece, int) {
    if (piece == 0) {
      make_levels(grey);
      return true;
    }
    Strip& strip = strips_[to_index(piece - 1)];
    if (!wait_for(strip.level)) return false;
    search(strip, mask, benches_[to_index(worker)]);
    worked(static_cast<std::int64_t>(kPassesOfPixel * kRowsOfStrip * grey.cols));
    return true;
  });
  gather();
  share_cap();
  share_out(workers_, {static_cast<int>(found_.size()), 1, threads}, [&](int, int level, int) {
    Found& found = found_[to_index(level)];
    found.selector.spread(found.keypoints, grey.size(), found.limit, settings_.buckets,
                          found.order);
    return true;
  });
  choose();
  constexpr int kAtATime = 32;
  share_out(workers_, {static_cast<int>(chosen_.size()), kAtATime, threads},
            [&](int, int begin, int end) {
              for (int i = begin; i < end; ++i) {
                if (i + 1 < end) fetch(by_level_[to_index(i + 1)]);
                describe(by_level_[to_index(i)]);
              }
              worked(static_cast<std::int64_t>(end - begin) * kPassesOfKeypoint);
              return true;
            });
}

}  // namespace weft::orb
