// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <opencv2/core/ocl.hpp>
#include <opencv2/features2d.hpp>
#include <vector>
#include <weft/core/index.hpp>
#include <weft/core/stop_check.hpp>
#include <weft/sdk/detector.hpp>

#include "common/answer.hpp"
#include "common/grey_image.hpp"
#include "common/selection.hpp"

namespace weft::orb {
namespace {

constexpr int kPatchPx = 31;  // OpenCV draws random patterns for other sizes
constexpr int kDescriptorBytes = 32;
constexpr int kComparedPoints = 2;   // for each bit
constexpr double kMostAtOnce = 1e8;  // OpenCV doubles the number as an int
/// The descriptor compares points of a pyramid level blurred with this sigma.
constexpr double kBlurPx = 2.0;

/// Oriented FAST corners with rotated BRIEF descriptors, on the pixel grid of the whole image.
class Orb final : public Detector {
 public:
  static constexpr About kAbout{.reference =
                                    "paper: Rublee, Rabaud, Konolige and Bradski, ORB: an "
                                    "efficient alternative to SIFT or SURF, "
                                    "ICCV 2011",
                                .reads = "region"};

  explicit Orb(Params& p) {
    p.prominent().read(
        "max_keypoints", max_keypoints_, "", {0, 1000000},
        "maximum number of keypoints, the strongest ones spread over the image; 0: no limit");
    p.read("buckets", buckets_, "", {1, 256},
           "number of cells per side over which max_keypoints is spread; 1: no spreading");
    p.read("levels", levels_, "", {1, 32}, "number of pyramid levels; small images have fewer");
    p.read("scale_factor", scale_factor_, "", {1.05, 2},
           "size ratio of consecutive pyramid levels");
    p.read("fast_threshold", fast_threshold_, "grey levels", {1, 254},
           "minimum brightness difference between a corner and the circle around it");
    p.read("border_px", border_px_, "px", {16, 1000},
           "width of the border of each level that has no keypoints");
  }

  Result<Keypoints> detect(const DetectorInput& in) override {
    if (auto valid = detectors::check(in); !valid) return valid.error();
    if (in.call.cancelled()) return Error{Errc::cancelled, "cancelled"};
    // Otherwise OpenCV loads the runtime of a device, which sets signal handlers and variables.
    cv::ocl::setUseOpenCL(false);
    const cv::Mat grey = detectors::grey_image(in.image.pixels, grey_);
    std::vector<cv::KeyPoint> selected;
    cv::Mat descriptors(0, kDescriptorBytes, CV_8U);
    if (const int levels = levels_in(grey.size()); levels > 0) {
      const auto detector = cv::ORB::create(
          enough_for_all(grey.size(), levels), static_cast<float>(scale_factor_), levels,
          border_px_, 0, kComparedPoints, cv::ORB::HARRIS_SCORE, kPatchPx, fast_threshold_);
      std::vector<cv::KeyPoint> found;
      detector->detect(grey, found);
      selected = select(found, grey.size(), in.region ? &in.region->mask : nullptr);
      ask_to_go_on();
      if (!selected.empty()) detector->compute(grey, selected, descriptors);
    }
    return answer(selected, descriptors, grey.size());
  }

 private:
  double scale_of(int level) const { return std::pow(scale_factor_, level); }

  /// Sum of the widths of the finest levels, in widths of the image.
  double widths(int levels) const {
    double sum = 0.0;
    for (int level = 0; level < levels; ++level) sum += 1.0 / scale_of(level);
    return sum;
  }

  cv::Size2d level_size(cv::Size image, int level) const {
    const double scale = scale_of(level);
    return {std::round(image.width / scale), std::round(image.height / scale)};
  }

  /// How many levels of the pyramid of an image leave room between the borders.
  int levels_in(cv::Size image) const {
    int levels = 0;
    while (levels < levels_) {
      const cv::Size2d size = level_size(image, levels);
      if (std::min(size.width, size.height) <= 2.0 * border_px_) break;
      ++levels;
    }
    return levels;
  }

  /// A limit that OpenCV never reaches: the share of each level exceeds its number of corners,
  /// because no two corners are neighbours. OpenCV reserves memory for it.
  int enough_for_all(cv::Size image, int levels) const {
    return static_cast<int>(
        std::min(0.5 * image.width * image.height * widths(levels), kMostAtOnce));
  }

  /// OpenCV multiplies the position in a level, a whole pixel, with the level's scale. Levels are
  /// resampled with pixel edges aligned: x + 1/2 = (x_level + 1/2) * width / width_level.
  cv::Point2f place(const cv::KeyPoint& keypoint, cv::Size image) const {
    const auto scale = static_cast<float>(scale_of(keypoint.octave));
    const cv::Size2d level = level_size(image, keypoint.octave);
    const double x = std::round(keypoint.pt.x / scale), y = std::round(keypoint.pt.y / scale);
    return {static_cast<float>((x + 0.5) * image.width / level.width - 0.5),
            static_cast<float>((y + 0.5) * image.height / level.height - 0.5)};
  }

  /// The keypoints to describe, at OpenCV's positions. Each level has a share of the cap that is
  /// proportional to its width, as published. Without it the fine levels, which have most corners,
  /// would take all, and those at which an image and a larger texture look alike nothing.
  std::vector<cv::KeyPoint> select(const std::vector<cv::KeyPoint>& found, cv::Size image,
                                   const Array<std::uint8_t>* mask) const {
    std::vector<std::vector<cv::KeyPoint>> levels(to_index(levels_));
    std::vector<cv::KeyPoint> selected, placed;
    for (const cv::KeyPoint& keypoint : found) {
      levels[to_index(keypoint.octave)].push_back(keypoint);
    }
    int left = max_keypoints_;
    for (int level = levels_ - 1; level >= 0; --level) {  // the unused share of a level goes to
                                                          // finer ones
      const auto& candidates = levels[to_index(level)];
      placed = candidates;
      for (cv::KeyPoint& keypoint : placed) keypoint.pt = place(keypoint, image);
      const int share =
          max_keypoints_ == 0 ? 0 : static_cast<int>(std::ceil(left * share_of(level)));
      if (max_keypoints_ > 0 && share == 0) break;
      for (const int i : detectors::selection(placed, image, mask, share, buckets_)) {
        selected.push_back(candidates[to_index(i)]);
        --left;
      }
    }
    return selected;
  }

  /// The part of the remaining cap for a level; coarser levels come first.
  double share_of(int level) const { return 1.0 / scale_of(level) / widths(level + 1); }

  Result<Keypoints> answer(std::vector<cv::KeyPoint> keypoints, const cv::Mat& descriptors,
                           cv::Size image) const {
    for (cv::KeyPoint& keypoint : keypoints) keypoint.pt = place(keypoint, image);
    // compute() sorts them by level.
    std::vector<cv::KeyPoint> ordered;
    cv::Mat rows(0, kDescriptorBytes, CV_8U);
    for (const int i : detectors::canonical_order(keypoints)) {
      ordered.push_back(keypoints[to_index(i)]);
      rows.push_back(descriptors.row(i));
    }
    return detectors::answer(ordered, rows, kBlurPx / kPatchPx);
  }

  int max_keypoints_ = 6000;
  int buckets_ = 16;
  int levels_ = 8;
  double scale_factor_ = 1.2;
  int fast_threshold_ = 10;
  int border_px_ = 19;
  cv::Mat grey_;
};

}  // namespace
}  // namespace weft::orb

using weft::orb::Orb;
WEFT_PLUGIN(Orb, "detectors/orb", "1.2.0",
            "Detects ORB keypoints with descriptors of 256 bits; fast.")
