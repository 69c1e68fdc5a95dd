// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>
#include <weft/data/array.hpp>

#include "common/selection.hpp"
#include "common/workers/workers.hpp"
#include "corners.hpp"
#include "pattern.hpp"
#include "pyramid.hpp"

namespace weft::orb {

struct Settings {
  int max_keypoints = 6000;  ///< 0 for all
  int buckets = 16;          ///< cells per side, see keep_spread()
  int levels = 8;
  double scale_factor = 1.2;
  int fast_threshold = 10;  ///< [grey levels]
  int border_px = 19;       ///< [px of the level] 16 and more
};

/// ORB keypoints with their places on the pixel grid of the whole image; apart from place, cap and
/// order they are those of cv::ORB, to the bit. The result does not depend on the number of
/// threads; memory and threads are kept for the next image. Cancelled calls throw weft::Stopped.
class Search {
 public:
  explicit Search(const Settings& settings);

  /// Keypoints of an image [H,W] u8 by y, x and octave, in the mask [H,W] if there is one, and
  /// descriptors [K, kBytes]; valid until the next image.
  void run(const cv::Mat& grey, const Array<std::uint8_t>* mask, int threads);

  const std::vector<cv::KeyPoint>& keypoints() const { return keypoints_; }
  const cv::Mat& descriptors() const { return descriptors_; }

 private:
  /// Some rows of a level, and what was found in them.
  struct Strip {
    int level = 0, begin = 0, end = 0;
    std::vector<Corner> corners;
    std::vector<cv::KeyPoint> keypoints;  ///< of the corners: no angle yet
  };
  /// What was found in a level.
  struct Found {
    std::vector<Corner> corners;
    std::vector<cv::KeyPoint> keypoints;
    std::vector<int> order;  ///< of those that are kept, by y and x
    int limit = 0;           ///< 0 for all
    detectors::Selector selector;
  };
  /// What one thread needs.
  struct Bench {
    CornerScratch scratch;
    std::vector<int> inside;
  };
  /// A keypoint that is kept.
  struct Chosen {
    cv::Point2f place;
    int level, index;
  };

  void lay_out(cv::Size image);
  void make_levels(const cv::Mat& grey);
  bool wait_for(int level) const;
  void search(Strip& strip, const Array<std::uint8_t>* mask, Bench& bench);
  cv::KeyPoint keypoint_at(const Corner& corner, int level) const;
  void gather();
  void share_cap();
  void choose();
  void fetch(int index) const;
  void describe(int index);

  Settings settings_;
  Pattern pattern_;
  Pyramid pyramid_;
  Workers workers_;
  cv::Size image_;
  std::vector<Strip> strips_;
  std::vector<Found> found_;  ///< of each level
  std::vector<Bench> benches_;
  std::atomic<int> made_{0};  ///< levels; kNeverMade when making one failed
  std::vector<Chosen> chosen_;
  std::vector<int> by_level_;  ///< of these, so that patches that overlap come after another
  std::vector<cv::KeyPoint> keypoints_;
  cv::Mat descriptors_;
};

}  // namespace weft::orb
